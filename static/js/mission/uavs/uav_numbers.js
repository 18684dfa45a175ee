/** How soon how many UAVs would be done: who could fly, and who flies in the next smaller plan. Values in, values out. */

import { distance_m } from "../../domain/geodesy.js";
import { longestDuration_s } from "../plan/plan_view.js";
import { staysOf } from "../plan/route_times.js";
import { basisOf, wishesOf } from "../selection.js";
import { canFly } from "./fleet.js";
import { withUav } from "./mission_uavs.js";

/** @import { FleetUav, MissionSelection, PickedUav, PlanResult, UavNumber } from "../types.d.ts" */

export const MAX_UAVS = 8; // each number is a plan of its own

/** @param {PickedUav} uav */
const idOf = ({ id, name }) => id ?? name;

/**
 * Plans of these candidates are those of the selection: equal keys. Who of them flies does not count, how they fly does.
 *
 * @param {MissionSelection} selection
 * @param {PickedUav[]} candidates
 */
export function keyOfNumbers(selection, candidates) {
  const uavs = candidates.map((uav) => selection.uavs.find((chosen) => idOf(chosen) === idOf(uav)) ?? uav);
  return basisOf({ ...selection, uavs, objective: "makespan" });
}

/**
 * UAVs of the fleet that could fly as well: simulated ones only beside simulated ones, as a mission with them inspects nothing.
 *
 * @param {MissionSelection} selection
 * @param {FleetUav[]} fleet
 */
function freeUavs({ uavs }, fleet) {
  const chosen = new Set(uavs.map(({ id }) => id));
  const known = fleet.filter(({ id }) => chosen.has(id));
  const others = known.length ? known : fleet.filter(canFly);
  const isSimulated = others.length > 0 && others.every((uav) => uav.is_simulated);
  return fleet.filter((uav) => canFly(uav) && !chosen.has(uav.id) && Boolean(uav.is_simulated) === isSimulated);
}

/** Whether numbers of UAVs can be compared: a lock names the UAV that flies it. @param {MissionSelection} selection @param {FleetUav[]} fleet */
export const canCompareNumbers = (selection, fleet) =>
  selection.targets.length > 0 &&
  !selection.locks.length &&
  selection.uavs.length + freeUavs(selection, fleet).length > 1;

/**
 * The selection to be done soonest by the UAVs of the mission and, up to MAX_UAVS, those of the fleet nearest to the targets.
 *
 * @param {MissionSelection} selection
 * @param {FleetUav[]} fleet
 * @returns {MissionSelection}
 */
export function withCandidates(selection, fleet) {
  const places = selection.targets.flatMap(({ centre }) => (centre ? [centre] : []));
  const nearest = freeUavs(selection, fleet)
    .map((uav) => ({ uav, away_m: Math.min(...places.map((place) => distance_m(uav.position, place))) }))
    .sort((a, b) => a.away_m - b.away_m)
    .slice(0, Math.max(0, MAX_UAVS - selection.uavs.length))
    .map(({ uav }) => uav);
  return { ...nearest.reduce(withUav, selection), objective: "makespan" };
}

/**
 * Places of the UAVs that the plan uses, and of those that a target is tied to.
 *
 * @param {MissionSelection} selection
 * @param {PlanResult} result
 */
function usedIn({ uavs, targets }, { routes }) {
  const tied = new Set(targets.map((target) => wishesOf(target).uav));
  return new Set(routes.flatMap(({ length_m }, place) => (length_m > 0 || tied.has(uavs[place].name) ? [place] : [])));
}

/**
 * The figures of a plan, or null where it leaves UAVs on the ground: then it is the plan of fewer.
 *
 * @param {MissionSelection} selection
 * @param {PlanResult} result
 * @returns {UavNumber | null}
 */
export function numberOf(selection, result) {
  if (usedIn(selection, result).size < selection.uavs.length) return null;
  const stays = result.routes.flatMap(staysOf).filter(({ kind }) => kind === "base");
  return {
    uavs: selection.uavs,
    done_s: longestDuration_s(result),
    length_m: result.total_length_m,
    flights: result.routes.filter(({ length_m }) => length_m > 0).length + stays.length,
    missed: result.unassigned.length,
  };
}

/** The row that is done first of those that reach most targets. @param {UavNumber[]} rows @returns {UavNumber | undefined} */
export const bestOf = (rows) => [...rows].sort((a, b) => a.missed - b.missed || a.done_s - b.done_s)[0];

/**
 * The seconds by which the targets of a route are farther from the next UAV than from its own, straight from where each takes off.
 *
 * @param {MissionSelection} selection
 * @param {PlanResult} result
 * @param {number} place of the route
 */
function detourWithout_s({ uavs, targets }, { routes }, place) {
  const places = new Set(routes[place].waypoints.flatMap(({ target }) => target ?? []));
  return [...places].reduce((seconds, target) => {
    const { centre } = targets[target];
    const away_s = uavs.map(({ position, cruise_speed_mps }) =>
      centre ? distance_m(position, centre) / (cruise_speed_mps ?? 1) : 0,
    );
    return seconds + Math.min(...away_s.filter((_, other) => other !== place)) - away_s[place];
  }, 0);
}

/**
 * The selection with the UAVs that this plan uses or, where it uses all, without those whose targets are nearest to others: one, or so many
 * that MAX_UAVS are left. UAVs that a target is tied to stay; null where none may go.
 *
 * @param {MissionSelection} selection
 * @param {PlanResult} result
 * @returns {MissionSelection | null}
 */
export function withFewer(selection, result) {
  const { uavs, targets } = selection;
  const used = usedIn(selection, result);
  const tied = new Set(targets.map((target) => wishesOf(target).uav));
  const isFull = used.size === uavs.length;
  const leavable = uavs
    .map(({ name }, place) => ({ name, place, detour_s: detourWithout_s(selection, result, place) }))
    .filter(({ name }) => !tied.has(name))
    .sort((a, b) => a.detour_s - b.detour_s)
    .slice(0, Math.max(1, uavs.length - MAX_UAVS))
    .map(({ place }) => place);
  const kept = uavs.filter((_, place) => (isFull ? !leavable.includes(place) : used.has(place)));
  return kept.length && kept.length < uavs.length ? { ...selection, uavs: kept } : null;
}
