/** The list of a record page: search, results, and more of them on demand. */

import { get } from "../api.js";
import { byId, h, icon, setChildren } from "../dom.js";
import { t, tn } from "../text.js";

/** @import { Answer } from "../api.js" */
/** @import { Geometry } from "../map/types.d.ts" */
/** @import { RecordFeature, RecordKind } from "./types.d.ts" */

const PAGE = "60";
const TYPING_MS = 250;

/** A box as a query of the API has it. @param {number[]} box */
export const coordinatesOf = (box) => box.map((degrees) => degrees.toFixed(6)).join(",");

/**
 * @typedef {object} ListHandlers
 * @property {() => number[]} box what the map shows
 * @property {(id: number) => unknown} choose
 * @property {(geometries?: Geometry[]) => void} ring
 * @property {(error: unknown, again?: () => unknown) => void} failed
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
  #text = byId("record-text", HTMLInputElement);
  #inView = byId("record-in-view", HTMLInputElement);

  /** @param {RecordKind<Feature, Row>} kind @param {ListHandlers} on */
  constructor(kind, on) {
    this.#kind = kind;
    this.#on = on;
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

  /** What narrows the list, as parameters of its address. */
  #narrowed() {
    const given = {
      text: this.#text.value.trim(),
      ...this.#kind.narrowed(),
      bbox: this.followsView ? coordinatesOf(this.#on.box()) : "",
    };
    return Object.entries(given).filter(([, value]) => value);
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
    const query = new URLSearchParams([["limit", PAGE], ...this.#narrowed()]);
    const address = more && this.#next ? this.#next : `${this.#kind.path}?${query}`;
    try {
      const { data } = /** @type {Answer<{ features: Row[], next: string | null }>} */ (await get(address));
      if (turn !== this.#asked) return;
      this.#rows = more ? [...this.#rows, ...data.features] : data.features;
      this.#next = data.next;
      this.#draw();
    } catch (error) {
      this.#on.failed(error, () => this.load({ more }));
    }
  }

  focusFirst() {
    this.#list.querySelector("button")?.focus({ preventScroll: true });
  }

  /** Move the focus by a number of rows; false where there are none. @param {number} by */
  step(by) {
    const rows = [...this.#list.querySelectorAll("button")];
    if (!rows.length) return false;
    const at = rows.indexOf(/** @type {HTMLButtonElement} */ (document.activeElement));
    rows[(at + by + rows.length) % rows.length].focus();
    return true;
  }

  #draw() {
    setChildren(
      this.#list,
      this.#rows.map((row) => this.#rowElement(row)),
    );
    byId("record-more").hidden = this.#next === null;
    const none = byId("record-none");
    const count = this.#rows.length;
    none.hidden = count > 0;
    if (!count) none.replaceChildren(...this.#none());
    const found = this.#next ? t("{count} or more found", { count }) : tn(count, "{count} found", "{count} found");
    byId("page-facts").textContent = count ? found : "";
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
