/** The fields of a UAV's form, and those of a place on the map. */

import { h } from "../dom.js";
import { choiceField, numberField, switchField, textField } from "../page/fields.js";
import { t } from "../text.js";
import { BOUNDS, boundsIn, usualOf } from "../uav_figures.js";
import { LONG_UNIT, SPEED_UNIT, speedText } from "../units.js";
import { ENDS, LINKS, rangeText } from "./words.js";

/** @import { OwnFigure } from "../uav_figures.js" */
/** @import { Field, FleetBase, FleetType, FormFields, Position, UavBody } from "./types.d.ts" */

/** @typedef {ReturnType<typeof placeFields>} PlaceFields */
/**
 * @typedef {object} FormContext
 * @property {FleetType[]} types
 * @property {FleetBase[]} bases
 * @property {PlaceFields | null} place
 * @property {boolean} isNew
 * @property {boolean} isAdministrator
 */

export const AIRSPEED_BOUNDS = boundsIn("max_airspeed_mps", SPEED_UNIT.mps);

/** @param {...Field} fields */
export const pair = (...fields) =>
  h(
    "div",
    { class: "pair" },
    fields.map((field) => field.element),
  );

/**
 * Latitude and longitude, which the pin on the map follows and sets.
 *
 * @param {Position} position
 * @param {(position: Position) => void} onMove called where it was typed or moved, not where the pin was
 */
export function placeFields(position, onMove) {
  let isTouched = false;
  /** @param {string} name @param {string} label @param {number} value @param {number} most */
  const degrees = (name, label, value, most) =>
    numberField(name, label, value, { digits: 6, required: true, min: -most, max: most, unit: "°" });
  const latitude = degrees("latitude", t("Latitude"), position[1], 90);
  const longitude = degrees("longitude", t("Longitude"), position[0], 180);
  const read = () => /** @type {Position} */ ([longitude.read(), latitude.read()]);
  for (const field of [latitude, longitude])
    field.input.addEventListener("input", () => {
      if (!read().every(Number.isFinite)) return;
      isTouched = true;
      onMove(read());
    });
  /** @param {Position} to */
  function show([lon, lat]) {
    longitude.input.value = `${Number(lon.toFixed(6))}`;
    latitude.input.value = `${Number(lat.toFixed(6))}`;
  }
  return {
    element: h(
      "div",
      {},
      h("div", { class: "pair" }, latitude.element, longitude.element),
      h("p", { class: "caption" }, t("Or drag the pin on the map, or click into it.")),
    ),
    fields: [latitude, longitude],
    read,
    /** Whether the user has set the place. */
    isTouched: () => isTouched,
    /** The pin was moved. @param {Position} to */
    set(to) {
      isTouched = true;
      show(to);
    },
    /** Fields and pin. @param {Position} to */
    move(to) {
      show(to);
      onMove(to);
    },
  };
}

/**
 * Fields of the link through which a UAV receives commands, and of the checks of its messages.
 *
 * @param {UavBody} uav
 * @param {boolean} isAdministrator
 */
function linkFields(uav, isAdministrator) {
  /** @param {"is_simulated" | "allows_unsigned"} name @param {string} label @param {string} hint */
  const waiver = (name, label, hint) =>
    switchField(name, label, uav[name], {
      hint: isAdministrator ? hint : t("Only an administrator changes this."),
      disabled: !isAdministrator,
    });
  return [
    choiceField(
      "link",
      t("Command link"),
      uav.link,
      Object.entries(LINKS).map(([value, { words }]) => [value, words]),
    ),
    waiver("is_simulated", t("Simulated"), t("No real aircraft: it may fly where there is no terrain data.")),
    waiver(
      "allows_unsigned",
      t("MAVLink without a signature"),
      t("Whoever reaches the gateway can then fly it: only on a closed network."),
    ),
  ];
}

/** @param {UavBody} uav */
function figureFields(uav) {
  return {
    range: numberField("max_range_m", t("Range (overrides the type)"), uav.max_range_m, {
      factor: LONG_UNIT.metres,
      unit: LONG_UNIT.unit,
      min: 0.1,
    }),
    speed: numberField("cruise_speed_mps", t("Speed (overrides the type)"), uav.cruise_speed_mps, {
      factor: SPEED_UNIT.mps,
      unit: SPEED_UNIT.unit,
      min: 0.5,
    }),
    battery: numberField("battery_wh", t("Battery (overrides the type)"), uav.battery_wh, {
      unit: "Wh",
      ...BOUNDS.battery_wh,
    }),
    mass: numberField("mass_kg", t("Mass (overrides the type)"), uav.mass_kg, { unit: "kg", ...BOUNDS.mass_kg }),
    reserve: numberField("reserve_percent", t("Reserve (overrides the type)"), uav.reserve_percent, {
      unit: "%",
      digits: 1,
      ...BOUNDS.reserve_percent,
    }),
    airspeed: numberField("max_airspeed_mps", t("Maximum airspeed (overrides the type)"), uav.max_airspeed_mps, {
      factor: SPEED_UNIT.mps,
      unit: SPEED_UNIT.unit,
      ...AIRSPEED_BOUNDS,
    }),
  };
}

/** The values in effect where a UAV has no range and speed of its own. @param {FleetType | undefined} type */
const usualText = (type) =>
  type
    ? t("Blank: {range} and {speed} of the type.", {
        range: rangeText(type.max_range_m, type.range_unlimited),
        speed: speedText(type.cruise_speed_mps),
      })
    : t("Blank: range not stated, default speed.");

/**
 * The figures that a UAV may override. The value in effect is the placeholder of an empty field.
 *
 * @param {UavBody} uav
 * @param {Field<number | null>} type the field of its type
 * @param {FleetType[]} types
 */
function ownFigures(uav, type, types) {
  const { range, speed, battery, mass, reserve, airspeed } = figureFields(uav);
  const power = [battery, mass, reserve, airspeed];
  const hint = h("p", { class: "caption", role: "status" });
  const powerHint = h("p", { class: "caption", role: "status" });

  const typeNow = () => types.find((row) => row.id === type.read());
  const showHint = () => {
    hint.textContent = usualText(typeNow());
  };
  function showUsual() {
    const chosen = typeNow();
    for (const field of power) field.usual(usualOf(chosen)[/** @type {OwnFigure} */ (field.name)]);
    range.usual(chosen?.max_range_m);
    speed.usual(chosen?.cruise_speed_mps);
    const isCounted = Boolean(chosen?.battery_wh) || battery.read() !== null;
    const grey = chosen ? t("Blank: value of the type (grey).") : t("Blank: default value (grey).");
    powerHint.textContent = isCounted ? grey : t("{grey} Without a battery, energy is not calculated.", { grey });
  }
  type.input.addEventListener("change", () => {
    showHint();
    showUsual();
  });
  battery.input.addEventListener("input", showUsual);
  showHint();
  showUsual();
  return {
    fields: [range, speed, ...power],
    elements: [
      h("div", {}, pair(range, speed), hint),
      h("div", { class: "stack-tight" }, pair(battery, mass), pair(reserve, airspeed), powerHint),
    ],
  };
}

/**
 * The button that moves a UAV to its base. A new one moves there with the choice of the base, unless its place was chosen before.
 *
 * @param {Field<number | null>} base the field of its base
 * @param {FormContext} context
 */
function toBaseButton(base, { bases, place, isNew }) {
  const toBase = () => {
    const chosen = bases.find((row) => row.id === base.read());
    if (chosen) place?.move(chosen.position);
  };
  const button = h("button", { type: "button", class: "text-button", onclick: toBase }, t("Put it at its base"));
  const showButton = () => {
    button.hidden = base.read() === null;
  };
  base.input.addEventListener("change", () => {
    showButton();
    if (isNew && !place?.isTouched()) toBase();
  });
  showButton();
  return button;
}

/** @param {UavBody} uav @param {FormContext} context @returns {FormFields} */
export function uavFields(uav, context) {
  const { types, bases, place, isAdministrator } = context;
  const name = textField("name", t("Name"), uav.name, { required: true });
  const type = idField("type", t("Type"), uav.type, types, { required: true });
  const base = idField("base", t("Base"), uav.base, bases);
  const figures = ownFigures(uav, type, types);
  const charge = numberField("battery_percent", t("Battery charge"), uav.battery_percent, {
    unit: "%",
    min: 0,
    max: 100,
    digits: 1,
  });
  const systemId = numberField("mavlink_system_id", t("MAVLink system id"), uav.mavlink_system_id, {
    min: 1,
    max: 254,
    step: 1,
    digits: 0,
  });
  const rest = [
    textField("sensor", t("Sensor besides those of its type"), uav.sensor),
    choiceField("end_action", t("At the end, where a mission does not say “Return to start”"), uav.end_action, ENDS),
    textField("serial_number", t("Serial number"), uav.serial_number),
    ...linkFields(uav, isAdministrator),
  ];
  return {
    fields: [name, type, base, ...figures.fields, charge, systemId, ...rest],
    elements: [
      name.element,
      pair(type, base),
      place?.element,
      toBaseButton(base, context),
      figures.elements,
      pair(charge, systemId),
      rest.map((field) => field.element),
    ],
  };
}

/**
 * @param {string} name
 * @param {string} label
 * @param {number | null} value
 * @param {{ id: number, name: string }[]} rows
 * @param {{ required?: boolean }} [how]
 */
function idField(name, label, value, rows, { required = false } = {}) {
  /** @type {[string | number, string][]} */
  const choices = [
    ["", required ? t("Choose a type") : t("not stated")],
    ...rows.map((row) => /** @type {[number, string]} */ ([row.id, row.name])),
  ];
  return /** @type {Field<number | null>} */ (choiceField(name, label, value, choices, { isNumber: true, required }));
}
