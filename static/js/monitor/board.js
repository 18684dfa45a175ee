/** The board: every target of the missions on the page with its state and time. Values in, values out. */

import { inAir } from "../domain/in_air.js";
import { routeLetter, routeNumber } from "../domain/palette.js";
import { t } from "../text.js";
import { prefixOf } from "./call_signs.js";
import { isHeld } from "./text/uav_text.js";

/** @import { LiveMission, LiveTarget, LiveUav, Mission, TargetState } from "../api_types.d.ts" */

/** @import { MissionNumbers } from "./call_signs.js" */

/**
 * A target on the board.
 *
 * @typedef {object} BoardRow
 * @property {string} key
 * @property {string} mission
 * @property {number} place in the mission's list
 * @property {number | null} colour of the UAV that flies to it
 * @property {string} pill
 * @property {string} label
 * @property {BoardState} state
 * @property {string | null} at when it is expected or was reached
 * @property {boolean} isExpected
 * @property {string} reason
 */
/** @typedef {TargetState | "held" | "next"} BoardState `held`, `next`: its UAV holds on the way to it, is on the way */

/** @type {Record<BoardState, { words: string, image: string, rank: number }>} */
export const STATES = {
  held: { words: t("Held"), image: "circle-pause", rank: 0 },
  next: { words: t("Next"), image: "navigation", rank: 1 },
  "in-progress": { words: t("In progress"), image: "circle-dot", rank: 1 },
  pending: { words: t("Pending"), image: "circle-dashed", rank: 2 },
  failed: { words: t("Failed"), image: "circle-x", rank: 3 },
  skipped: { words: t("Skipped"), image: "skip-forward", rank: 4 },
  complete: { words: t("Complete"), image: "circle-check", rank: 5 },
};

/** @type {Record<string, string>} */
const REASONS = {
  "flight-failed": t("Its flight failed."),
  "not-reached": t("The UAV went past it at a distance."),
  "not-held": t("The UAV did not stay long enough."),
};

/**
 * Why a target was skipped or failed: the text of a known code, any other as it is.
 *
 * @param {string | null | undefined} reason
 */
export const reasonWords = (reason) => REASONS[reason ?? ""] ?? reason ?? "";

/**
 * Number of each target on its route, by its place in the mission; from the mission as the REST API shows it.
 *
 * @param {Mission | undefined} detail
 */
export function numbersOf(detail) {
  /** @type {Map<number, number>} */
  const numbers = new Map();
  for (const route of detail?.plan?.routes ?? [])
    for (const [index, target] of route.targets.entries()) numbers.set(target, index + 1);
  return numbers;
}

/**
 * "C3", or the bare number of a target without a route.
 *
 * @param {Pick<LiveTarget, "place" | "uav">} target
 * @param {Map<number, number>} numbers
 * @param {string} [prefix] of its mission's letters
 */
export const pillOf = (target, numbers, prefix = "") =>
  target.uav === null ? `${target.place + 1}` : `${prefix}${routeLetter(target.uav)}${numbers.get(target.place) ?? ""}`;

/**
 * Rows: [{ key, mission, place, colour, pill, label, state, at, isExpected, reason }], targets in progress first, finished ones last.
 *
 * @param {LiveMission[]} missions
 * @param {LiveUav[]} uavs
 * @param {Map<string, Mission>} details
 * @param {MissionNumbers} [order] on a page of several missions, whose targets stand together
 * @returns {BoardRow[]}
 */
export function boardRows(missions, uavs, details, order = new Map()) {
  const rows = missions.flatMap((mission) => {
    const numbers = numbersOf(details.get(mission.id));
    const flying = new Map(uavs.filter((uav) => uav.mission === mission.id).map((uav) => [uav.place, uav]));
    return mission.targets.map((target) =>
      rowOf(mission, target, numbers, flying.get(target.uav ?? -1), prefixOf(mission.id, order)),
    );
  });
  return rows.sort(
    (a, b) =>
      (order.get(a.mission) ?? 0) - (order.get(b.mission) ?? 0) ||
      STATES[a.state].rank - STATES[b.state].rank ||
      later(a, b) ||
      a.pill.localeCompare(b.pill, undefined, { numeric: true }),
  );
}

/** Open targets by time, then finished ones, newest first. @param {BoardRow} a @param {BoardRow} b */
function later(a, b) {
  const [one, other] = [a, b].map(({ at }) => (at ? Date.parse(at) : Infinity));
  if (one === other) return 0;
  return a.isExpected || a.at === null || b.at === null ? one - other : other - one;
}

/**
 * @param {LiveMission} mission
 * @param {LiveTarget} target
 * @param {Map<number, number>} numbers
 * @param {LiveUav | undefined} uav
 * @param {string} prefix
 * @returns {BoardRow}
 */
function rowOf(mission, target, numbers, uav, prefix) {
  const arrivals = uav?.estimated?.arrivals ?? [];
  const arrival = arrivals.find((entry) => entry.target === target.place);
  const isToCome = target.state === "pending" || target.state === "in-progress";
  const isNext = arrivals.find((entry) => entry.target !== null)?.target === target.place;
  /** @type {BoardState} */
  const state =
    isToCome && isNext && uav && isHeld(uav)
      ? "held"
      : target.state === "pending" && isNext && uav && inAir(uav)
        ? "next"
        : target.state;
  return {
    key: `${mission.id} ${target.place}`,
    mission: mission.id,
    place: target.place,
    colour: target.uav === null ? null : routeNumber(target.uav, mission.colours),
    pill: pillOf(target, numbers, prefix),
    label: target.label,
    state,
    at: isToCome ? (state === "held" ? null : (arrival?.at ?? null)) : target.state_at,
    isExpected: isToCome,
    reason: reasonWords(target.state_reason),
  };
}
