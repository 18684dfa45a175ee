/** What is looked at: the tab, the words, and a UAV's state, type and base. */

import { byId, h } from "../dom.js";
import { t } from "../text.js";
import { KINDS } from "./kinds.js";
import { STATES } from "./words.js";

const TYPING_MS = 250;
export const IN_USE = ""; // all but the retired ones

/** onTab(tab) and onChange() after the store has what was chosen. */
export function mountFilters(store, { onTab, onChange }) {
  const text = byId("fleet-text");
  let typing = 0;

  byId("fleet-tabs").append(
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
    byId("fleet-tabs").querySelector(`input[value=${tab}]`).checked = true;
    byId("of-uavs").hidden = tab !== "uavs";
    text.placeholder = KINDS[tab].hint;
  });

  store.listen(["numbers", "types", "bases"], ({ numbers, types, bases }) => {
    const counts = {
      uavs: numbers && numbers.active + numbers.maintenance,
      types: types?.length,
      bases: bases?.length,
    };
    for (const input of byId("fleet-tabs").querySelectorAll("input"))
      input.parentElement.querySelector(".count").textContent = counts[input.value] ?? "";
  });

  function options(name, chosen, choices) {
    byId(`fleet-${name}`).replaceChildren(
      ...choices.map(([value, words]) => h("option", { value: `${value}`, selected: `${value}` === chosen }, words)),
    );
  }

  store.listen(
    ["numbers", "types", "bases", "state", "type", "base"],
    ({ numbers, types, bases, state, type, base }) => {
      const of = (...names) => (numbers ? ` (${names.reduce((sum, name) => sum + numbers[name], 0)})` : "");
      options("state", state, [
        [IN_USE, t("All but retired") + of("active", "maintenance")],
        ...Object.entries(STATES).map(([value, { words }]) => [value, words + of(value)]),
        ["all", t("All") + of("active", "maintenance", "retired")],
      ]);
      options("type", type, [["", t("Any type")], ...(types ?? []).map((row) => [row.id, row.name])]);
      options("base", base, [["", t("Any base")], ...(bases ?? []).map((row) => [row.id, row.name])]);
    },
  );

  for (const name of ["state", "type", "base"]) {
    byId(`fleet-${name}`).addEventListener("change", (event) => {
      store.update({ [name]: event.target.value });
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
    /** values: those that are not to be empty. */
    set(values) {
      text.value = "";
      store.update({ text: "", state: IN_USE, type: "", base: "", ...values });
    },
  };
}
