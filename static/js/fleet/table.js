/** The table of UAVs, types or bases, and the notice when it is empty. */

import { byId, h, icon } from "../dom.js";
import { t } from "../text.js";
import { numberText } from "../units.js";

/** @import { Kind, Row } from "./types.d.ts" */

/**
 * @typedef {object} TableActs
 * @property {boolean} canPlan
 * @property {(id: number) => unknown} onChoose
 * @property {() => unknown} onNew
 * @property {() => unknown} onClear
 */
/**
 * @typedef {object} TableContent
 * @property {Kind} kind
 * @property {Row[] | null} rows null: not loaded yet
 * @property {number | null} chosenId
 * @property {string | null} next
 * @property {boolean} isFiltered
 * @property {string} text
 */

/** @param {TableActs} acts */
export function mountTable({ canPlan, onChoose, onNew, onClear }) {
  const head = byId("fleet-head");
  const links = () => [...byId("fleet-rows").querySelectorAll("a")];

  /** @param {Kind} kind @param {Row} item @param {boolean} isChosen */
  function row(kind, item, isChosen) {
    const [first, ...rest] = kind.columns;
    const link = h(
      "a",
      { href: `?tab=${kind.tab}&id=${item.id}`, "aria-current": isChosen ? "true" : null },
      item.name,
    );
    link.addEventListener("click", (event) => {
      event.preventDefault();
      event.stopPropagation();
      onChoose(item.id);
    });
    return h(
      "tr",
      { class: isChosen ? "chosen" : null, onclick: () => onChoose(item.id) },
      h("td", { class: "name" }, link, first.cell(item)),
      rest.map((column) => h("td", { class: column.class }, column.cell(item))),
    );
  }

  /** @param {Kind} kind @param {boolean} isFiltered @param {string} text */
  function drawEmpty(kind, isFiltered, text) {
    const parts = isFiltered
      ? [
          h("strong", {}, text ? t("Nothing matches “{text}”", { text }) : t("No UAV is like that")),
          h("button", { type: "button", class: "button", onclick: onClear }, t("Clear the filter")),
        ]
      : [
          h("strong", {}, kind.none.title),
          h("span", {}, kind.none.text),
          ...(canPlan ? [h("button", { type: "button", class: "button", onclick: onNew }, kind.one)] : []),
        ];
    byId("fleet-empty").replaceChildren(icon(kind.icon, "large"), ...parts);
  }

  return {
    /** @param {TableContent} content */
    draw({ kind, rows, chosenId, next, isFiltered, text }) {
      byId("fleet-waiting").hidden = rows !== null;
      byId("fleet-table").hidden = !rows?.length;
      byId("fleet-empty").hidden = rows === null || rows.length > 0;
      byId("fleet-more").hidden = !next;
      byId("fleet-count").textContent = rows?.length
        ? next
          ? t("the first {count}", { count: numberText(rows.length) })
          : kind.count(rows.length)
        : "";
      if (rows === null) return;
      byId("fleet-caption").textContent = kind.words;
      const focused = links()
        .find((link) => link === document.activeElement)
        ?.getAttribute("href");
      head.replaceChildren(
        h(
          "tr",
          {},
          kind.columns.map((column) => h("th", { scope: "col", class: column.class }, column.words)),
        ),
      );
      byId("fleet-rows").replaceChildren(...rows.map((item) => row(kind, item, item.id === chosenId)));
      if (focused)
        links()
          .find((link) => link.getAttribute("href") === focused)
          ?.focus({ preventScroll: true });
      if (!rows.length) drawEmpty(kind, isFiltered, text);
    },
    /** Focuses the next (1) or the previous (-1) row. Returns false where there is none. @param {1 | -1} by */
    step(by) {
      const all = links();
      if (!all.length) return false;
      const at = all.indexOf(/** @type {HTMLAnchorElement} */ (document.activeElement));
      all[(at + by + all.length) % all.length].focus();
      return true;
    },
  };
}
