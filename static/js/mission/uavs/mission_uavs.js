/** UAVs of a mission: taken from the fleet, distinguished by name, moved, changed for it. Values in, values out. */

import { OWN_FIGURES } from "../../uav_figures.js";

/** @import { UavFeature } from "../../api_types.d.ts" */
/** @import { FleetUav, MissionSelection, PickedUav } from "../types.d.ts" */

const MAX_UAV_NAME_LENGTH = 100; // missions/serializers/limits.py

/** @param {UavFeature} feature @returns {FleetUav} */
export function uavOf(feature) {
  const {
    name,
    base,
    base_name,
    max_range_m,
    cruise_speed_mps,
    end_action,
    state,
    missing,
    type_name,
    sensors,
    battery_percent,
    heading_deg,
    is_simulated,
  } = feature.properties;
  const figures = OWN_FIGURES.map((figure) => [figure, feature.properties[figure] ?? null]);
  /** @type {FleetUav["usual"]} */
  const usual = Object.fromEntries(figures); // a mission may override it
  return {
    id: feature.id,
    name,
    base: base ?? null,
    base_name: base_name ?? "",
    position: feature.geometry.coordinates.slice(0, 2),
    max_range_m,
    cruise_speed_mps,
    end_action,
    state: state ?? "active",
    missing: missing ?? [],
    type_name: type_name ?? "",
    sensors: sensors ?? [],
    battery_percent: battery_percent ?? null,
    heading_deg: heading_deg ?? null,
    is_simulated: is_simulated ?? false,
    usual,
  };
}

/**
 * "Heron", or where one of the UAVs is called so "Heron 2": ties and locks name the one that they mean.
 *
 * @param {MissionSelection} selection
 * @param {string} name
 */
function freeName({ uavs }, name) {
  const taken = new Set(uavs.map((uav) => uav.name));
  let free = name;
  for (let number = 2; taken.has(free); number += 1)
    free = `${name.slice(0, MAX_UAV_NAME_LENGTH - ` ${number}`.length)} ${number}`;
  return free;
}

/**
 * Add a UAV of the fleet; it receives another name in this mission where its own is taken.
 *
 * @param {MissionSelection} selection
 * @param {PickedUav} uav
 * @returns {MissionSelection}
 */
export function withUav(selection, uav) {
  if (selection.uavs.some((chosen) => chosen.id === uav.id)) return selection;
  return { ...selection, uavs: [...selection.uavs, { ...uav, name: freeName(selection, uav.name) }] };
}

/**
 * UAVs by name, for ties and locks; without names that two of them share.
 *
 * @param {Pick<MissionSelection, "uavs">} selection
 */
export function uavsByName({ uavs }) {
  const count = new Map();
  for (const { name } of uavs) count.set(name, (count.get(name) ?? 0) + 1);
  return uavs.map((uav, sequence) => ({ ...uav, sequence })).filter(({ name }) => count.get(name) === 1);
}

/** @param {MissionSelection} selection @param {number} sequence @returns {MissionSelection} */
export function withoutUavAt(selection, sequence) {
  return { ...selection, uavs: selection.uavs.filter((_, index) => index !== sequence) };
}

/**
 * @param {MissionSelection} selection
 * @param {number} sequence
 * @param {number[]} position
 * @returns {MissionSelection}
 */
export function withUavAt(selection, sequence, position) {
  return { ...selection, uavs: selection.uavs.map((uav, index) => (index === sequence ? { ...uav, position } : uav)) };
}

/**
 * The same UAV with other values, in this mission.
 *
 * @param {MissionSelection} selection
 * @param {number} sequence
 * @param {Partial<PickedUav>} values
 * @returns {MissionSelection}
 */
export function withUavAs(selection, sequence, values) {
  return { ...selection, uavs: selection.uavs.map((uav, index) => (index === sequence ? { ...uav, ...values } : uav)) };
}
