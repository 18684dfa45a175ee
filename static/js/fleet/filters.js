/** Filters of the fleet: the tab, the search text, and a UAV's state, type and base. */

import { byId, find, h } from "../dom.js";
import { t } from "../text.js";
import { KINDS } from "./kinds.js";
import { STATES } from "./words.js";

/** @import { UavState } from "../api_types.d.ts" */
/** @import { FleetState, Store, Tab } from "./types.d.ts" */

const TYPING_MS = 250;
export const IN_USE = ""; // all but the retired ones
/** @type {("state" | "type" | "base")[]} */
const SELECTS = ["state", "type", "base"];

/**
 * Mount the filters. Calls onTab(tab) and onChange() after the store has the choice.
 *
 * @param {Store<FleetState>} store
 * @param {{ onTab: (tab: Tab) => unknown, onChange: () => unknown }} acts
 */
export function mountFilters(store, { onTab, onChange }) {
  const text = byId("fleet-text", HTMLInputElement);
  const tabs = byId("fleet-tabs");
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let typing;

  tabs.append(
    ...Object.values(KINDS).map(({ tab, words }) =>
      h(
        "label",
        {},
        h("input", { type: "radio", name: "fleet-tab", value: tab, onchange: () => onTab(tab) }),
        h("span", { class: "segment" }, words, h("span", { class: "count" })),
      ),
    ),
  );

  store.listen(["tab"], ({ tab }) => {
    find(tabs, `input[value=${tab}]`, HTMLInputElement).checked = true;
    byId("of-uavs").hidden = tab !== "uavs";
    text.placeholder = KINDS[tab].hint;
  });

  store.listen(["numbers", "types", "bases"], ({ numbers, types, bases }) => {
    const counts = {
      uavs: numbers && numbers.active + numbers.maintenance,
      types: types?.length,
      bases: bases?.length,
    };
    for (const label of tabs.querySelectorAll("label")) {
      const tab = /** @type {Tab} */ (find(label, "input", HTMLInputElement).value);
      find(label, ".count").textContent = `${counts[tab] ?? ""}`;
    }
  });

  /**
   * @param {(typeof SELECTS)[number]} name
   * @param {string} chosen
   * @param {(readonly [string | number, string])[]} choices
   */
  function fillSelect(name, chosen, choices) {
    byId(`fleet-${name}`).replaceChildren(
      ...choices.map(([value, words]) => h("option", { value: `${value}`, selected: `${value}` === chosen }, words)),
    );
  }

  store.listen(["numbers", "types", "bases", ...SELECTS], ({ numbers, types, bases, state, type, base }) => {
    /** @param {...UavState} states */
    const of = (...states) => (numbers ? ` (${states.reduce((sum, name) => sum + numbers[name], 0)})` : "");
    fillSelect("state", state, [
      [IN_USE, t("All but retired") + of("active", "maintenance")],
      ["active", STATES.active.words + of("active")],
      ["maintenance", STATES.maintenance.words + of("maintenance")],
      ["retired", STATES.retired.words + of("retired")],
      ["all", t("All") + of("active", "maintenance", "retired")],
    ]);
    fillSelect("type", type, [["", t("Any type")], ...named(types)]);
    fillSelect("base", base, [["", t("Any base")], ...named(bases)]);
  });

  for (const name of SELECTS) {
    const select = byId(`fleet-${name}`, HTMLSelectElement);
    select.addEventListener("change", () => {
      store.update({ [name]: select.value });
      onChange();
    });
  }

  text.addEventListener("input", () => {
    store.update({ text: text.value.trim() });
    clearTimeout(typing);
    if (store.state.tab === "uavs") typing = setTimeout(onChange, TYPING_MS);
  });

  return {
    focus: () => text.focus(),
    /** @param {Partial<Pick<FleetState, "state" | "type" | "base">>} values those that are not to be empty */
    set(values) {
      text.value = "";
      store.update({ text: "", state: IN_USE, type: "", base: "", ...values });
    },
  };
}

/** @param {readonly { id: number, name: string }[] | null} rows @returns {[number, string][]} */
const named = (rows) => (rows ?? []).map(({ id, name }) => [id, name]);
