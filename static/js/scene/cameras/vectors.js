/** Places and directions of the scene's frame as [x, y, z]: x east, y up, z south, metres. */

export const RADIANS = Math.PI / 180;

export const plus = (a, b, share = 1) => [a[0] + b[0] * share, a[1] + b[1] * share, a[2] + b[2] * share];
export const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const lengthOf = ([x, y, z]) => Math.hypot(x, y, z);
export const between = (a, b, share) => [0, 1, 2].map((axis) => a[axis] + (b[axis] - a[axis]) * share);

/** Unit vector towards a bearing (from true north, clockwise) and an elevation above the horizon [deg]. */
export function towards(bearing_deg, elevation_deg = 0) {
  const [bearing, elevation] = [bearing_deg * RADIANS, elevation_deg * RADIANS];
  return [Math.sin(bearing) * Math.cos(elevation), Math.sin(elevation), -Math.cos(bearing) * Math.cos(elevation)];
}

/** Bearing and elevation [deg] of a direction: the way back of `towards`. */
export function directionOf([x, y, z]) {
  return {
    bearing_deg: (Math.atan2(x, -z) / RADIANS + 360) % 360,
    elevation_deg: Math.atan2(y, Math.hypot(x, z)) / RADIANS,
  };
}

/** From one bearing to another the short way, -180 to 180 [deg]. */
export const turn_deg = (from_deg, to_deg) => ((((to_deg - from_deg) % 360) + 540) % 360) - 180;

export const within = (value, least, most) => Math.min(most, Math.max(least, value));
