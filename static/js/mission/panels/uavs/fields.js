/** The fields of a UAV in a mission: name, start, range and speed, battery, end. */

import { find, h, icon } from "../../../dom.js";
import { t } from "../../../text.js";
import { boundsIn } from "../../../uav_figures.js";
import { LONG_UNIT, SPEED_UNIT } from "../../../units.js";
import { MAX_TARGETS } from "../../selection.js";

/** @import { EndActionEnum } from "../../../api_types.d.ts" */
/** @import { OwnFigure } from "../../../uav_figures.js" */
/** @import { PickedUav } from "../../types.d.ts" */

/** @typedef {Omit<PickedUav, "id">} DialogUav what the fields begin with */
/** @typedef {ReturnType<typeof createFields>} Fields */
/** @typedef {HTMLInputElement | HTMLSelectElement} Input */
/**
 * The typed values in SI units.
 *
 * @typedef {object} TypedUav
 * @property {string} name
 * @property {string} base_name
 * @property {number[]} position
 * @property {number | null} max_range_m
 * @property {number | null} cruise_speed_mps
 * @property {EndActionEnum} end_action
 * @property {number | null} battery_wh
 * @property {number | null} mass_kg
 * @property {number | null} reserve_percent
 * @property {number | null} max_airspeed_mps
 */

const MAX_SORTIES = 20; // missions/serializers/limits.py

/** @type {[EndActionEnum, string][]} */
export const END_CHOICES = [
  ["hover", t("Hover over its last target")],
  ["return", t("Return to start")],
  ["land", t("Land at its last target")],
  ["base", t("Land at the nearest base")],
];
/** @type {Partial<Record<string, number>>} */
const UNITS = { max_airspeed_mps: SPEED_UNIT.mps };

let made = 0; // each field has its own id

/** @param {string} label @param {Input} input @param {string} [unit] */
export function field(label, input, unit = "") {
  made += 1;
  input.id = `field-${made}`;
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

/**
 * Show the fault of a field beside it; empty words remove it.
 *
 * @param {Input} input
 * @param {string} words
 */
export function showFault(input, words) {
  const fault = find(/** @type {HTMLElement} */ (input.closest(".field")), ".field-error", HTMLElement);
  fault.hidden = !words;
  fault.replaceChildren(...(words ? [icon("circle-alert", "small"), words] : []));
  if (words) input.setAttribute("aria-invalid", "true");
  else input.removeAttribute("aria-invalid");
}

/** @param {number | ""} value @param {number} min @param {number} max @param {boolean} [required] */
const number = (value, min, max, required = true) =>
  h("input", { class: "input", type: "number", step: "any", min, max, required, value });

/** @param {number} value @param {number} unit */
const inUnits = (value, unit) => Number((value / unit).toPrecision(6));
/** @param {number | null | undefined} value @param {number} unit */
const shownIn = (value, unit) => (value === null || value === undefined ? "" : inUnits(value, unit));

/**
 * A value of its own, in a unit of `unit` stored ones; an empty field has the value of its placeholder.
 *
 * @param {OwnFigure} name
 * @param {number | null | undefined} value
 * @param {number} [unit]
 */
function own(name, value, unit = 1) {
  const { min, max } = boundsIn(name, unit);
  return number(shownIn(value, unit), min, max, false);
}

/**
 * The value of a field in SI units. One that was not touched keeps its value: typed units are rounded.
 *
 * @param {HTMLInputElement} input
 * @param {number | null | undefined} before
 * @param {number} unit
 */
function kept(input, before, unit) {
  if (!Number.isFinite(input.valueAsNumber)) return null;
  if (before !== null && before !== undefined && input.valueAsNumber === inUnits(before, unit)) return before;
  return input.valueAsNumber * unit;
}

/** @param {DialogUav} uav */
export function createFields(uav) {
  const longitude = number(Number(uav.position[0].toFixed(6)), -180, 180);
  const latitude = number(Number(uav.position[1].toFixed(6)), -90, 90);
  const byName = {
    name: h("input", { class: "input", required: true, maxlength: 100, value: uav.name }),
    base_name: h("select", { class: "input" }, h("option", { value: "" }, t("none"))),
    max_range_m: number(shownIn(uav.max_range_m, LONG_UNIT.metres), 0.1, 1000, false),
    cruise_speed_mps: number(shownIn(uav.cruise_speed_mps, SPEED_UNIT.mps), 0.5, 300, false),
    battery_wh: own("battery_wh", uav.battery_wh),
    mass_kg: own("mass_kg", uav.mass_kg),
    reserve_percent: own("reserve_percent", uav.reserve_percent),
    max_airspeed_mps: own("max_airspeed_mps", uav.max_airspeed_mps, SPEED_UNIT.mps),
    end_action: h(
      "select",
      { class: "input" },
      END_CHOICES.map(([value, words]) => h("option", { value, selected: value === uav.end_action }, words)),
    ),
  };
  return {
    latitude,
    longitude,
    ...byName,
    /** @type {Record<string, Input>} */
    byName,
    /** Show the values in effect as placeholders of empty fields. @param {Record<OwnFigure, number | null>} usual */
    showUsual(usual) {
      for (const [figure, value] of /** @type {[OwnFigure, number | null][]} */ (Object.entries(usual)))
        byName[figure].placeholder = `${shownIn(value, UNITS[figure] ?? 1)}`;
    },
    /** @param {{ max_range_m?: number | null, cruise_speed_mps?: number } | undefined} type */
    showUsualFlight(type) {
      byName.max_range_m.placeholder = type?.max_range_m ? `${inUnits(type.max_range_m, LONG_UNIT.metres)}` : "";
      byName.cruise_speed_mps.placeholder = `${shownIn(type?.cruise_speed_mps, SPEED_UNIT.mps)}`;
    },
    /** @returns {TypedUav} */
    read: () => ({
      name: byName.name.value.trim(),
      base_name: byName.base_name.value,
      position: [longitude.valueAsNumber, latitude.valueAsNumber],
      max_range_m: kept(byName.max_range_m, uav.max_range_m, LONG_UNIT.metres),
      cruise_speed_mps: kept(byName.cruise_speed_mps, uav.cruise_speed_mps, SPEED_UNIT.mps),
      end_action: /** @type {EndActionEnum} */ (byName.end_action.value),
      battery_wh: kept(byName.battery_wh, uav.battery_wh, 1),
      mass_kg: kept(byName.mass_kg, uav.mass_kg, 1),
      reserve_percent: kept(byName.reserve_percent, uav.reserve_percent, 1),
      max_airspeed_mps: kept(byName.max_airspeed_mps, uav.max_airspeed_mps, SPEED_UNIT.mps),
    }),
  };
}

/** Fields of the maximum of targets and flights of a UAV in a mission. @param {DialogUav} uav */
export function createLimits(uav) {
  const input = { class: "input", type: "number", min: 1, step: 1 };
  const most = h("input", {
    ...input,
    max: MAX_TARGETS,
    placeholder: t("as many as fit"),
    value: uav.most_targets ?? "",
  });
  const sorties = h("input", { ...input, max: MAX_SORTIES, required: true, value: uav.sorties ?? 1 });
  return {
    element: h(
      "div",
      { class: "pair" },
      field(t("At most this many targets"), most),
      field(t("At most this many flights"), sorties),
    ),
    read: () => ({
      most_targets: Number.isFinite(most.valueAsNumber) ? most.valueAsNumber : null,
      sorties: sorties.valueAsNumber,
    }),
  };
}
