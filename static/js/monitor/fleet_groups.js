/** The fleet of the live page by missions, filtered. Values in, values out. */

import { isSilent } from "../domain/certainty.js";
import { inAir } from "../domain/in_air.js";
import { alarmOf, inOrder } from "../domain/order.js";
import { letterOf } from "./call_signs.js";

/** @import { Alert, LiveMission, LiveUav } from "../api_types.d.ts" */
/** @import { MissionNumbers } from "./call_signs.js" */

/** @typedef {"all" | "flying" | "alerts" | "silent"} FleetKind */
/** @typedef {{ text: string, kind: FleetKind }} FleetFilter */
/** @typedef {{ id: string, mission: LiveMission | null, uavs: number, flying: number }} GroupHead of the list; null: of UAVs that fly no mission */
/**
 * @typedef {object} Fleet
 * @property {LiveUav[]} uavs
 * @property {LiveMission[]} missions
 * @property {Alert[]} alerts
 * @property {MissionNumbers} numbers
 * @property {number} now_ms
 */

/** @type {FleetFilter} */
export const EVERYTHING = { text: "", kind: "all" };

/** @param {LiveUav} uav @param {FleetFilter} filter @param {Fleet} fleet */
function passes(uav, { text, kind }, { missions, alerts, numbers, now_ms }) {
  if (kind === "flying" && inAir(uav) !== true) return false;
  if (kind === "alerts" && alarmOf(uav.id, alerts) === null) return false;
  if (kind === "silent" && (inAir(uav) === false || !isSilent(uav, now_ms))) return false;
  const wanted = text.trim().toLocaleLowerCase();
  if (!wanted) return true;
  const mission = missions.find(({ id }) => id === uav.mission)?.name ?? "";
  const sign = letterOf(uav, numbers).toLocaleLowerCase();
  return sign === wanted || `${uav.name}\n${mission}`.toLocaleLowerCase().includes(wanted);
}

/**
 * Heads and UAVs in the order of the list: missions by their numbers, UAVs by their places, then those that fly no mission by name.
 *
 * @param {Fleet} fleet
 * @param {FleetFilter} filter
 * @returns {(GroupHead | LiveUav)[]}
 */
export function grouped(fleet, filter) {
  const { uavs, missions, numbers } = fleet;
  const shown = uavs.filter((uav) => passes(uav, filter, fleet));
  /** @param {LiveMission | null} mission */
  const groupOf = (mission) => {
    const own = shown.filter((uav) => uav.mission === (mission?.id ?? null));
    if (own.length === 0) return [];
    own.sort((a, b) => (a.place ?? 0) - (b.place ?? 0) || a.name.localeCompare(b.name, undefined, { numeric: true }));
    const flying = own.filter((uav) => inAir(uav) === true).length;
    return [{ id: `of ${mission?.id ?? ""}`, mission, uavs: own.length, flying }, ...own];
  };
  const numbered = [...missions].sort((a, b) => (numbers.get(a.id) ?? 0) - (numbers.get(b.id) ?? 0));
  return [...numbered.flatMap(groupOf), ...groupOf(null)];
}

/** @param {LiveUav | GroupHead} entry @returns {entry is GroupHead} */
export const isHead = (entry) => typeof entry.id === "string";

/**
 * The listed UAVs: those of one mission, or on the live page the filtered ones of all missions below their heads.
 *
 * @param {Fleet & { filter: FleetFilter }} fleet
 * @param {boolean} isOfOne
 * @returns {(GroupHead | LiveUav)[]}
 */
export const listed = (fleet, isOfOne) =>
  isOfOne ? inOrder(fleet.uavs, fleet.missions) : grouped(fleet, fleet.filter);
