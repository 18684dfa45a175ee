/** Names of targets as the other stages have them: the UAV's letter and the place on its route. */

import { routeLetter, routeNumber } from "../domain/palette.js";

/** @import { RecordRoute, WaypointKind } from "../api_types.d.ts" */

/** @typedef {{ label: string, place: number, colour: number, number: number, position: number[] }} TargetLabel place and colour: of its UAV */
/** @typedef {Map<number, TargetLabel>} Labels by target */

/**
 * @param {readonly { place: number, waypoints: readonly { target: number | null, position: number[] }[] }[]} routes
 * @param {readonly number[]} [colours] of the mission
 */
export function labelsOf(routes, colours) {
  /** @type {Labels} */
  const labels = new Map();
  for (const { place, waypoints } of routes) {
    let number = 0;
    for (const { target, position } of waypoints) {
      if (target === null || labels.has(target)) continue;
      number += 1;
      labels.set(target, {
        label: `${routeLetter(place)}${number}`,
        place,
        colour: routeNumber(place, colours),
        number,
        position,
      });
    }
  }
  return labels;
}

/**
 * "A2", "take-off", "end" or "point 7": name of a waypoint as an end of a leg.
 *
 * @param {Pick<RecordRoute, "waypoints">} route
 * @param {number} sequence
 * @param {ReadonlyMap<number, Pick<TargetLabel, "label">>} labels
 * @param {{ [Kind in WaypointKind]?: string }} words of the kinds start, end and base
 * @param {(sequence: number) => string} otherwise
 */
export function waypointName({ waypoints }, sequence, labels, words, otherwise) {
  const waypoint = waypoints.find((one) => one.sequence === sequence);
  const target = labels.get(waypoint?.target ?? NaN)?.label;
  return target ?? (waypoint && words[waypoint.kind]) ?? otherwise(sequence);
}
