/** A list with filters: requested again when one changes, continued by "Show more", with a text for an empty result. */

import { get } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { t } from "../text.js";

/** @import { Answer } from "../api.js" */
/** @import { Reporter } from "../page/problem.js" */

const TYPING_ENDS_MS = 250;

/**
 * @template Row
 * @typedef {object} ListOptions
 * @property {string} list prefix of the ids of its elements
 * @property {string} path in the API
 * @property {string[]} filters names of the query's parameters, each with a control #<list>-<name>
 * @property {(entry: Row) => HTMLElement} row
 * @property {(count: number) => string} countWords
 * @property {{ icon: string, title: string, words: string }} none
 * @property {Reporter["notify"]} notify
 * @property {string} titleOfFault
 */

/** @template Row @param {ListOptions<Row>} options */
export function filteredList({ list, path, filters, row, countWords, none, notify, titleOfFault }) {
  /** @type {[string, HTMLInputElement | HTMLSelectElement][]} */
  const controls = filters.map((name) => [name, byId(`${list}-${name}`, HTMLInputElement)]);
  const rows = byId(`${list}-rows`);
  const more = byId(`${list}-more`);
  /** @type {string | null} */
  let next = null;
  let asked = 0;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;

  function query() {
    const wanted = controls.map(([name, control]) => [name, control.value.trim()]).filter(([, value]) => value);
    return new URLSearchParams([...wanted, ["limit", "50"]]);
  }

  const isFiltered = () => controls.some(([, control]) => control.value.trim());

  /** @param {string} address */
  async function ask(address) {
    asked += 1;
    const turn = asked;
    try {
      const { data } = /** @type {Answer<{ results: Row[], next: string | null }>} */ (await get(address));
      return turn === asked ? data : null;
    } catch (error) {
      notify(titleOfFault, error);
      return null;
    }
  }

  async function load() {
    const data = await ask(`${path}?${query()}`);
    if (!data) return;
    rows.replaceChildren(...data.results.map(row));
    shown(data.next);
  }

  async function loadMore() {
    const data = next && (await ask(next));
    if (!data) return;
    const added = data.results.map(row);
    rows.append(...added);
    shown(data.next);
    /** @type {HTMLElement | null | undefined} */
    const first = added[0]?.querySelector("button, select, a");
    first?.focus();
  }

  /** @param {string | null} following address of the next page */
  function shown(following) {
    next = following;
    more.hidden = next === null;
    const count = rows.children.length;
    /** @type {HTMLElement} */ (rows.closest("table")).hidden = count === 0;
    byId(`${list}-count`).textContent =
      count === 0 ? "" : next === null ? countWords(count) : t("The first {what}", { what: countWords(count) });
    const empty = byId(`${list}-none`);
    empty.hidden = count > 0;
    if (count) return;
    if (isFiltered())
      empty.replaceChildren(
        icon("search", "large"),
        h("strong", {}, t("Nothing matches")),
        h("button", { type: "button", class: "button", onclick: clear }, t("Clear the filters")),
      );
    else empty.replaceChildren(icon(none.icon, "large"), h("strong", {}, none.title), h("span", {}, none.words));
  }

  function clear() {
    for (const [, control] of controls) control.value = "";
    controls[0][1].focus();
    load();
  }

  more.addEventListener("click", loadMore);
  for (const [, control] of controls) {
    const isTyped = control.tagName === "INPUT";
    control.addEventListener(isTyped ? "input" : "change", () => {
      clearTimeout(timer);
      timer = setTimeout(load, isTyped ? TYPING_ENDS_MS : 0);
    });
  }
  return { load };
}
