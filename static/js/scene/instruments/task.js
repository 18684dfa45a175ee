/** What a UAV does at a moment, by the waypoint that it flies to. Values in, values out. */

import { stepOf } from "../sources/pieces.js";

/** @import { FlightRoute, Moment } from "../types.d.ts" */

/**
 * What a UAV does; target: its place.
 *
 * @typedef {{ kind: "unknown" | "ground" | "take-off" | "at" | "to" | "home" | "landing", target: number | null }} Task
 */
/** @typedef {Pick<FlightRoute, "planned">} PlannedRoute */

const AT_M = 18; // so near a target it is at it
const LANDING_MPS = -0.4;
const CLIMBING_MPS = 0.4;

/**
 * The vertical manoeuvre before the first waypoint and after the last one: climb or descent.
 *
 * @param {PlannedRoute} route
 * @param {Moment} moment
 * @param {boolean} isDescending
 * @returns {Task}
 */
function untold({ planned }, { climb_mps }, isDescending) {
  const first = planned.find(({ target }) => target !== null && target !== undefined)?.target ?? null;
  if (typeof climb_mps === "number" && climb_mps > CLIMBING_MPS && first !== null)
    return { kind: "take-off", target: first };
  return { kind: isDescending ? "landing" : "unknown", target: null };
}

/**
 * @param {PlannedRoute} route
 * @param {Moment | null} moment
 * @returns {Task}
 */
export function taskOf(route, moment) {
  if (!moment) return { kind: "unknown", target: null };
  if (moment.isInAir === false || moment.isOver) return { kind: "ground", target: null };
  const isDescending = typeof moment.climb_mps === "number" && moment.climb_mps < LANDING_MPS;
  const { waypoint } = moment;
  if (waypoint === null || waypoint === undefined) return untold(route, moment, isDescending);
  const ahead = route.planned.filter(({ sequence }) => sequence >= waypoint);
  const here = ahead[0]?.target ?? null;
  if (here !== null && stepOf(moment.position, ahead[0].position).metres < AT_M) return { kind: "at", target: here };
  const next = ahead.find(({ target }) => target !== null && target !== undefined)?.target ?? null;
  const first = route.planned[0];
  if (waypoint === first?.sequence && next !== null && stepOf(moment.position, first.position).metres < AT_M)
    return { kind: "take-off", target: next };
  return next === null ? { kind: isDescending ? "landing" : "home", target: null } : { kind: "to", target: next };
}
