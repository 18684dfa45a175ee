/** How soon how many UAVs would be done: who could fly, and who flies in the next smaller plan. Values in, values out. */

import { distance_m } from "../../domain/geodesy.js";
import { longestDuration_s } from "../plan/plan_view.js";
import { staysOf } from "../plan/route_times.js";
import { basisOf, wishesOf } from "../selection.js";
import { canFly } from "./fleet.js";
import { withUav } from "./mission_uavs.js";

/** @import { FleetUav, MissionSelection, PickedUav, PlanResult, UavNumber } from "../types.d.ts" */

export const MAX_UAVS = 8; // each number is a plan of its own
const NO_UAVS = { uavs: [] };

/** Plans of these selections differ in their UAVs alone: equal keys. @param {MissionSelection} selection */
export const keyOfNumbers = (selection) => basisOf({ ...selection, ...NO_UAVS, objective: "makespan" });

/** Whether numbers of UAVs can be compared: a lock names the UAV that flies it. @param {MissionSelection} selection @param {FleetUav[]} fleet */
export const canCompareNumbers = (selection, fleet) =>
  selection.targets.length > 0 && !selection.locks.length && withCandidates(selection, fleet).uavs.length > 1;

/**
 * The selection to be done soonest by the UAVs of the mission and, up to MAX_UAVS, those of the fleet nearest to the targets.
 *
 * @param {MissionSelection} selection
 * @param {FleetUav[]} fleet
 * @returns {MissionSelection}
 */
export function withCandidates(selection, fleet) {
  const places = selection.targets.flatMap(({ centre }) => (centre ? [centre] : []));
  /** @param {FleetUav} uav */
  const away_m = ({ position }) => Math.min(...places.map((place) => distance_m(position, place)));
  const chosen = new Set(selection.uavs.map(({ id }) => id));
  const free = fleet
    .filter((uav) => canFly(uav) && !chosen.has(uav.id))
    .map((uav) => ({ uav, away_m: away_m(uav) }))
    .sort((a, b) => a.away_m - b.away_m)
    .slice(0, Math.max(0, MAX_UAVS - selection.uavs.length))
    .map(({ uav }) => uav);
  return { ...free.reduce(withUav, selection), objective: "makespan" };
}

/** Places of the UAVs that the plan uses. @param {PlanResult} result */
const usedIn = ({ routes }) => routes.flatMap(({ length_m }, sequence) => (length_m > 0 ? [sequence] : []));

/**
 * The figures of a plan, or null where it leaves UAVs on the ground: then it is the plan of fewer.
 *
 * @param {MissionSelection} selection
 * @param {PlanResult} result
 * @returns {UavNumber | null}
 */
export function numberOf(selection, result) {
  if (usedIn(result).length < selection.uavs.length) return null;
  const stays = result.routes.flatMap(staysOf).filter(({ kind }) => kind === "base");
  return {
    uavs: selection.uavs,
    done_s: longestDuration_s(result),
    length_m: result.total_length_m,
    flights: selection.uavs.length + stays.length,
    missed: result.unassigned.length,
  };
}

/**
 * The selection with the UAVs that this plan uses or, where it uses all, without the one that is back first; null where none may go.
 * UAVs that a target is tied to stay.
 *
 * @param {MissionSelection} selection
 * @param {PlanResult} result
 * @returns {MissionSelection | null}
 */
export function withFewer(selection, result) {
  const tied = new Set(selection.targets.map((target) => wishesOf(target).uav));
  /** @param {PickedUav[]} uavs */
  const only = (uavs) => (uavs.length && uavs.length < selection.uavs.length ? { ...selection, uavs } : null);
  const used = new Set(usedIn(result));
  if (used.size < selection.uavs.length)
    return only(selection.uavs.filter((uav, sequence) => used.has(sequence) || tied.has(uav.name)));
  const [first] = result.routes
    .map(({ duration_s }, sequence) => ({ duration_s, sequence }))
    .filter(({ sequence }) => !tied.has(selection.uavs[sequence].name))
    .sort((a, b) => a.duration_s - b.duration_s);
  return first ? only(selection.uavs.filter((_, sequence) => sequence !== first.sequence)) : null;
}
