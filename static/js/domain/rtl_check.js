/** What obstructs a UAV on Return or Abort: its autopilot flies home by itself, at the height of its own parameters. */

import { t, tn } from "../text.js";
import { clockText, durationText, heightText, lengthText, percentText } from "../units.js";

/** @import { Safer } from "./command_questions.js" */
/** @import { LandingHere, PresentReturn, ReturnCheck, SafeReturn } from "../api_types.d.ts" */

export const MIN_HOLD_S = 30; // a shorter hold is none

/**
 * A UAV's return from the API's answer; undefined before it has arrived.
 *
 * @param {ReturnCheck[] | null | undefined} returns
 * @param {number} place of the UAV in the mission
 */
export const returnOf = (returns, place) => returns?.find((check) => check.place === place);

/**
 * Sentences for a question before Return or Abort; at least one. Obstructions first, then the battery, then the position from which the
 * path was checked.
 *
 * @param {PresentReturn | null | undefined} check
 * @returns {string[]}
 */
export function returnLines(check) {
  if (!check) return [t("Return path not checked: it flies straight, at its own return altitude.")];
  const { warnings, state, fence_warning } = check;
  return [
    ...warnings,
    state === "clear" && !check.met.length ? clearText(check) : "",
    landingText(check.battery),
    check.safest?.along_route && check.along ? alongText(check.along) : "",
    basisText(check.present),
    fence_warning,
  ].filter(Boolean);
}

/** @param {NonNullable<PresentReturn["along"]>} along */
function alongText({ waypoint, length_m, duration_s, targets, landing_percent }) {
  const values = { number: waypoint + 1, distance: lengthText(length_m), time: durationText(duration_s) };
  return [
    t("Along the route: straight to waypoint {number}, then as approved, {distance}, {time}.", values),
    targets ? tn(targets, "{count} target is still visited.", "{count} targets are still visited.") : "",
    landing_percent === null
      ? t("Battery at landing not known.")
      : t("Lands with about {landing} of its battery.", {
          landing: percentText(Math.max(Math.round(landing_percent), 0)),
        }),
  ]
    .filter(Boolean)
    .join(" ");
}

/** @param {PresentReturn["battery"]} battery */
function landingText({ landing_percent, reserve_percent, unknown }) {
  if (landing_percent === null || reserve_percent === null)
    return unknown && t("Battery at landing not known: {why}", { why: unknown });
  if (landing_percent < reserve_percent) return ""; // a warning covers it
  return t("Lands with about {landing} of its battery (reserve {reserve}).", {
    landing: percentText(Math.round(landing_percent)),
    reserve: percentText(reserve_percent),
  });
}

/**
 * Sentences for a question before a landing where the UAV is; at least one.
 *
 * @param {LandingHere | null | undefined} landing
 * @returns {string[]}
 */
export function landingLines(landing) {
  if (!landing) return [t("Landing place not checked.")];
  return [...landing.warnings, landing.facts.join(" "), basisText(landing.present)].filter(Boolean);
}

/**
 * The line on how long it can hold and still land with its reserve.
 *
 * @param {number | null | undefined} hold_s
 */
export function holdLine(hold_s) {
  if (typeof hold_s !== "number") return t("Hold time unknown.");
  if (hold_s < MIN_HOLD_S) return t("It cannot hold: its battery is needed for the return and the reserve.");
  return t("It can hold for about {time}, with battery left for the return and the reserve.", {
    time: durationText(hold_s),
  });
}

/**
 * The same of several: of the one that can hold the shortest, and of those of which it is not known.
 *
 * @param {{ name: string, hold_s: number | null | undefined }[]} uavs
 * @returns {string[]}
 */
export function holdLinesOfAll(uavs) {
  const known = uavs.flatMap(({ name, hold_s }) => (typeof hold_s === "number" ? [{ name, hold_s }] : []));
  const [first] = known.sort((a, b) => a.hold_s - b.hold_s);
  const unknown = uavs.filter(({ hold_s }) => typeof hold_s !== "number").map(({ name }) => name);
  return [
    first && `${first.name}: ${holdLine(first.hold_s)}`,
    unknown.length && t("Hold time unknown: {names}.", { names: unknown.join(", ") }),
  ].filter((line) => typeof line === "string");
}

/** The position from which the path was checked. @param {PresentReturn["present"]} present */
function basisText(present) {
  if (!present) return "";
  const age = holdText(present.age_s);
  return present.is_measured
    ? t("Checked from where it was measured {age} ago.", { age })
    : t("Checked from where it is estimated, ± {distance}; last report {age} ago.", {
        distance: lengthText(present.uncertainty_m),
        age,
      });
}

/**
 * The same of several UAVs: each sentence once, after the names of those of which it is true.
 *
 * @param {{ name: string, check: PresentReturn | null | undefined }[]} uavs
 */
export function returnLinesOfAll(uavs) {
  /** @type {Map<string, string[]>} */
  const sentences = new Map();
  const known = uavs.flatMap(({ check }) => check ?? []);
  const { lines, checks } = unreportedOnce(known);
  const shown = new Map(known.map((check, place) => [check, checks[place]]));
  for (const { name, check } of uavs)
    for (const line of returnLines(check && shown.get(check)))
      sentences.set(line, [...(sentences.get(line) ?? []), name]);
  return [...lines, ...[...sentences].map(([line, names]) => `${names.join(", ")}: ${line}`)];
}

/**
 * A return with fewer obstructions than a straight one at once: along the route, at another height, or after a hold; null where there is
 * no better one.
 *
 * @param {PresentReturn} check
 * @returns {Safer | null}
 */
export function saferReturn({ safest }) {
  if (!safest) return null;
  const parameters = wayOf(safest);
  return Object.keys(parameters).length ? { words: wayWords(safest), kind: "return", parameters } : null;
}

/** Parameters of a return. @param {SafeReturn} way */
const wayOf = ({ height_m, wait_s, along_route }) =>
  along_route ? { along_route } : { ...(height_m !== null && { height_m }), ...(wait_s > 0 && { wait_s }) };

/** @param {SafeReturn} way */
function wayWords({ height_m, wait_s, along_route }) {
  if (along_route) return t("Return along the route");
  if (height_m === null) return t("Hold {time}, then return", { time: holdText(wait_s) });
  const height = heightText(height_m);
  return wait_s > 0
    ? t("Hold {time}, then return at {height}", { time: holdText(wait_s), height })
    : t("Return at {height}", { height });
}

/**
 * How several UAVs return without conflicts and obstructions; null where all may as well return straight at once. `lines` state it, and
 * name the UAVs without a clear path.
 *
 * @param {PresentReturn[]} checks
 * @returns {{ ways: Map<number, Record<string, any>>, lines: string[] } | null}
 */
export function separateReturns(checks) {
  const better = checks.flatMap((check) => {
    const safer = saferReturn(check);
    return safer ? [{ uav: check.uav ?? 0, name: check.name, safer }] : [];
  });
  if (!better.length) return null;
  const lost = checks.filter(({ safest, is_clear }) => !safest && !is_clear).map(({ name }) => name);
  return {
    ways: new Map(better.map(({ uav, safer }) => [uav, safer.parameters])),
    lines: [
      t("On separate ways they keep apart: {ways}.", {
        ways: better.map(({ name, safer }) => `${name}: ${safer.words}`).join("; "),
      }),
      lost.length ? t("{names}: no return path is clear. They return straight.", { names: lost.join(", ") }) : "",
    ].filter(Boolean),
  };
}

/** @param {number} seconds */
const holdText = (seconds) => (seconds < 100 ? `${Math.round(seconds)}\u00a0s` : durationText(seconds));

/**
 * The sentence on several UAVs that return at once, shown before those on each; "" for a single UAV.
 *
 * @param {(PresentReturn | null | undefined)[]} checks
 */
export function togetherLine(checks) {
  if (checks.length < 2) return "";
  const isKnown = checks.every((check) => check?.present);
  return isKnown && checks.every((check) => !check?.met.length)
    ? t("All return at once: their return paths are separated.")
    : t("All return at once: their return paths are not separated.");
}

/** The tooltip of a value that the autopilot has not reported. @param {string} names of parameters */
export const parametersText = (names) => t("Autopilot parameter: {names}", { names });

/**
 * That no return altitude is known, once for all UAVs of which that is so where they are several; and the checks without that warning.
 *
 * @template {Pick<ReturnCheck, "name" | "state" | "height_m" | "detail" | "warnings">} Check
 * @param {Check[]} checks
 * @returns {{ lines: string[], checks: Check[] }}
 */
function unreportedOnce(checks) {
  const unreported = checks.filter(({ state, height_m, detail }) => state === "unknown" && height_m === null && detail);
  if (unreported.length < 2) return { lines: [], checks };
  const line = t(
    "Return altitude not reported by {count} UAVs: {names}. Their return paths are not checked against terrain and zones.",
    { count: unreported.length, names: unreported.map(({ name }) => name).join(", ") },
  );
  return {
    lines: [line],
    checks: checks.map((check) => (unreported.includes(check) ? { ...check, warnings: [] } : check)),
  };
}

/** Warnings of a mission's UAVs, each sentence once. @param {ReturnCheck[]} all */
export function warningsOfAll(all) {
  const { lines, checks } = unreportedOnce(all);
  const sentences = checks.flatMap(({ warnings, fence_warning }) => [...warnings, fence_warning]);
  return [...new Set([...lines, ...sentences].filter(Boolean))];
}

/**
 * Status under its name on the panel: { words, image, level, title }; null while it is unknown.
 *
 * @param {ReturnCheck | null | undefined} check
 */
export function returnStatus(check) {
  if (!check) return null;
  const { state, warnings, fence_warning, detail } = check;
  const isGood = state === "clear" && !fence_warning;
  const isWarning = state === "in_the_way" || Boolean(fence_warning);
  return {
    words: [...(state === "clear" ? [clearText(check)] : warnings), fence_warning].filter(Boolean).join(" "),
    image: isGood ? "rotate-ccw" : isWarning ? "triangle-alert" : "info",
    level: isWarning ? "warning" : null,
    title: detail ? parametersText(detail) : null,
  };
}

/** @param {Pick<ReturnCheck, "height_m" | "read_at">} check */
function clearText({ height_m, read_at }) {
  const values = { height: heightText(height_m ?? 0), time: read_at ? clockText(read_at) : "—" };
  return t("Return path clear, {height} above take-off (read {time}).", values);
}
