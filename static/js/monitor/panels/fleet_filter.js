/** Filter above the fleet of the live page: a search and a choice of groups, with the count of hidden UAVs. */

import { byId, h } from "../../dom.js";
import { t } from "../../text.js";
import { EVERYTHING } from "../fleet_groups.js";

/** @import { MonitorStore } from "../types.d.ts" */
/** @import { FleetKind } from "../fleet_groups.js" */

/** @type {[FleetKind, string][]} */
const KINDS = [
  ["all", t("All UAVs")],
  ["flying", t("In the air")],
  ["alerts", t("With alerts")],
  ["silent", t("Without telemetry")],
];

/** @param {MonitorStore} store */
export function mountFleetFilter(store) {
  const text = h("input", {
    class: "input",
    type: "search",
    autocomplete: "off",
    maxlength: 80,
    placeholder: t("Find a UAV or a mission"),
    "aria-label": t("Find a UAV or a mission"),
  });
  const kind = h(
    "select",
    { class: "input", "aria-label": t("Which UAVs") },
    KINDS.map(([value, words]) => h("option", { value }, words)),
  );
  const count = h("span", { role: "status" });
  const clear = h("button", { type: "button", class: "text-button", onclick: reset }, t("Clear the filter"));
  const hidden = h("p", { class: "caption fleet-hidden", hidden: true }, count, " ", clear);
  byId("fleet-filter").append(text, kind, hidden);

  function change() {
    store.update({ filter: { text: text.value, kind: /** @type {FleetKind} */ (kind.value) } });
  }

  function reset() {
    text.value = "";
    kind.value = "all";
    store.update({ filter: EVERYTHING });
    text.focus();
  }

  text.addEventListener("input", change);
  kind.addEventListener("change", change);
  return {
    /** @param {number} shown @param {number} all */
    notify(shown, all) {
      hidden.hidden = shown === all;
      const words = t("{shown} of {all} UAVs shown.", { shown, all });
      if (count.textContent !== words) count.textContent = words;
    },
  };
}
