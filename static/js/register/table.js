/** The table of a register under the map: sortable columns that can be hidden, rows that can be marked, and files of what is filtered. */

import { byId, h, icon, setChildren } from "../dom.js";
import { closeMenu, menuOf, toggleMenu } from "../page/chrome.js";
import { t, tn } from "../text.js";
import { numberText } from "../units.js";
import { exportInJob } from "./export_job.js";

/** @import { Geometry } from "../map/types.d.ts" */
/** @import { Marked, Register, RegisterColumn } from "./types.d.ts" */

const FILES = [
  ["csv", "CSV"],
  ["geojson", "GeoJSON"],
  ["gpkg", "GeoPackage"],
];
const MAX_EXPORTED = 200_000;
const MAX_DIRECT = 10_000; // rows of a GeoPackage that is written without a job
const MAX_RINGS = 500; // of marked rows
const NEAR_END_PX = 400;

/**
 * @template Row
 * @typedef {object} TableHandlers
 * @property {(id: number) => unknown} choose
 * @property {(geometries?: Geometry[]) => void} ring
 * @property {() => unknown} more the next page
 * @property {() => unknown} reload after another order
 * @property {() => [string, string][]} narrowed what narrows the register, as parameters of its address
 * @property {(marked: Marked<Row>) => unknown} edit
 */

/** @template {{ id: number, geometry: any }} Row */
export class RegisterTable {
  #register;
  #on;
  #dock = byId("dock");
  #head = h("tr");
  #body = h("tbody");
  #count = h("span", { class: "register-count", role: "status" });
  #acts = h("span", { class: "register-acts" });
  #file = h("span", { class: "register-acts" });
  #scroll;
  /** @type {Set<string>} */
  #hidden;
  /** Marked rows by id. @type {Map<number, Row>} */
  #marked = new Map();
  /** Whether all rows that are found are marked, also those of later pages. */
  #isAll = false;
  /** @type {Row[]} */
  #rows = [];
  #total = 0;
  #hasMore = false;
  /** @type {number | null} */
  #chosenId = null;
  /** The column that orders the rows, "-" before it in reverse; "" in the order of the server. */
  order;

  /** @param {Register<Row>} register @param {TableHandlers<Row>} on */
  constructor(register, on) {
    this.#register = register;
    this.#on = on;
    this.order = register.order;
    this.#hidden = new Set(readHidden(register));
    const columns = h(
      "button",
      { type: "button", class: "text-button", "aria-haspopup": "true", "aria-expanded": "false" },
      icon("list", "small"),
      t("Columns"),
    );
    columns.addEventListener("click", () => toggleMenu(columns, () => this.#columnsMenu()));
    const files = h(
      "button",
      { type: "button", class: "text-button", "aria-haspopup": "true", "aria-expanded": "false" },
      icon("download", "small"),
      t("Export"),
    );
    files.addEventListener("click", () => toggleMenu(files, () => this.#filesMenu()));
    this.#scroll = h(
      "div",
      {
        class: "register-scroll",
        tabindex: 0,
        role: "region",
        "aria-label": register.words,
        onscroll: () => this.#scrolled(),
      },
      h(
        "table",
        { class: "register-table" },
        h("caption", { class: "unseen" }, register.words),
        h("thead", {}, this.#head),
        this.#body,
      ),
    );
    this.#dock.classList.add("register");
    setChildren(
      this.#dock,
      h(
        "div",
        { class: "register-bar" },
        this.#count,
        this.#acts,
        h("span", { class: "register-tools" }, this.#file, columns, files),
      ),
      this.#scroll,
    );
  }

  show() {
    this.#dock.hidden = false;
  }

  hide() {
    this.#dock.hidden = true;
  }

  /** @param {Row[]} rows @param {{ total: number, hasMore: boolean, isNew: boolean }} found isNew: other rows than before */
  draw(rows, { total, hasMore, isNew }) {
    this.#rows = rows;
    this.#total = total;
    this.#hasMore = hasMore;
    if (isNew) {
      this.#unmark();
      this.#scroll.scrollTop = 0;
    }
    this.#drawAll();
  }

  /** Shows which row is chosen, and brings it into sight. @param {number | null} id */
  choose(id) {
    this.#chosenId = id;
    for (const row of this.#body.rows) {
      const isChosen = row.dataset.id === String(id);
      row.classList.toggle("chosen", isChosen);
      row.querySelector("a")?.setAttribute("aria-current", String(isChosen));
      if (isChosen) row.scrollIntoView({ block: "nearest" });
    }
  }

  /** Geometries of marked rows. */
  marked() {
    return [...this.#marked.values()].slice(0, MAX_RINGS).map(({ geometry }) => geometry);
  }

  links() {
    return [...this.#body.querySelectorAll("a")];
  }

  #columns() {
    return this.#register.columns.filter(({ name }) => !this.#hidden.has(name));
  }

  #drawAll() {
    const columns = this.#columns();
    setChildren(
      this.#head,
      this.#register.canEdit && this.#markAllCell(),
      columns.map((column) => this.#headCell(column)),
    );
    const focused = this.links()
      .find((link) => link === document.activeElement)
      ?.getAttribute("href");
    this.#body.replaceChildren(...this.#rows.map((row) => this.#rowElement(row, columns)));
    if (focused)
      this.links()
        .find((link) => link.getAttribute("href") === focused)
        ?.focus({ preventScroll: true });
    this.#drawBar();
  }

  #drawBar() {
    const count = this.#isAll ? this.#total : this.#marked.size;
    const found = tn(this.#total, "{count} found", "{count} found", { count: numberText(this.#total) });
    this.#count.textContent = count
      ? t("{marked} of {total} marked", { marked: numberText(count), total: numberText(this.#total) })
      : found;
    const canMarkAll = !this.#isAll && this.#marked.size === this.#rows.length && this.#total > this.#rows.length;
    setChildren(
      this.#acts,
      count > 0 && [
        canMarkAll &&
          h(
            "button",
            { type: "button", class: "text-button", onclick: () => this.#markAll() },
            t("Mark all {count}", { count: numberText(this.#total) }),
          ),
        h(
          "button",
          { type: "button", class: "text-button", onclick: () => this.#on.edit(this.#markedRows()) },
          icon("pencil", "small"),
          this.#register.editWords(count),
        ),
        h("button", { type: "button", class: "text-button", onclick: () => this.#clear() }, t("Unmark")),
      ],
    );
  }

  /** @returns {Marked<Row>} */
  #markedRows() {
    return this.#isAll
      ? { count: this.#total, rows: null, query: this.#on.narrowed() }
      : { count: this.#marked.size, rows: [...this.#marked.values()], query: [] };
  }

  #unmark() {
    this.#marked.clear();
    this.#isAll = false;
  }

  #clear() {
    this.#unmark();
    this.#drawAll();
    this.#on.ring();
    this.#scroll.focus({ preventScroll: true });
  }

  #markAll() {
    this.#isAll = true;
    this.#drawAll();
    this.#acts.querySelector("button")?.focus();
  }

  #markAllCell() {
    const isEvery = this.#rows.length > 0 && this.#marked.size === this.#rows.length;
    const change = () => {
      this.#unmark();
      if (!isEvery) for (const row of this.#rows) this.#marked.set(row.id, row);
      this.#drawAll();
      this.#head.querySelector("input")?.focus();
      this.#on.ring();
    };
    const box = h("input", {
      type: "checkbox",
      class: "check",
      checked: isEvery,
      "aria-label": t("Mark all rows shown"),
      onchange: change,
    });
    box.indeterminate = !isEvery && this.#marked.size > 0;
    return h("th", { class: "mark", scope: "col" }, box);
  }

  /** @param {RegisterColumn<Row>} column */
  #headCell({ words, sort, isNumber }) {
    const isSorted = sort !== undefined && this.order.replace("-", "") === sort;
    const isDown = this.order.startsWith("-");
    const turn = () => {
      this.order = isSorted && !isDown ? `-${sort}` : `${sort}`;
      this.#on.reload();
    };
    return h(
      "th",
      {
        scope: "col",
        class: isNumber ? "number" : null,
        "aria-sort": isSorted ? (isDown ? "descending" : "ascending") : null,
      },
      sort
        ? h(
            "button",
            { type: "button", onclick: turn },
            words,
            isSorted && icon(isDown ? "chevron-down" : "chevron-up", "small"),
          )
        : words,
    );
  }

  /** @param {Row} row @param {RegisterColumn<Row>[]} columns */
  #rowElement(row, columns) {
    const { choose, ring } = this.#on;
    const [first, ...rest] = columns;
    const name = this.#register.name(row);
    const isChosen = row.id === this.#chosenId;
    const link = h(
      "a",
      {
        href: `?id=${row.id}`,
        title: name,
        "aria-current": String(isChosen),
        onfocus: () => ring([row.geometry]),
        onblur: () => ring(),
      },
      first.cell(row),
    );
    const go = (/** @type {Event} */ event) => {
      event.preventDefault();
      choose(row.id);
    };
    const mark = h("input", {
      type: "checkbox",
      class: "check",
      checked: this.#isAll || this.#marked.has(row.id),
      "aria-label": t("Mark {name}", { name }),
      onclick: (event) => event.stopPropagation(),
      onchange: () => {
        if (mark.checked) this.#marked.set(row.id, row);
        else this.#marked.delete(row.id);
        this.#isAll = false;
        setChildren(
          this.#head,
          this.#markAllCell(),
          this.#columns().map((column) => this.#headCell(column)),
        );
        this.#drawBar();
        ring();
      },
    });
    return h(
      "tr",
      {
        class: isChosen ? "record-row chosen" : "record-row",
        "data-id": row.id,
        onclick: go,
        onpointerenter: () => ring([row.geometry]),
        onpointerleave: () => ring(),
      },
      this.#register.canEdit && h("td", { class: "mark", onclick: (event) => event.stopPropagation() }, mark),
      h("th", { scope: "row", class: "row-name" }, icon(this.#register.icon(row), "small"), link),
      rest.map((column) => {
        const words = column.cell(row);
        return h(
          "td",
          { class: column.isNumber ? "number" : null, title: typeof words === "string" && words ? words : null },
          words,
        );
      }),
    );
  }

  #scrolled() {
    const { scrollTop, clientHeight, scrollHeight } = this.#scroll;
    if (this.#hasMore && scrollTop + clientHeight > scrollHeight - NEAR_END_PX) {
      this.#hasMore = false;
      this.#on.more();
    }
  }

  #columnsMenu() {
    const choices = this.#register.columns.slice(1).map(({ name, words }) => {
      const box = h("input", { type: "checkbox", class: "check", checked: !this.#hidden.has(name) });
      box.addEventListener("change", () => {
        if (box.checked) this.#hidden.delete(name);
        else this.#hidden.add(name);
        storeHidden(this.#register, [...this.#hidden]);
        this.#drawAll();
      });
      return h("label", { class: "menu-check" }, box, words);
    });
    return h("div", { class: "menu float", role: "group", "aria-label": t("Columns") }, choices);
  }

  #filesMenu() {
    const query = new URLSearchParams(this.#on.narrowed()).toString();
    const reason =
      this.#total > MAX_EXPORTED
        ? t("At most {most} rows: narrow the filters.", { most: numberText(MAX_EXPORTED) })
        : this.#total
          ? null
          : t("There is nothing to export.");
    const items = FILES.map(([ending, words]) => ({
      icon: "download",
      label: words,
      reason,
      act: () => {
        closeMenu();
        const { exports } = this.#register;
        if (ending === "gpkg" && this.#total > MAX_DIRECT) exportInJob(this.#file, `${exports}s?${query}`);
        else h("a", { href: `/api/v1${exports}.${ending}?${query}`, download: "" }).click();
      },
    }));
    return menuOf(t("Export what is filtered"), items);
  }
}

/** @param {Register<any>} register */
const storageKey = ({ key }) => `register-columns-${key}`;

/** @param {Register<any>} register @returns {string[]} */
function readHidden(register) {
  const usual = register.columns.filter(({ isOptional }) => isOptional).map(({ name }) => name);
  try {
    const stored = JSON.parse(localStorage.getItem(storageKey(register)) ?? "null");
    return Array.isArray(stored) ? stored : usual;
  } catch {
    return usual;
  }
}

/** @param {Register<any>} register @param {string[]} hidden */
function storeHidden(register, hidden) {
  try {
    localStorage.setItem(storageKey(register), JSON.stringify(hidden));
  } catch {
    /* storage is closed: for this page alone */
  }
}
