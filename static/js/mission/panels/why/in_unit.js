/** Metres of a route in the unit that a plan's objective counts: minutes, or watt-hours, at the route's own means. Values in, values out. */

import { durationText, energyText, lengthText } from "../../../units.js";

/** @import { ObjectiveEnum, Route } from "../../../api_types.d.ts" */

/** @typedef {Pick<Route, "length_m" | "duration_s"> & Partial<Pick<Route, "energy_wh">>} Means a route, or two together */

/** Seconds for additional metres at a route's mean speed. @param {Means} route @param {number} more_m */
export const timeFor_s = ({ length_m, duration_s }, more_m) => (length_m > 0 ? (more_m * duration_s) / length_m : 0);

/** Watt-hours for them; null where the route counts none. @param {Means} route @param {number} more_m */
export const energyFor_wh = ({ length_m, energy_wh }, more_m) =>
  energy_wh === null || energy_wh === undefined || length_m <= 0 ? null : (more_m * energy_wh) / length_m;

/**
 * "3 min", with the metres beside it; these alone where the objective is the distance.
 *
 * @param {Means} route
 * @param {number} more_m
 * @param {ObjectiveEnum} objective
 */
export function inUnit(route, more_m, objective) {
  const length = lengthText(more_m);
  const energy_wh = objective === "energy" ? energyFor_wh(route, more_m) : null;
  if (energy_wh !== null) return { text: energyText(energy_wh), beside: length };
  if (objective === "total" || objective === "energy") return { text: length, beside: "" };
  return { text: durationText(timeFor_s(route, more_m)), beside: length };
}
