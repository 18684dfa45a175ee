/** What is in the way when a UAV is told to return or abort: its autopilot flies home by itself, as high as its own parameters say. */

import { t } from "../text.js";
import { clockText, durationText, heightText, lengthText, percentText } from "../units.js";

/** @import { PresentReturn, ReturnCheck } from "../api_types.d.ts" */

/**
 * Of answers of the API; undefined while they are not there.
 *
 * @param {ReturnCheck[] | null | undefined} returns
 * @param {number} place of the UAV in the mission
 */
export const returnOf = (returns, place) => returns?.find((check) => check.place === place);

/**
 * Sentences for a question before Return or Abort: never none. What is in the way goes first, then the battery, then whence that was
 * looked at.
 *
 * @param {PresentReturn | null | undefined} check
 * @returns {string[]}
 */
export function returnLines(check) {
  if (!check) return [t("Its way home has not been checked: it flies straight, at a height of its own.")];
  const { warnings, state, fence_warning } = check;
  return [
    ...warnings,
    state === "clear" && !check.met.length ? clearText(check) : "",
    landingText(check.battery),
    basisText(check.present),
    fence_warning,
  ].filter(Boolean);
}

/** @param {PresentReturn["battery"]} battery */
function landingText({ landing_percent, reserve_percent, unknown }) {
  if (landing_percent === null || reserve_percent === null)
    return unknown && t("Battery at landing not known: {why}", { why: unknown });
  if (landing_percent < reserve_percent) return ""; // a warning says it
  return t("Lands with about {landing} of its battery (reserve {reserve}).", {
    landing: percentText(Math.round(landing_percent)),
    reserve: percentText(reserve_percent),
  });
}

/** Whence the way home was looked at. @param {PresentReturn["present"]} present */
function basisText(present) {
  if (!present) return "";
  const age = durationOfReport(present.age_s);
  return present.is_measured
    ? t("Checked from where it was measured {age} ago.", { age })
    : t("Checked from where it is estimated, ± {distance}; last report {age} ago.", {
        distance: lengthText(present.uncertainty_m),
        age,
      });
}

/** @param {number} age_s */
const durationOfReport = (age_s) => (age_s < 100 ? `${Math.round(age_s)}\u00a0s` : durationText(age_s));

/**
 * The same of several UAVs: each sentence once, after the names of those of which it is true.
 *
 * @param {{ name: string, check: PresentReturn | null | undefined }[]} uavs
 */
export function returnLinesOfAll(uavs) {
  /** @type {Map<string, string[]>} */
  const said = new Map();
  for (const { name, check } of uavs)
    for (const line of returnLines(check)) said.set(line, [...(said.get(line) ?? []), name]);
  return [...said].map(([line, names]) => `${names.join(", ")}: ${line}`);
}

/**
 * What is said of several that return at once, before what is said of each; "" of one alone.
 *
 * @param {(PresentReturn | null | undefined)[]} checks
 */
export function togetherLine(checks) {
  if (checks.length < 2) return "";
  const isKnown = checks.every((check) => check?.present);
  return isKnown && checks.every((check) => !check?.met.length)
    ? t("All return at once: their ways home keep apart.")
    : t("All return at once: nothing keeps them apart on the way home.");
}

/**
 * Under its name on the panel: { words, image, level }; null while nothing is known.
 *
 * @param {ReturnCheck | null | undefined} check
 */
export function returnSaid(check) {
  if (!check) return null;
  const { state, warnings, fence_warning } = check;
  const isGood = state === "clear" && !fence_warning;
  const isWarning = state === "in_the_way" || Boolean(fence_warning);
  return {
    words: [...(state === "clear" ? [clearText(check)] : warnings), fence_warning].filter(Boolean).join(" "),
    image: isGood ? "rotate-ccw" : isWarning ? "triangle-alert" : "info",
    level: isWarning ? "warning" : null,
  };
}

/** @param {Pick<ReturnCheck, "height_m" | "read_at">} check */
function clearText({ height_m, read_at }) {
  const values = { height: heightText(height_m ?? 0), time: read_at ? clockText(read_at) : "—" };
  return t("Return and Abort: nothing in the way home, {height} above its take-off (read {time}).", values);
}
