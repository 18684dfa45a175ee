/** Departure, conditions, and whether UAVs charge on towers. */

import { byId, h } from "../../../dom.js";
import { t } from "../../../text.js";
import { compassText, momentTyped, typedMoment, zoneText } from "../../../units.js";
import { conditionsText, nextMinute } from "../../options/flight_options.js";
import { windArrow } from "../../options/wind_arrow.js";
import { askForConditions } from "./conditions.js";
import { showLegalTimes } from "./legal_times.js";

/** @import { MissionActions, MissionSelection, MissionStore } from "../../types.d.ts" */

const USUAL_CHARGING_W = 100;
const MAX_CHARGING_W = 5000;

/** @param {MissionStore} store @param {MissionActions} actions */
export function mountFlightOptions(store, actions) {
  byId("flight-options").append(
    departureOption(store, actions),
    airOption(store, actions),
    ...chargingOptions(store, actions),
  );
}

/** The effect of a departure on zones; one in the past is reported. @param {MissionSelection} selection */
function departureWords({ departs_at }) {
  if (!departs_at) return t("No departure time: all zones count as active.");
  const where = zoneText(departs_at);
  if (Date.parse(departs_at) < Date.now())
    return t("{zone}. This moment has passed; zones count at it all the same.", { zone: where });
  return t("{zone}. Zones count at the times when the UAVs pass.", { zone: where });
}

/** @param {MissionStore} store @param {MissionActions} actions */
function departureOption(store, actions) {
  /** @param {string | null} moment */
  const depart = (moment) => actions.setOption("departs_at", moment);
  const departure = h("input", {
    class: "input",
    type: "datetime-local",
    id: "departure",
    "aria-describedby": "departure-words",
  });
  departure.addEventListener("change", () => depart(momentTyped(departure.value)));
  const summary = h("p", { class: "caption", id: "departure-words", role: "status" });
  const now = h("button", { type: "button", class: "button", onclick: () => depart(nextMinute(Date.now())) }, t("Now"));
  const anyTime = h("button", { type: "button", class: "button quiet" }, t("Any time"));
  anyTime.addEventListener("click", () => {
    depart(null);
    departure.focus();
  });
  const legal = h(
    "button",
    { type: "button", class: "text-button", onclick: () => showLegalTimes(store, actions) },
    t("When are the zones open?"),
  );
  const element = h(
    "div",
    { class: "flight-option" },
    h("label", { for: departure.id, class: "field-label" }, t("Departure")),
    h("div", { class: "departure-row" }, departure, now, anyTime),
    summary,
    legal,
  );
  store.listen(["selection"], ({ selection }) => {
    const typed = selection.departs_at ? typedMoment(selection.departs_at) : "";
    if (departure.value !== typed) departure.value = typed;
    summary.textContent = departureWords(selection);
    anyTime.hidden = !selection.departs_at;
  });
  return element;
}

/** @param {MissionStore} store @param {MissionActions} actions */
function airOption(store, actions) {
  const air = h("p", { class: "air" });
  const change = () =>
    askForConditions(store.state.selection.conditions, (conditions) => actions.setOption("conditions", conditions));
  const element = h(
    "div",
    { class: "flight-option", role: "group", "aria-labelledby": "air-title" },
    h(
      "div",
      { class: "option-head" },
      h("h3", { id: "air-title", class: "field-label" }, t("Conditions")),
      h(
        "button",
        { type: "button", class: "text-button", "aria-label": t("Change the conditions"), onclick: change },
        t("Change"),
      ),
    ),
    air,
  );
  store.listen(["selection"], ({ selection: { conditions } }) => {
    const arrows = (conditions?.wind ?? [])
      .filter(({ speed_mps }) => speed_mps > 0)
      .map(({ from_deg }) =>
        h("span", { title: t("from the {side}", { side: compassText(from_deg) }) }, windArrow(from_deg)),
      );
    air.replaceChildren(...arrows, conditionsText(conditions));
  });
  return element;
}

/** @param {MissionStore} store @param {MissionActions} actions */
function chargingOptions(store, actions) {
  const power = h("input", {
    class: "input",
    type: "number",
    id: "charging-power",
    min: 1,
    max: MAX_CHARGING_W,
    step: "any",
  });
  power.addEventListener("change", () => {
    if (power.validity.valid && power.value) actions.setOption("charging_w", power.valueAsNumber);
  });
  const powerField = h(
    "div",
    { class: "field charging-power" },
    h("label", { for: power.id }, t("Power while charging")),
    h("div", { class: "with-unit" }, power, h("span", { class: "unit" }, "W")),
  );
  const charges = h("input", { class: "switch", type: "checkbox", role: "switch" });
  charges.addEventListener("change", () => actions.setOption("charging_w", charges.checked ? USUAL_CHARGING_W : null));
  const row = h(
    "label",
    { class: "switch-row" },
    h("span", {}, t("Charging on towers"), h("small", { class: "caption" }, t("Allow charging stops on towers"))),
    charges,
  );
  store.listen(["selection"], ({ selection: { charging_w } }) => {
    const isOn = charging_w !== null && charging_w !== undefined;
    charges.checked = isOn;
    powerField.hidden = !isOn;
    if (isOn && power.valueAsNumber !== charging_w) power.value = `${charging_w}`;
  });
  return [row, powerField];
}
