/** The part of a drawn line between two places on it. */

/** @import { Geometry } from "../../map/types.d.ts" */

/**
 * Nearest place of one path to a position: { index of the leg, share along it, distance }, on the local plane.
 *
 * @param {number[][]} path
 * @param {readonly number[]} position
 */
function placeOn(path, [longitude, latitude]) {
  const shrink = Math.cos((latitude * Math.PI) / 180);
  let best = { index: 0, share: 0, distance: Infinity };
  for (let index = 1; index < path.length; index += 1) {
    const [ax, ay] = [path[index - 1][0] * shrink, path[index - 1][1]];
    const [dx, dy] = [path[index][0] * shrink - ax, path[index][1] - ay];
    const square = dx * dx + dy * dy;
    const share = square
      ? Math.min(1, Math.max(0, ((longitude * shrink - ax) * dx + (latitude - ay) * dy) / square))
      : 0;
    const distance = (ax + share * dx - longitude * shrink) ** 2 + (ay + share * dy - latitude) ** 2;
    if (distance < best.distance) best = { index: index - 1, share, distance };
  }
  return best;
}

/**
 * A LineString from one end of the stretch to the other; the whole geometry where it is not one line.
 *
 * @param {Geometry} geometry
 * @param {readonly number[][]} ends
 * @returns {Geometry}
 */
export function partOfLine(geometry, [start, end]) {
  if (geometry.type !== "LineString") return geometry;
  const path = geometry.coordinates;
  const [a, b] = [placeOn(path, start), placeOn(path, end)];
  const isForward = a.index < b.index || (a.index === b.index && a.share <= b.share);
  const [first, last] = isForward ? [a, b] : [b, a];
  const [from, to] = isForward ? [start, end] : [end, start];
  return { type: "LineString", coordinates: [from, ...path.slice(first.index + 1, last.index + 1), to] };
}
