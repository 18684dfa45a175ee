/** The ellipse in which a UAV is 95 of 100 times, as a ring on the map. Values in, values out. */

/** @import { Bound } from "../types.d.ts" */

const CORNERS = 48;
const METRES_A_DEGREE = 111_195; // of latitude, on the sphere that draws it

/**
 * Metres that a pixel shows at a latitude, of MapLibre's tiles of 512 px.
 *
 * @param {number} zoom
 * @param {number} latitude
 */
export const metresPerPixel = (zoom, latitude) =>
  (40_075_016.686 * Math.cos((latitude * Math.PI) / 180)) / (512 * 2 ** zoom);

/**
 * No semi-axis shorter than least_m. A closed ring of lon lat.
 *
 * @param {readonly number[]} position
 * @param {Bound} bound
 * @param {number} [least_m]
 */
export function ellipseRing([longitude, latitude], { along_m, across_m, bearing_deg }, least_m = 0) {
  const [along, across] = [Math.max(along_m, least_m), Math.max(across_m, least_m)];
  const bearing = (bearing_deg * Math.PI) / 180;
  const shrink = Math.cos((latitude * Math.PI) / 180);
  const ring = Array.from({ length: CORNERS }, (_, index) => {
    const angle = (index / CORNERS) * 2 * Math.PI;
    const [ahead, aside] = [along * Math.cos(angle), across * Math.sin(angle)];
    const east_m = ahead * Math.sin(bearing) + aside * Math.cos(bearing);
    const north_m = ahead * Math.cos(bearing) - aside * Math.sin(bearing);
    return [longitude + east_m / (METRES_A_DEGREE * shrink), latitude + north_m / METRES_A_DEGREE];
  });
  return [...ring, ring[0]];
}
