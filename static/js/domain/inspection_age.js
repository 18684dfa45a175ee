/** How long ago something was inspected, in the steps that the map and the pages draw, and their colours. */

import { t } from "../text.js";

const DAY_S = 86_400;

/** Steps from the newest: `days` at most, how much of the accent is in the colour, and the words of the legend. */
export const AGES = [
  { key: "month", days: 30, accent: 1, words: t("Inspected in the last 30 days") },
  { key: "year", days: 365, accent: 0.55, words: t("Inspected in the last year") },
  { key: "older", days: Number.POSITIVE_INFINITY, accent: 0.28, words: t("Inspected earlier") },
];

/** The key of AGES. @param {number} inspected_s Unix s @param {number} [now_s] */
export function ageOf(inspected_s, now_s = Date.now() / 1000) {
  const days = (now_s - inspected_s) / DAY_S;
  return (AGES.find((age) => days <= age.days) ?? AGES[AGES.length - 1]).key;
}

/** The Unix seconds from which on something is in this step or a newer one. @param {number} days @param {number} [now_s] */
export const since_s = (days, now_s = Date.now() / 1000) => now_s - days * DAY_S;

/** A colour of CSS between the ground and the accent of the present theme. @param {number} accent 0 to 1 */
export const tintOf = (accent) => `color-mix(in srgb, var(--accent) ${accent * 100}%, var(--ground))`;

/** The same as #rrggbb, for the map. @param {number} share of the first @param {string} first #rrggbb @param {string} second #rrggbb */
export function mixed(share, first, second) {
  const parts = [1, 3, 5].map((start) => {
    const [one, other] = [first, second].map((hex) => Number.parseInt(hex.slice(start, start + 2), 16));
    return Math.round(share * one + (1 - share) * other)
      .toString(16)
      .padStart(2, "0");
  });
  return `#${parts.join("")}`;
}
