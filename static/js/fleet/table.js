/** The table of UAVs, types or bases, and what stands there when there is nothing. */

import { byId, h, icon } from "../dom.js";
import { t } from "../text.js";
import { numberText } from "../units.js";

/** onChoose(id), onNew(), onClear(). */
export function mountTable({ canPlan, onChoose, onNew, onClear }) {
  const head = byId("fleet-head");

  function row(kind, item, isChosen) {
    const [first, ...rest] = kind.columns;
    const link = h(
      "a",
      {
        href: `?tab=${kind.tab}&id=${item.id}`,
        "aria-current": isChosen ? "true" : null,
        onclick: (event) => (event.preventDefault(), event.stopPropagation(), onChoose(item.id)),
      },
      item.name,
    );
    return h(
      "tr",
      { class: isChosen ? "chosen" : null, onclick: () => onChoose(item.id) },
      h("td", { class: "name" }, link, first.cell(item)),
      rest.map((column) => h("td", { class: column.class }, column.cell(item))),
    );
  }

  function empty(kind, isFiltered, text) {
    const words = isFiltered
      ? [
          h("strong", {}, text ? t("Nothing matches “{text}”", { text }) : t("No UAV is like that")),
          h("button", { type: "button", class: "button", onclick: onClear }, t("Clear the filter")),
        ]
      : [
          h("strong", {}, kind.none.title),
          h("span", {}, kind.none.text),
          canPlan && h("button", { type: "button", class: "button", onclick: onNew }, kind.one),
        ];
    byId("fleet-empty").replaceChildren(icon(kind.icon, "large"), ...words.filter(Boolean));
  }

  return {
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
      const focused = byId("fleet-rows").contains(document.activeElement)
        ? document.activeElement.getAttribute("href")
        : null;
      head.replaceChildren(
        h(
          "tr",
          {},
          kind.columns.map((column) => h("th", { scope: "col", class: column.class }, column.words)),
        ),
      );
      byId("fleet-rows").replaceChildren(...rows.map((item) => row(kind, item, item.id === chosenId)));
      if (focused)
        [...byId("fleet-rows").querySelectorAll("a")]
          .find((link) => link.getAttribute("href") === focused)
          ?.focus({ preventScroll: true });
      if (!rows.length) empty(kind, isFiltered, text);
    },
    step(by) {
      const links = [...byId("fleet-rows").querySelectorAll("a")];
      if (!links.length) return false;
      links[(links.indexOf(document.activeElement) + by + links.length) % links.length].focus();
      return true;
    },
  };
}
