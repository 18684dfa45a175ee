/** The side of the page: which gaps, and the list of them. */

import { byId, h, icon, keyedList, refill } from "../dom.js";
import { t } from "../text.js";
import { numberText } from "../units.js";
import { cutOffText, KINDS, STATES } from "./kinds.js";

const TYPED_MS = 250;

/** on: { narrow(filter), choose(id), point(gap or null), more() }. Returns { filter, busy(whether), show(…), counts(…), mark(id), step(±1), openNext(), focusText() }. */
export function mountGapList(on) {
  const filter = { state: "open", kinds: new Set(), text: "", inView: false };
  const list = byId("gap-list");
  const end = byId("gap-list-end");
  const states = byId("gap-states");
  const kinds = byId("gap-kinds");
  const text = byId("gap-text");
  const change = () => on.narrow(filter);
  let chosenId = null;
  let chosenIndex = 0; // of the row that is or was chosen: what follows takes its place
  let typing = 0;

  const radios = STATES.map(({ state, name }) => {
    const input = h("input", { type: "radio", name: "gap-state", value: state, checked: state === filter.state });
    const count = h("span", { class: "count" });
    input.addEventListener("change", () => {
      filter.state = state;
      change();
    });
    states.append(h("label", {}, input, h("span", { class: "segment" }, h("span", {}, name), count)));
    return { state, count };
  });
  const chips = Object.entries(KINDS).map(([kind, { name }]) => {
    const count = h("span", { class: "count" });
    const chip = h("button", { class: "kind-chip", type: "button", "aria-pressed": "false" }, name, count);
    chip.addEventListener("click", () => {
      if (!filter.kinds.delete(kind)) filter.kinds.add(kind);
      chip.setAttribute("aria-pressed", String(filter.kinds.has(kind)));
      change();
    });
    kinds.append(chip);
    return { kind, count, chip };
  });
  text.addEventListener("input", () => {
    clearTimeout(typing);
    typing = setTimeout(() => {
      filter.text = text.value.trim();
      change();
    }, TYPED_MS);
  });
  byId("gap-in-view").addEventListener("change", (event) => {
    filter.inView = event.target.checked;
    change();
  });

  const draw = keyedList(list, (gap) => gap.id, makeRow, refreshRow);

  function makeRow() {
    const row = h("button", { class: "gap-row", type: "button" });
    const item = h("li", {}, row);
    row.addEventListener("click", () => on.choose(Number(item.dataset.id)));
    return item;
  }

  function refreshRow(item, gap) {
    const { kind, title, asset, cut_off_m, details } = gap.properties;
    const row = item.firstElementChild;
    item.dataset.id = gap.id;
    const words = [
      title,
      whose(asset),
      cutOffText({ kind, cut_off_m }) || (details.is_advisory ? t("may be right") : ""),
    ];
    refill(row, [kind, ...words].join("\n"), () => [
      icon(KINDS[kind].icon),
      h("span", { class: "what" }, h("strong", {}, words[0]), h("small", {}, words[1])),
      h("span", { class: "figure" }, words[2]),
    ]);
    row.onpointerenter = row.onfocus = () => on.point(gap);
    row.onpointerleave = row.onblur = () => on.point(null);
    row.setAttribute("aria-current", String(gap.id === chosenId));
  }

  const rowsNow = () => [...list.querySelectorAll(".gap-row")];

  const clearFilters = () => {
    filter.kinds.clear();
    filter.text = text.value = "";
    filter.inView = byId("gap-in-view").checked = false;
    chips.forEach(({ chip }) => chip.setAttribute("aria-pressed", "false"));
    change();
  };

  function empty(hasSearched) {
    if (!hasSearched)
      return [
        h("strong", {}, t("The ground is being searched.")),
        h("p", {}, t("Gaps come up here when that is done.")),
        h("div", { class: "skeleton" }),
        h("div", { class: "skeleton" }),
      ];
    if (filter.kinds.size || filter.text || filter.inView) {
      const what = filter.text ? t("No gap matches “{text}”.", { text: filter.text }) : t("No gap like that here.");
      return [
        h("strong", {}, what),
        h("button", { class: "button", type: "button", onclick: clearFilters }, t("Clear the filter")),
      ];
    }
    if (filter.state === "open")
      return [
        icon("circle-check"),
        h("strong", {}, t("Nothing looks wrong here.")),
        h("p", {}, t("The ground is searched again after each change.")),
      ];
    return [
      h(
        "strong",
        {},
        filter.state === "repaired" ? t("Nothing has been repaired yet.") : t("Nothing has been left as it is."),
      ),
    ];
  }

  return {
    filter,
    focusText: () => text.focus(),
    /** Whether the list is still that of the filter before. */
    busy: (isBusy) => list.setAttribute("aria-busy", String(isBusy)),
    /** The loaded gaps, and whether there are more. */
    show(gaps, { hasMore, hasSearched }) {
      draw(gaps);
      end.replaceChildren(
        ...(gaps.length ? [] : [h("div", { class: "empty" }, empty(hasSearched))]),
        ...(hasMore
          ? [h("button", { class: "button quiet more", type: "button", onclick: on.more }, t("Show more"))]
          : []),
      );
    },
    /** kinds: number by kind, then state. */
    counts(numbers) {
      for (const { state, count } of radios)
        count.textContent = numberText(sum(Object.values(numbers).map((byState) => byState[state])));
      for (const { kind, count, chip } of chips) {
        const number = numbers[kind]?.[filter.state] ?? 0;
        count.textContent = numberText(number);
        chip.hidden = !number && !filter.kinds.has(kind);
      }
    },
    mark(id) {
      chosenId = id;
      rowsNow().forEach((row, index) => {
        const isChosen = Number(row.parentElement.dataset.id) === id;
        row.setAttribute("aria-current", String(isChosen));
        if (!isChosen) return;
        chosenIndex = index;
        row.scrollIntoView({ block: "nearest" });
      });
    },
    /** Moves the focus along the rows; from outside to the one beside the chosen one. */
    step(by) {
      const rows = rowsNow();
      const focused = rows.indexOf(document.activeElement);
      const isThere = Number(rows[chosenIndex]?.parentElement.dataset.id) === chosenId;
      const from = focused >= 0 ? focused : isThere ? chosenIndex : chosenIndex - (by > 0 ? 1 : 0);
      rows[Math.max(0, Math.min(rows.length - 1, from + by))]?.focus();
    },
    /** The gap that has taken the place of the chosen one, which is off the list. */
    openNext() {
      const rows = rowsNow();
      rows[Math.min(chosenIndex, rows.length - 1)]?.click();
    },
  };
}

const sum = (numbers) => numbers.reduce((total, number) => total + number, 0);

const whose = (asset) => (asset ? [asset.label, asset.detail].filter(Boolean).join(", ") : "");
