/** The side of the page: which issues, and the list of them. */

import { byId, h, icon, keyedList, refill, setChildren } from "../dom.js";
import { t } from "../text.js";
import { numberText } from "../units.js";
import { cutOffText, KINDS, STATES } from "./kinds.js";

/** @import { DataIssue, DataIssueFilter } from "./types.d.ts" */

const TYPED_MS = 250;

/**
 * @typedef {object} ListHandlers
 * @property {(filter: DataIssueFilter) => void} narrow
 * @property {(id: number) => void} choose
 * @property {(issue: DataIssue | null) => void} point
 * @property {() => void} more
 */

/** @param {ListHandlers} on */
export const mountIssueList = (on) => new DataIssueList(on);

class DataIssueList {
  #on;
  #list = byId("issue-list");
  #end = byId("issue-list-end");
  #text = byId("issue-text", HTMLInputElement);
  #inView = byId("issue-in-view", HTMLInputElement);
  #states;
  #chips;
  #draw;
  /** @type {number | null} */
  #chosenId = null;
  #chosenIndex = 0; // index of the chosen row, or its former one: the following row moves there
  /** @type {DataIssueFilter} */
  filter = { state: "open", kinds: new Set(), text: "", inView: false };

  /** @param {ListHandlers} on */
  constructor(on) {
    this.#on = on;
    this.#states = STATES.map(({ state, name }) => this.#stateRadio(state, name));
    this.#chips = Object.entries(KINDS).map(([kind, { name }]) => this.#kindChip(kind, name));
    this.#draw = keyedList(
      this.#list,
      (/** @type {DataIssue} */ issue) => issue.id,
      () => this.#makeRow(),
      (item, issue) => this.#refreshRow(item, issue),
    );
    this.#watchText();
    this.#inView.addEventListener("change", () => {
      this.filter.inView = this.#inView.checked;
      this.#narrow();
    });
  }

  focusText = () => this.#text.focus();

  /** Whether the list is still that of the filter before. @param {boolean} isBusy */
  busy(isBusy) {
    this.#list.setAttribute("aria-busy", String(isBusy));
  }

  /** The loaded issues, and whether there are more. @param {DataIssue[]} issues @param {{ hasMore: boolean, hasSearched: boolean }} how */
  show(issues, { hasMore, hasSearched }) {
    this.#draw(issues);
    const more = { class: "button quiet more", type: "button", onclick: this.#on.more };
    setChildren(
      this.#end,
      issues.length === 0 && h("div", { class: "empty" }, this.#empty(hasSearched)),
      hasMore && h("button", more, t("Show more")),
    );
  }

  /** @param {Record<string, Record<string, number>>} numbers by kind, then state */
  counts(numbers) {
    for (const { state, count } of this.#states)
      count.textContent = numberText(sum(Object.values(numbers).map((byState) => byState[state])));
    for (const { kind, count, chip } of this.#chips) {
      const number = numbers[kind]?.[this.filter.state] ?? 0;
      count.textContent = numberText(number);
      chip.hidden = !number && !this.filter.kinds.has(kind);
    }
  }

  /** @param {number | null} id */
  mark(id) {
    this.#chosenId = id;
    for (const [index, row] of this.#rows().entries()) {
      const isChosen = idOf(row) === id;
      row.setAttribute("aria-current", String(isChosen));
      if (!isChosen) continue;
      this.#chosenIndex = index;
      row.scrollIntoView({ block: "nearest" });
    }
  }

  /** Moves the focus along the rows; from outside to the one beside the chosen one. @param {1 | -1} by */
  step(by) {
    const rows = this.#rows();
    const focused = rows.findIndex((row) => row.matches(":focus"));
    const isThere = idOf(rows[this.#chosenIndex]) === this.#chosenId;
    const from = focused >= 0 ? focused : isThere ? this.#chosenIndex : this.#chosenIndex - (by > 0 ? 1 : 0);
    rows[Math.max(0, Math.min(rows.length - 1, from + by))]?.focus();
  }

  /** Open the issue in the former place of the chosen one, which has left the list. */
  openNext() {
    const rows = this.#rows();
    rows[Math.min(this.#chosenIndex, rows.length - 1)]?.click();
  }

  #narrow() {
    this.#on.narrow(this.filter);
  }

  /** @returns {HTMLElement[]} */
  #rows() {
    return [.../** @type {NodeListOf<HTMLElement>} */ (this.#list.querySelectorAll(".issue-row"))];
  }

  /** @param {DataIssueFilter["state"]} state @param {string} name */
  #stateRadio(state, name) {
    const checked = state === this.filter.state;
    const input = h("input", { type: "radio", name: "issue-state", value: state, checked });
    const count = h("span", { class: "count" });
    input.addEventListener("change", () => {
      this.filter.state = state;
      this.#narrow();
    });
    byId("issue-states").append(h("label", {}, input, h("span", { class: "segment" }, h("span", {}, name), count)));
    return { state, count };
  }

  /** @param {string} kind @param {string} name */
  #kindChip(kind, name) {
    const count = h("span", { class: "count" });
    const chip = h("button", { class: "kind-chip", type: "button", "aria-pressed": "false" }, name, count);
    chip.addEventListener("click", () => {
      const { kinds } = this.filter;
      if (!kinds.delete(kind)) kinds.add(kind);
      chip.setAttribute("aria-pressed", String(kinds.has(kind)));
      this.#narrow();
    });
    byId("issue-kinds").append(chip);
    return { kind, count, chip };
  }

  #watchText() {
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    let typing;
    this.#text.addEventListener("input", () => {
      clearTimeout(typing);
      typing = setTimeout(() => {
        this.filter.text = this.#text.value.trim();
        this.#narrow();
      }, TYPED_MS);
    });
  }

  #makeRow() {
    const row = h("button", { class: "issue-row", type: "button" });
    const item = h("li", {}, row);
    row.addEventListener("click", () => this.#on.choose(Number(item.dataset.id)));
    return item;
  }

  /** @param {HTMLElement} item @param {DataIssue} issue */
  #refreshRow(item, issue) {
    const { kind, title, asset, cut_off_m, details } = issue.properties;
    const row = /** @type {HTMLElement} */ (item.firstElementChild);
    item.dataset.id = String(issue.id);
    const figure = cutOffText({ kind, cut_off_m }) || (details.is_advisory ? t("may be right") : "");
    const words = [title, asset ? [asset.label, asset.detail].filter(Boolean).join(", ") : "", figure];
    refill(row, [kind, ...words].join("\n"), () => [
      icon(KINDS[kind].icon),
      h("span", { class: "what" }, h("strong", {}, words[0]), h("small", {}, words[1])),
      h("span", { class: "figure" }, words[2]),
    ]);
    const come = () => this.#on.point(issue);
    const leave = () => this.#on.point(null);
    Object.assign(row, { onpointerenter: come, onfocus: come, onpointerleave: leave, onblur: leave });
    row.setAttribute("aria-current", String(issue.id === this.#chosenId));
  }

  #clearFilters() {
    this.filter.kinds.clear();
    this.filter.text = "";
    this.filter.inView = false;
    this.#text.value = "";
    this.#inView.checked = false;
    for (const { chip } of this.#chips) chip.setAttribute("aria-pressed", "false");
    this.#narrow();
  }

  /** @param {boolean} hasSearched */
  #empty(hasSearched) {
    if (!hasSearched)
      return [
        h("strong", {}, t("The ground is being searched.")),
        h("p", {}, t("Data issues come up here when that is done.")),
        h("div", { class: "skeleton" }),
        h("div", { class: "skeleton" }),
      ];
    const { kinds, text, inView, state } = this.filter;
    if (kinds.size || text || inView) {
      const what = text ? t("No issue matches “{text}”.", { text }) : t("No issue like that here.");
      const clear = { class: "button", type: "button", onclick: () => this.#clearFilters() };
      return [h("strong", {}, what), h("button", clear, t("Clear the filter"))];
    }
    if (state === "open")
      return [
        icon("circle-check"),
        h("strong", {}, t("Nothing looks wrong here.")),
        h("p", {}, t("The ground is searched again after each change.")),
      ];
    const none = state === "repaired" ? t("Nothing has been repaired yet.") : t("Nothing has been ignored.");
    return [h("strong", {}, none)];
  }
}

/** @param {number[]} numbers */
const sum = (numbers) => numbers.reduce((total, number) => total + number, 0);

/** The issue of a row. @param {HTMLElement | undefined} row */
const idOf = (row) => Number(row?.parentElement?.dataset.id);
