/** The list of a record page: search, results, and more of them on demand. */

import { get } from "../api.js";
import { byId, h, icon, setChildren } from "../dom.js";
import { RegisterTable } from "../register/table.js";
import { t, tn } from "../text.js";
import { numberText } from "../units.js";

/** @import { Answer } from "../api.js" */
/** @import { Geometry } from "../map/types.d.ts" */
/** @import { RecordFeature, RecordKind } from "./types.d.ts" */

const PAGE = "60";
const TYPING_MS = 250;
const phone = matchMedia("(max-width: 720px)");

/** A box as a query of the API has it. @param {number[]} box */
export const coordinatesOf = (box) => box.map((degrees) => degrees.toFixed(6)).join(",");

/**
 * @typedef {object} ListHandlers
 * @property {() => number[]} box what the map shows
 * @property {(id: number) => unknown} choose
 * @property {(geometries?: Geometry[]) => void} ring
 * @property {(error: unknown, again?: () => unknown) => void} failed
 * @property {() => unknown} changed after an edit of several rows
 */

/**
 * @template {RecordFeature} Feature
 * @template {{ id: number, geometry: any }} Row
 */
export class RecordList {
  #kind;
  #on;
  #list = byId("record-list");
  /** @type {Row[]} */
  #rows = [];
  /** Address of the next page. @type {string | null} */
  #next = null;
  #asked = 0;
  #total = 0;
  #text = byId("record-text", HTMLInputElement);
  #inView = byId("record-in-view", HTMLInputElement);

  /** @param {RecordKind<Feature, Row>} kind @param {ListHandlers} on */
  constructor(kind, on) {
    this.#kind = kind;
    this.#on = on;
    const { register } = kind;
    this.table =
      register &&
      new RegisterTable(register, {
        choose: on.choose,
        ring: on.ring,
        more: () => this.load({ more: true }),
        reload: () => this.load(),
        narrowed: () => this.#narrowed(),
        edit: async (marked) => (await register.edit(marked)) && on.changed(),
      });
    phone.addEventListener("change", () => this.#draw(true));
    byId("record-more").addEventListener("click", () => this.load({ more: true }));
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    let timer;
    this.#text.addEventListener("input", () => {
      clearTimeout(timer);
      timer = setTimeout(() => this.load(), TYPING_MS);
    });
    this.#inView.addEventListener("change", () => this.load());
  }

  /** Whether the list is restricted to the map's view. */
  get followsView() {
    return this.#inView.checked;
  }

  get #isTable() {
    return this.table !== undefined && !phone.matches;
  }

  /** What narrows the list, as parameters of its address. @returns {[string, string][]} */
  #narrowed() {
    const given = {
      text: this.#text.value.trim(),
      ...this.#kind.narrowed(),
      bbox: this.followsView ? coordinatesOf(this.#on.box()) : "",
    };
    return Object.entries(given).flatMap(([name, value]) =>
      [value].flat().flatMap((one) => (one ? [/** @type {[string, string]} */ ([name, one])] : [])),
    );
  }

  #none() {
    const { noneFound, noneYet } = this.#kind;
    if (this.#narrowed().length) return [h("strong", {}, t("Nothing found.")), h("span", {}, noneFound)];
    const toImports = h("a", { class: "button", href: "/imports" }, t("Import a file"));
    return [h("strong", {}, noneYet.words), h("span", {}, noneYet.begin), toImports];
  }

  /** @param {{ more?: boolean }} [how] whether the next page is added */
  async load({ more = false } = {}) {
    this.#asked += 1;
    const turn = this.#asked;
    const narrowed = this.#narrowed();
    const order = this.#isTable && this.table?.order;
    const query = new URLSearchParams([["limit", PAGE], ...(order ? [["sort", order]] : []), ...narrowed]);
    const address = more && this.#next ? this.#next : `${this.#kind.path}?${query}`;
    try {
      const [{ data }] = await Promise.all([
        /** @type {Promise<Answer<{ features: Row[], next: string | null }>>} */ (get(address)),
        more ? null : this.#countAll(narrowed, turn),
      ]);
      if (turn !== this.#asked) return;
      this.#rows = more ? [...this.#rows, ...data.features] : data.features;
      this.#next = data.next;
      this.#draw(!more);
    } catch (error) {
      this.#on.failed(error, () => this.load({ more }));
    }
  }

  /** Reads the counts of a register. @param {[string, string][]} narrowed @param {number} turn */
  async #countAll(narrowed, turn) {
    const { register } = this.#kind;
    if (!register) return;
    const { data } = /** @type {Answer<{ total: number }>} */ (
      await get(`${register.summary}?${new URLSearchParams(narrowed)}`)
    );
    if (turn !== this.#asked) return;
    this.#total = data.total;
    register.counted(data);
  }

  /** @param {number} [id] of the row; without one the first */
  focusRow(id) {
    const links = this.#links();
    const own = links.find((link) => link.closest(`[data-id="${id}"]`));
    (own ?? links[0])?.focus({ preventScroll: true });
  }

  #links() {
    return this.#isTable && this.table ? this.table.links() : [...this.#list.querySelectorAll("button")];
  }

  /** Move the focus by a number of rows; false where there are none. @param {number} by */
  step(by) {
    const rows = this.#links();
    if (!rows.length) return false;
    const at = rows.indexOf(/** @type {any} */ (document.activeElement));
    rows[(at + by + rows.length) % rows.length].focus();
    return true;
  }

  /** @param {boolean} isNew whether other rows than before are shown */
  #draw(isNew) {
    const isTable = this.#isTable;
    setChildren(
      this.#list,
      this.#rows.map((row) => (isTable ? null : this.#rowElement(row))),
    );
    const hasMore = this.#next !== null;
    byId("record-more").hidden = isTable || !hasMore;
    const none = byId("record-none");
    const count = this.#rows.length;
    none.hidden = count > 0;
    if (!count) none.replaceChildren(...this.#none());
    if (isTable) this.table?.show();
    else this.table?.hide();
    this.table?.draw(this.#rows, { total: this.#total, hasMore, isNew });
    byId("page-facts").textContent = count ? this.#foundWords(count) : "";
  }

  /** @param {number} count */
  #foundWords(count) {
    if (this.table) return tn(this.#total, "{count} found", "{count} found", { count: numberText(this.#total) });
    return this.#next ? t("{count} or more found", { count }) : tn(count, "{count} found", "{count} found");
  }

  /** @param {Row} feature */
  #rowElement(feature) {
    const { ring, choose } = this.#on;
    const row = this.#kind.row(feature);
    const show = () => ring([feature.geometry]);
    const leave = () => ring();
    return h(
      "li",
      {},
      h(
        "button",
        {
          type: "button",
          class: "record-row",
          "data-id": feature.id,
          onclick: () => choose(feature.id),
          onpointerenter: show,
          onpointerleave: leave,
          onfocus: show,
          onblur: leave,
        },
        icon(row.icon),
        h("span", { class: "what" }, h("span", { class: "name" }, row.name), row.detail && h("small", {}, row.detail)),
        row.chip && h("span", { class: "chip" }, row.chip),
      ),
    );
  }
}
