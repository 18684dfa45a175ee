/** Where a UAV starts, how far and how fast it flies, with which battery, and how its flight ends: for a new one, or for this mission alone. */

import { ApiError, get, signInAddress } from "../../../api.js";
import { h, icon } from "../../../dom.js";
import { open } from "../../../page/keyboard.js";
import { t } from "../../../text.js";
import { boundsIn, usualOf } from "../../../uav_figures.js";
import { LONG_UNIT, SPEED_UNIT } from "../../../units.js";
import { MOST_TARGETS } from "../../picking.js";

const MOST_SORTIES = 20; // missions/serializers/limits.py

let fields = 0; // each has an id of its own

function field(label, input, unit = "") {
  fields += 1;
  input.id = `field-${fields}`;
  const fault = h("p", { class: "field-error", id: `${input.id}-fault`, hidden: true });
  input.setAttribute("aria-describedby", fault.id);
  return h(
    "div",
    { class: "field" },
    h("label", { for: input.id }, label),
    unit ? h("div", { class: "with-unit" }, input, h("span", { class: "unit" }, unit)) : input,
    fault,
  );
}

/** Says beside a field what is wrong with it; empty words take that away. */
function tell(input, words) {
  const fault = input.closest(".field").querySelector(".field-error");
  fault.hidden = !words;
  fault.replaceChildren(...(words ? [icon("circle-alert", "small"), words] : []));
  if (words) input.setAttribute("aria-invalid", "true");
  else input.removeAttribute("aria-invalid");
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

/** A value of its own, in units of so many of the stored ones; empty it is what stands in grey. */
function own(name, value, unit = 1) {
  const { min, max } = boundsIn(name, unit);
  return number(value === null || value === undefined ? "" : inUnits(value, unit), min, max, false);
}

/** What a field says in SI units. One that nobody touched is what it was: typed units are rounded. */
function kept(input, before, unit) {
  if (!Number.isFinite(input.valueAsNumber)) return null;
  if (before !== null && before !== undefined && input.valueAsNumber === inUnits(before, unit)) return before;
  return input.valueAsNumber * unit;
}

/** A new one has a name, a base and a type as well; where a field of its battery and airspeed is empty, what counts stands in it in grey. */
export function uavDialog({ title, note, uav, isNew = false, act, submit }) {
  const longitude = number(Number(uav.position[0].toFixed(6)), -180, 180);
  const latitude = number(Number(uav.position[1].toFixed(6)), -90, 90);
  const name = h("input", { class: "input", required: true, maxlength: 100, value: uav.name });
  const base = h("input", { class: "input", maxlength: 100, value: uav.base_name });
  const range = number(uav.max_range_m === null ? "" : inUnits(uav.max_range_m, LONG_UNIT.metres), 0.1, 1000, false);
  const speed = number(
    uav.cruise_speed_mps === null || uav.cruise_speed_mps === undefined
      ? ""
      : inUnits(uav.cruise_speed_mps, SPEED_UNIT.mps),
    0.5,
    300,
    false,
  );
  const end = h(
    "select",
    { class: "input" },
    END_CHOICES.map(([value, words]) => h("option", { value, selected: value === uav.end_action }, words)),
  );
  const most = h("input", {
    class: "input",
    type: "number",
    min: 1,
    max: MOST_TARGETS,
    step: 1,
    placeholder: t("as many as fit"),
    value: uav.most_targets ?? "",
  });
  const battery = own("battery_wh", uav.battery_wh);
  const mass = own("mass_kg", uav.mass_kg);
  const reserve = own("reserve_percent", uav.reserve_percent);
  const airspeed = own("max_airspeed_mps", uav.max_airspeed_mps, SPEED_UNIT.mps);
  const type = h("select", { class: "input", onchange: takesType }, h("option", { value: "" }, t("none")));
  const byName = {
    name,
    base_name: base,
    max_range_m: range,
    cruise_speed_mps: speed,
    battery_wh: battery,
    mass_kg: mass,
    reserve_percent: reserve,
    max_airspeed_mps: airspeed,
    end_action: end,
    type,
  };
  let types = [];
  function showUsual(usual) {
    const units = { max_airspeed_mps: SPEED_UNIT.mps };
    for (const [figure, value] of Object.entries(usual))
      byName[figure].placeholder = value === null ? "" : inUnits(value, units[figure] ?? 1);
  }
  showUsual(uav.usual ?? usualOf(null));

  function takesType() {
    const chosen = types.find(({ id }) => `${id}` === type.value);
    showUsual(usualOf(chosen));
    range.placeholder = chosen?.max_range_m ? inUnits(chosen.max_range_m, LONG_UNIT.metres) : "";
    speed.placeholder = chosen ? inUnits(chosen.cruise_speed_mps, SPEED_UNIT.mps) : "";
    sayWhatIsMissing();
  }
  const sorties = h("input", {
    class: "input",
    type: "number",
    min: 1,
    max: MOST_SORTIES,
    step: 1,
    required: true,
    value: uav.sorties ?? 1,
  });
  const unlimited = h("p", { class: "caption", role: "status" });
  const wrong = h("p", { class: "field-error", role: "alert" });
  const sayWhatIsMissing = () =>
    (unlimited.textContent =
      range.value || range.placeholder ? "" : t("Range not stated: it is planned as unlimited."));
  range.addEventListener("input", sayWhatIsMissing);
  sayWhatIsMissing();
  const dialog = h("dialog", { "aria-labelledby": "place-title" });
  const ofType = isNew && field(t("Type"), type);
  const form = h(
    "form",
    { method: "dialog" },
    h("div", {}, h("h2", { id: "place-title" }, title), h("p", { class: "quiet-text" }, note)),
    isNew && h("div", { class: "pair" }, field(t("Name"), name), field(t("Base"), base)),
    ofType,
    h(
      "div",
      {},
      h("div", { class: "pair" }, field(t("Range"), range, LONG_UNIT.unit), field(t("Speed"), speed, SPEED_UNIT.unit)),
      unlimited,
    ),
    h(
      "div",
      { class: "stack", role: "group", "aria-label": t("Battery and airspeed") },
      h("div", { class: "pair" }, field(t("Battery"), battery, "Wh"), field(t("Kept in reserve"), reserve, "%")),
      h(
        "div",
        { class: "pair" },
        field(t("Mass at take-off"), mass, "kg"),
        field(t("Highest airspeed"), airspeed, SPEED_UNIT.unit),
      ),
      h(
        "p",
        { class: "caption own-values" },
        isNew
          ? t("Empty: as its type, in grey. Without a battery its energy is not planned.")
          : t("Empty: as in the fleet, in grey. Without a battery its energy is not planned."),
      ),
    ),
    field(t("End, where “Return to start” is off"), end),
    !isNew &&
      h(
        "div",
        {},
        h(
          "div",
          { class: "pair" },
          field(t("At most this many targets"), most),
          field(t("At most this many flights"), sorties),
        ),
        h(
          "p",
          { class: "caption" },
          t("More than one flight only where it returns to its start; each on a full battery."),
          " ",
          uav.sensors?.length
            ? t("Sensors: {names}", { names: uav.sensors.join(", ") })
            : t("No sensor is stated for it."),
        ),
      ),
    h("div", { class: "pair" }, field(t("Latitude"), latitude, "°"), field(t("Longitude"), longitude, "°")),
    wrong,
    h(
      "div",
      { class: "acts" },
      h("button", { type: "button", class: "button", onclick: () => dialog.close() }, t("Cancel")),
      h("button", { class: "button primary" }, act),
    ),
  );
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    Object.values(byName)
      .filter((input) => form.contains(input))
      .forEach((input) => tell(input, ""));
    wrong.replaceChildren();
    try {
      await submit({
        name: name.value.trim(),
        base_name: base.value.trim(),
        position: [longitude.valueAsNumber, latitude.valueAsNumber],
        max_range_m: kept(range, uav.max_range_m, LONG_UNIT.metres),
        cruise_speed_mps: kept(speed, uav.cruise_speed_mps, SPEED_UNIT.mps),
        end_action: end.value,
        battery_wh: kept(battery, uav.battery_wh, 1),
        mass_kg: kept(mass, uav.mass_kg, 1),
        reserve_percent: kept(reserve, uav.reserve_percent, 1),
        max_airspeed_mps: kept(airspeed, uav.max_airspeed_mps, SPEED_UNIT.mps),
        ...(isNew
          ? { type: type.value ? Number(type.value) : null }
          : {
              most_targets: Number.isFinite(most.valueAsNumber) ? most.valueAsNumber : null,
              sorties: sorties.valueAsNumber,
            }),
      });
      dialog.close();
    } catch (error) {
      const told = Object.entries(error.details ?? {}).filter(([part]) => byName[part] && form.contains(byName[part]));
      for (const [part, words] of told) tell(byName[part], [words].flat().join(" "));
      if (told.length) byName[told[0][0]].focus();
      else
        wrong.replaceChildren(
          error instanceof ApiError ? error.message : t("It could not be added."),
          error.isSignedOut ? h("a", { href: signInAddress() }, t("Sign in")) : "",
        );
    }
  });
  dialog.append(form);
  open(dialog);
  if (!isNew) return;
  name.select();
  ofType.hidden = true; // until there are types to choose from
  get("/uav-types?limit=100").then(
    ({ data }) => {
      types = data.results;
      type.append(...types.map((row) => h("option", { value: row.id }, row.name)));
      ofType.hidden = !types.length;
    },
    () => {}, // it is added without one
  );
}
