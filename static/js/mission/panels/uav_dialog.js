/** Where a UAV starts, how far and how fast it flies, with which battery, and how its flight ends: for a new one, or for this mission alone. */

import { ApiError, signInAddress } from "../../api.js";
import { h } from "../../dom.js";
import { open } from "../../page/keyboard.js";
import { t } from "../../text.js";
import { LONG_UNIT, SPEED_UNIT } from "../../units.js";
import { MOST_TARGETS } from "../picking.js";

const MOST_SORTIES = 20; // missions/serializers/limits.py

let fields = 0; // each has an id of its own

function field(label, input, unit = "") {
  fields += 1;
  input.id = `field-${fields}`;
  return h("div", { class: "field" }, h("label", { for: input.id }, label), unit ? h("div", { class: "with-unit" }, input, h("span", { class: "unit" }, unit)) : input);
}

function number(value, min, max, required = true) {
  return h("input", { class: "input", type: "number", step: "any", min, max, required, value: value ?? "" });
}

export const END_CHOICES = [
  ["hover", t("Hover over its last target")],
  ["return", t("Return to start")],
  ["land", t("Land at its last target")],
  ["base", t("Land at the nearest base")],
];

const inUnits = (value, unit) => Number((value / unit).toPrecision(6));

/** A value of this mission's own; empty it is the type's. */
function own(value, min, max, unit = 1) {
  const input = number(value === null || value === undefined ? "" : inUnits(value, unit), min, max, false);
  input.placeholder = t("as its type");
  return input;
}

/** What a field says in SI units. One that nobody touched is what it was: typed units are rounded. */
function kept(input, before, unit) {
  if (!Number.isFinite(input.valueAsNumber)) return null;
  if (before !== null && before !== undefined && input.valueAsNumber === inUnits(before, unit)) return before;
  return input.valueAsNumber * unit;
}

/** A new one has a name and a base as well; battery and airspeed are its type's until a mission says otherwise. */
export function uavDialog({ title, note, uav, isNew = false, act, submit }) {
  const longitude = number(Number(uav.position[0].toFixed(6)), -180, 180);
  const latitude = number(Number(uav.position[1].toFixed(6)), -90, 90);
  const name = h("input", { class: "input", required: true, maxlength: 100, value: uav.name });
  const base = h("input", { class: "input", maxlength: 100, value: uav.base_name });
  const range = number(uav.max_range_m === null ? "" : inUnits(uav.max_range_m, LONG_UNIT.metres), 0.1, 1000, false);
  const speed = number(uav.cruise_speed_mps === null || uav.cruise_speed_mps === undefined ? "" : inUnits(uav.cruise_speed_mps, SPEED_UNIT.mps), 0.5, 300, false);
  const end = h("select", { class: "input" }, END_CHOICES.map(([value, words]) => h("option", { value, selected: value === uav.end_action }, words)));
  const most = h("input", { class: "input", type: "number", min: 1, max: MOST_TARGETS, step: 1, placeholder: t("as many as fit"), value: uav.most_targets ?? "" });
  const battery = own(uav.battery_wh, 0.1, 100_000);
  const mass = own(uav.mass_kg, 0.01, 10_000);
  const reserve = own(uav.reserve_percent, 0, 95);
  const airspeed = own(uav.max_airspeed_mps, 0.5, 300, SPEED_UNIT.mps);
  const sorties = h("input", { class: "input", type: "number", min: 1, max: MOST_SORTIES, step: 1, required: true, value: uav.sorties ?? 1 });
  const unlimited = h("p", { class: "caption", role: "status" });
  const wrong = h("p", { class: "field-error", role: "alert" });
  const sayWhatIsMissing = () => (unlimited.textContent = range.value ? "" : t("Range not stated: it is planned as unlimited."));
  range.addEventListener("input", sayWhatIsMissing);
  sayWhatIsMissing();
  const dialog = h("dialog", { "aria-labelledby": "place-title" });
  const form = h(
    "form",
    { method: "dialog" },
    h("div", {}, h("h2", { id: "place-title" }, title), h("p", { class: "quiet-text" }, note)),
    isNew && h("div", { class: "pair" }, field(t("Name"), name), field(t("Base"), base)),
    h("div", {}, h("div", { class: "pair" }, field(t("Range"), range, LONG_UNIT.unit), field(t("Speed"), speed, SPEED_UNIT.unit)), unlimited),
    !isNew &&
      h(
        "div",
        { class: "stack", role: "group", "aria-label": t("Battery and airspeed") },
        h("div", { class: "pair" }, field(t("Battery"), battery, "Wh"), field(t("Kept in reserve"), reserve, "%")),
        h("div", { class: "pair" }, field(t("Mass at take-off"), mass, "kg"), field(t("Highest airspeed"), airspeed, SPEED_UNIT.unit)),
        h("p", { class: "caption own-values" }, t("Empty: as its type. Without a battery its energy is not planned.")),
      ),
    field(t("End, where “Return to start” is off"), end),
    !isNew && h("div", {}, h("div", { class: "pair" }, field(t("At most this many targets"), most), field(t("At most this many flights"), sorties)), h("p", { class: "caption" }, t("More than one flight only where it returns to its start; each on a full battery."), " ", uav.sensors?.length ? t("Sensors: {names}", { names: uav.sensors.join(", ") }) : t("No sensor is stated for it."))),
    h("div", { class: "pair" }, field(t("Latitude"), latitude, "°"), field(t("Longitude"), longitude, "°")),
    wrong,
    h("div", { class: "acts" }, h("button", { type: "button", class: "button", onclick: () => dialog.close() }, t("Cancel")), h("button", { class: "button primary" }, act)),
  );
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    try {
      await submit({
        name: name.value.trim(),
        base_name: base.value.trim(),
        position: [longitude.valueAsNumber, latitude.valueAsNumber],
        max_range_m: kept(range, uav.max_range_m, LONG_UNIT.metres),
        cruise_speed_mps: kept(speed, uav.cruise_speed_mps, SPEED_UNIT.mps),
        end_action: end.value,
        ...(isNew ? {} : { most_targets: Number.isFinite(most.valueAsNumber) ? most.valueAsNumber : null, sorties: sorties.valueAsNumber, battery_wh: kept(battery, uav.battery_wh, 1), mass_kg: kept(mass, uav.mass_kg, 1), reserve_percent: kept(reserve, uav.reserve_percent, 1), max_airspeed_mps: kept(airspeed, uav.max_airspeed_mps, SPEED_UNIT.mps) }),
      });
      dialog.close();
    } catch (error) {
      wrong.replaceChildren(error instanceof ApiError ? error.message : t("It could not be added."), error.isSignedOut ? h("a", { href: signInAddress() }, t("Sign in")) : "");
    }
  });
  dialog.append(form);
  open(dialog);
  if (isNew) name.select();
}
