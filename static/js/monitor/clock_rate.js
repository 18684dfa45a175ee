/** How fast a UAV's own clock runs: a simulated one may fly faster than real time. Every time that a page shows is of the clock on the wall. */

import { t } from "../text.js";
import { numberText } from "../units.js";

/** @import { LiveLink } from "../api_types.d.ts" */

const ALIKE = 0.1; // error of a learnt clock rate

/**
 * Simulated seconds a second: a whole number if within 10 % of one, else with one decimal; 1 for a real UAV.
 *
 * @param {{ link?: Pick<LiveLink, "clock_rate"> | null, is_simulated: boolean }} uav
 */
export function rateOf({ link, is_simulated }) {
  const rate = is_simulated ? (link?.clock_rate ?? 1) : 1;
  const whole = Math.round(rate);
  return Math.abs(rate - whole) <= ALIKE * rate ? whole : Math.round(rate * 10) / 10;
}

/** @param {number} rate */
export const rateWords = (rate) =>
  t("Simulation at {rate}×; times on this page are real time.", {
    rate: numberText(rate, Number.isInteger(rate) ? 0 : 1),
  });
