/** Filters of the register of zones: restriction, reason, set, and whether a zone applies now. */

import { byId, h, setChildren } from "../dom.js";
import { plainWords } from "../map/tips.js";
import { filterField, withCount } from "../register/filters.js";
import { t } from "../text.js";

/** @import { ValueCount, ZoneCounts, ZoneSet } from "../api_types.d.ts" */

const NOT_STATED = "not_stated"; // as the API names it

/**
 * Replace the choices of a filter. The chosen value stays, also where no zone has it.
 *
 * @param {HTMLSelectElement} select
 * @param {string} all words for no filter
 * @param {[string, string][]} choices values and words
 */
function choose(select, all, choices) {
  const { value, selectedOptions } = select;
  const own =
    choices.some(([one]) => one === value) || !value ? [] : [[value, selectedOptions[0]?.textContent ?? value]];
  setChildren(
    select,
    h("option", { value: "" }, all),
    [...own, ...choices].map(([one, words]) => h("option", { value: one, selected: one === value }, words)),
  );
}

/** @param {ValueCount[]} counts @returns {[string, string][]} */
const choicesOf = (counts) =>
  counts.map(({ value, count }) => [
    value || NOT_STATED,
    withCount(value ? plainWords(value) : t("Not stated"), count),
  ]);

/** @param {() => unknown} change called after each change by the user */
export function mountZoneFilters(change) {
  const select = (/** @type {string} */ id) => h("select", { class: "input", id, onchange: change });
  const [restriction, reason, set, when] = ["restriction", "reason", "set", "when"].map((name) =>
    select(`filter-${name}`),
  );
  setChildren(when, h("option", { value: "" }, t("Any time")), h("option", { value: "now" }, t("Now")));
  const clear = () => {
    for (const one of [restriction, reason, set, when]) one.value = "";
    change();
  };
  setChildren(
    byId("zone-filters"),
    filterField(t("Restriction"), restriction),
    filterField(t("Reason"), reason),
    filterField(t("Zone set"), set),
    filterField(t("Applies"), when),
    h("button", { type: "button", class: "text-button", onclick: clear }, t("Clear the filters")),
  );
  const fold = byId("filter-fold", HTMLDetailsElement);
  fold.open = !matchMedia("(max-width: 720px)").matches; // a phone has its list below
  counted({ total: 0, restrictions: [], reasons: [], zone_sets: [] });

  /** Show the values that zones have, with their counts. @param {ZoneCounts} counts */
  function counted({ restrictions, reasons, zone_sets: sets }) {
    choose(restriction, t("All restrictions"), choicesOf(restrictions));
    choose(reason, t("All reasons"), choicesOf(reasons));
    const known = sets.flatMap(({ zone_set: id, name, count }) =>
      id === null ? [] : [[`${id}`, withCount(name, count)]],
    );
    choose(set, t("All sets"), /** @type {[string, string][]} */ (known));
  }

  return {
    counted,
    /** @returns {Record<string, string>} */
    narrowed: () => ({
      restriction: restriction.value,
      reason: reason.value,
      zone_set: set.value,
      active_at: when.value && new Date().toISOString(),
    }),
    /** Narrow the register to a set. @param {ZoneSet} chosen */
    chooseSet({ id, name }) {
      set.append(h("option", { value: id }, name));
      set.value = String(id);
      fold.open = true;
    },
  };
}
