/** Whether a place is on a bridge that carries rails, and the height of its deck. Values in, a function out. */

/** @import { SceneBridge } from "../../api_types.d.ts" */
/** @import { Frame, Ring } from "../types.d.ts" */

const CARRIES_RAILS = /railway/;

/**
 * Gives deckAt(x, z) -> y of the deck, or null.
 *
 * @param {readonly Pick<SceneBridge, "carries" | "polygons" | "deck_amsl_m">[]} bridges
 * @param {Frame} frame
 * @returns {(x: number, z: number) => number | null}
 */
export function deckUnder(bridges, frame) {
  const decks = bridges
    .filter(({ carries }) => CARRIES_RAILS.test(carries))
    .flatMap(({ polygons, deck_amsl_m }) =>
      polygons.map(([outline]) => {
        const ring = outline.map(([lon, lat]) => frame.toLocal(lon, lat, 0)).map(([x, , z]) => [x, z]);
        const [xs, zs] = [ring.map(([x]) => x), ring.map(([, z]) => z)];
        return {
          ring,
          box: [Math.min(...xs), Math.min(...zs), Math.max(...xs), Math.max(...zs)],
          y: deck_amsl_m - frame.origin.altitude_amsl_m,
        };
      }),
    );
  return (x, z) => {
    /** @type {number | null} */
    let highest = null;
    for (const { ring, box, y } of decks) {
      if (x < box[0] || x > box[2] || z < box[1] || z > box[3] || (highest !== null && y <= highest)) continue;
      if (isInside(ring, x, z)) highest = y;
    }
    return highest;
  };
}

/**
 * Whether the place is inside the ring: a ray from it crosses the ring an odd number of times.
 *
 * @param {Ring} ring
 * @param {number} x
 * @param {number} z
 */
export function isInside(ring, x, z) {
  let inside = false;
  for (let at = 0; at < ring.length - 1; at += 1) {
    const [[ax, az], [bx, bz]] = [ring[at], ring[at + 1]];
    if (az > z !== bz > z && x < ax + ((bx - ax) * (z - az)) / (bz - az)) inside = !inside;
  }
  return inside;
}
