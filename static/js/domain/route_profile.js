/** A route as distances flown: where its waypoints, legs and targets are along it. */

import { distance_m } from "./geodesy.js";

/** @import { Waypoint } from "../api_types.d.ts" */

/**
 * Profile along a route's waypoints: their places, legs off the network, and targets. All in metres flown.
 *
 * @param {readonly Waypoint[]} waypoints
 * @param {number} length_m
 */
export function profileOf(waypoints, length_m) {
  /** @type {number[]} */
  const along = waypoints.length ? [0] : [];
  for (let index = 1; index < waypoints.length; index += 1)
    along.push(along[index - 1] + distance_m(waypoints[index - 1].position, waypoints[index].position));
  const drawn_m = along.at(-1) ?? 0;
  const scale = drawn_m > 0 ? length_m / drawn_m : 1; // the server's geodesic length is the true one
  const places = along.map((distance) => distance * scale);
  /** @param {Waypoint} waypoint */
  const isOff = (waypoint) => waypoint.kind === "start" || waypoint.kind === "end" || waypoint.asset === null;
  /** @type {{ from: number, to: number, offNetwork: boolean }[]} */
  const legs = [];
  for (let index = 1; index < waypoints.length; index += 1) {
    if (places[index] === places[index - 1]) continue;
    const offNetwork = isOff(waypoints[index - 1]) || isOff(waypoints[index]);
    const last = legs.at(-1);
    if (last && last.offNetwork === offNetwork) last.to = places[index];
    else legs.push({ from: places[index - 1], to: places[index], offNetwork });
  }
  /** @type {{ target: number | null, at: number }[]} */
  const targets = [];
  waypoints.forEach((waypoint, index) => {
    if (waypoint.kind === "target") targets.push({ target: waypoint.target, at: places[index] });
  });
  return {
    places,
    legs,
    targets,
    ticks: places.filter((_, index) => waypoints[index].kind !== "start" && waypoints[index].kind !== "end"),
  };
}

/**
 * Position on the route's waypoints at a distance from its start, lon lat.
 *
 * @param {readonly Pick<Waypoint, "position">[]} waypoints
 * @param {readonly number[]} places
 * @param {number} distance [m]
 * @returns {number[]}
 */
export function positionAt(waypoints, places, distance) {
  const next = places.findIndex((place) => place >= distance);
  if (next <= 0) return waypoints[next === 0 ? 0 : waypoints.length - 1].position;
  const span = places[next] - places[next - 1];
  const share = span > 0 ? (distance - places[next - 1]) / span : 0;
  const [from, to] = [waypoints[next - 1].position, waypoints[next].position];
  return [from[0] + (to[0] - from[0]) * share, from[1] + (to[1] - from[1]) * share];
}
