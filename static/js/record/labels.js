/** Names of targets as the other stages have them: the UAV's letter and the place on its route. */

import { routeLetter } from "../domain/palette.js";

/** Map of target → { label, place, number, position }. */
export function labelsOf(routes) {
  const labels = new Map();
  for (const { place, waypoints } of routes) {
    let number = 0;
    for (const { target, position } of waypoints) {
      if (target === null || labels.has(target)) continue;
      number += 1;
      labels.set(target, { label: `${routeLetter(place)}${number}`, place, number, position });
    }
  }
  return labels;
}

/** "A2", "take-off", "end" or "point 7": a waypoint as an end of a leg. words: of the kinds start, end and base; otherwise(sequence). */
export function waypointName({ waypoints }, sequence, labels, words, otherwise) {
  const waypoint = waypoints.find((one) => one.sequence === sequence);
  const target = labels.get(waypoint?.target)?.label;
  return target ?? words[waypoint?.kind] ?? otherwise(sequence);
}
