/** What is in the way when a UAV is told to return or abort: its autopilot flies home by itself, as high as its own parameters say. */

import { t } from "../text.js";
import { clockText, heightText } from "../units.js";

/** @import { ReturnCheck } from "../api_types.d.ts" */

/**
 * Of answers of the API; undefined while they are not there.
 *
 * @param {ReturnCheck[] | null | undefined} returns
 * @param {number} place of the UAV in the mission
 */
export const returnOf = (returns, place) => returns?.find((check) => check.place === place);

/** Sentences for a question before Return or Abort: never none. @param {ReturnCheck | null | undefined} check */
export function returnLines(check) {
  if (!check) return [t("Its way home has not been checked: it flies straight, at a height of its own.")];
  return check.state === "clear" ? [clearText(check)] : check.warnings;
}

/**
 * The same of several UAVs: each sentence once, after the names of those of which it is true.
 *
 * @param {{ name: string, check: ReturnCheck | null | undefined }[]} uavs
 */
export function returnLinesOfAll(uavs) {
  /** @type {Map<string, string[]>} */
  const said = new Map();
  for (const { name, check } of uavs)
    for (const line of [...returnLines(check), check?.fence_warning ?? ""].filter(Boolean))
      said.set(line, [...(said.get(line) ?? []), name]);
  return [...said].map(([line, names]) => `${names.join(", ")}: ${line}`);
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

/** @param {ReturnCheck} check */
function clearText({ height_m, read_at }) {
  const values = { height: heightText(height_m ?? 0), time: read_at ? clockText(read_at) : "—" };
  return t("Return and Abort: nothing in the way home, {height} above its take-off (read {time}).", values);
}
