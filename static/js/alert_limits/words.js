/** Limits of alerts with units: the name of each limit, and their groups. Values in, values out. */

import { t } from "../text.js";
import { SHORT_UNIT, SPEED_UNIT } from "../units.js";

const METRES = { unit: SHORT_UNIT.unit, factor: SHORT_UNIT.metres };
const SPEED = { unit: SPEED_UNIT.unit, factor: SPEED_UNIT.mps };
const SECONDS = { unit: "s", factor: 1 };
const PERCENT = { unit: "%", factor: 1 };
const BARE = { unit: "", factor: 1 };

/** @typedef {{ name: string, label: string, unit: string, factor: number }} Limit `factor`: stored units in one of the shown unit */
/** @typedef {Record<string, number>} Figures by a limit's name */

/** @type {{ title: string, limits: Limit[] }[]} names as the API has them */
export const GROUPS = [
  {
    title: t("Link"),
    limits: [
      { name: "link_late_s", label: t("Late after"), ...SECONDS },
      { name: "link_lost_s", label: t("Lost after"), ...SECONDS },
    ],
  },
  {
    title: t("Beside its route"),
    limits: [
      { name: "off_route_m", label: t("Warning from"), ...METRES },
      { name: "off_route_critical_m", label: t("Critical from"), ...METRES },
    ],
  },
  {
    title: t("Above or below its route"),
    limits: [
      { name: "height_off_m", label: t("Warning from"), ...METRES },
      { name: "height_off_critical_m", label: t("Critical from"), ...METRES },
    ],
  },
  {
    title: t("Battery at the end of the flight"),
    limits: [
      { name: "battery_margin_percent", label: t("Warning below the reserve by"), ...PERCENT },
      { name: "battery_critical_percent", label: t("Critical below"), ...PERCENT },
    ],
  },
  {
    title: t("Zones and other UAVs"),
    limits: [
      { name: "zone_ahead_s", label: t("Zones ahead within"), ...SECONDS },
      { name: "converging_s", label: t("Meetings ahead within"), ...SECONDS },
      { name: "separation_m", label: t("Apart, aside"), ...METRES },
      { name: "separation_height_m", label: t("Apart, in height"), ...METRES },
    ],
  },
  {
    title: t("Wind"),
    limits: [
      { name: "wind_share_percent", label: t("Of its highest airspeed"), ...PERCENT },
      { name: "wind_mps", label: t("In any case from (0: never)"), ...SPEED },
    ],
  },
  {
    title: t("Position and progress"),
    limits: [
      { name: "least_satellites", label: t("Satellites, at least"), ...BARE },
      { name: "most_hdop", label: t("HDOP, at most"), ...BARE },
      { name: "jump_mps", label: t("A jump is faster than"), ...SPEED },
      { name: "no_progress_s", label: t("Stands still for"), ...SECONDS },
    ],
  },
];

const ORDERED = [
  ["link_late_s", "link_lost_s"],
  ["off_route_m", "off_route_critical_m"],
  ["height_off_m", "height_off_critical_m"],
];

/**
 * Pairs of limits in the wrong order: [[name of the upper, name of the lower]]. Unset limits have the usual values.
 *
 * @param {Figures} stated
 * @param {Figures} usual
 */
export function wrongWayRound(stated, usual) {
  /** @param {string} name */
  const inForce = (name) => stated[name] ?? usual[name];
  return ORDERED.filter(([lower, upper]) => inForce(lower) > inForce(upper)).map(([lower, upper]) => [upper, lower]);
}

/**
 * Bounds in a shown unit, to a tenth inwards: { min, max }.
 *
 * @param {readonly number[]} bounds
 * @param {number} factor
 */
export const boundsIn = ([least, most], factor) =>
  factor === 1
    ? { min: least, max: most }
    : { min: Math.ceil((least / factor) * 10) / 10, max: Math.floor((most / factor) * 10) / 10 };

/** The set limits as short texts: [[label, figure]]. @param {Figures} stated */
export const statedLines = (stated) =>
  GROUPS.flatMap(({ title, limits }) =>
    limits
      .filter(({ name }) => name in stated)
      .map(({ name, label, unit, factor }) => [
        `${title}: ${label}`,
        `${Number((stated[name] / factor).toFixed(1))}${unit && `\u00a0${unit}`}`,
      ]),
  );
