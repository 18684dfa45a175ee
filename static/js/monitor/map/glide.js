/** Interpolation of a marker from one report to the next, without overshoot. Values in, values out. */

export const GLIDE_MS = 300;

/**
 * Position [lon, lat] of a marker `since_ms` after it began to move from one place to another.
 *
 * @param {readonly number[]} from
 * @param {readonly number[]} to
 * @param {number} since_ms
 * @param {number} [over_ms]
 * @returns {[number, number]}
 */
export function between([fromLon, fromLat], [toLon, toLat], since_ms, over_ms = GLIDE_MS) {
  const share = over_ms > 0 ? Math.min(1, Math.max(0, since_ms / over_ms)) : 1;
  return [fromLon + (toLon - fromLon) * share, fromLat + (toLat - fromLat) * share];
}
