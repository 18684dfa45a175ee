/** Places and directions of the scene's frame as [x, y, z]: x east, y up, z south, metres. */

/** @import { Vector } from "../types.d.ts" */

export const RADIANS = Math.PI / 180;

/** @param {Vector} a @param {Vector} b @param {number} [share] @returns {Vector} */
export const plus = (a, b, share = 1) => [a[0] + b[0] * share, a[1] + b[1] * share, a[2] + b[2] * share];
/** @param {Vector} a @param {Vector} b @returns {Vector} */
export const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
/** @param {Vector} vector */
export const lengthOf = ([x, y, z]) => Math.hypot(x, y, z);
/** @param {Vector} a @param {Vector} b @param {number} share @returns {Vector} */
export const between = (a, b, share) => plus(a, minus(b, a), share);

/**
 * Unit vector towards a bearing (from true north, clockwise) and an elevation above the horizon [deg].
 *
 * @param {number} bearing_deg
 * @param {number} [elevation_deg]
 * @returns {Vector}
 */
export function towards(bearing_deg, elevation_deg = 0) {
  const [bearing, elevation] = [bearing_deg * RADIANS, elevation_deg * RADIANS];
  return [Math.sin(bearing) * Math.cos(elevation), Math.sin(elevation), -Math.cos(bearing) * Math.cos(elevation)];
}

/** Bearing and elevation [deg] of a direction: the way back of `towards`. @param {Vector} direction */
export function directionOf([x, y, z]) {
  return {
    bearing_deg: (Math.atan2(x, -z) / RADIANS + 360) % 360,
    elevation_deg: Math.atan2(y, Math.hypot(x, z)) / RADIANS,
  };
}

/** From one bearing to another the short way, -180 to 180 [deg]. @param {number} from_deg @param {number} to_deg */
export const turn_deg = (from_deg, to_deg) => ((((to_deg - from_deg) % 360) + 540) % 360) - 180;

/** @param {number} value @param {number} least @param {number} most */
export const within = (value, least, most) => Math.min(most, Math.max(least, value));
