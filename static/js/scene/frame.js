/** The room of the 3D view in metres: x east, y up, z south of an origin. Values in, values out; no three.js. */

/** @import { Vector } from "./types.d.ts" */

const MAJOR_M = 6_378_137; // WGS84
const ECCENTRICITY_2 = 0.0066943799901413165;
const RADIANS = Math.PI / 180;

/**
 * The frame of inspection/geodesy/local_frame.py: straight in lon/lat is straight here.
 *
 * @param {{ position: number[], altitude_amsl_m: number }} origin position: lon, lat
 */
export function makeFrame(origin) {
  const [lon0, lat0] = origin.position;
  const altitude0_m = origin.altitude_amsl_m;
  const curvature = 1 - ECCENTRICITY_2 * Math.sin(lat0 * RADIANS) ** 2;
  const east_m = RADIANS * (MAJOR_M / Math.sqrt(curvature)) * Math.max(Math.cos(lat0 * RADIANS), 1e-9);
  const north_m = RADIANS * ((MAJOR_M * (1 - ECCENTRICITY_2)) / curvature ** 1.5);
  return {
    origin,
    /** east, north */
    metresPerDegree: [east_m, north_m],
    /** @param {number} lon @param {number} lat @param {number} altitude_amsl_m @returns {Vector} */
    toLocal: (lon, lat, altitude_amsl_m) => [
      (lon - lon0) * east_m,
      altitude_amsl_m - altitude0_m,
      (lat0 - lat) * north_m,
    ],
    /** lon, lat, altitude_amsl_m of a place. @param {Vector} place @returns {[number, number, number]} */
    toGeographic: ([x, y, z]) => [lon0 + x / east_m, lat0 - z / north_m, altitude0_m + y],
  };
}

/** Clockwise from north, of a direction on the ground; 0 to 360. @param {number} x @param {number} z */
export function bearing_deg(x, z) {
  return (((Math.atan2(x, -z) / RADIANS) % 360) + 360) % 360;
}

/** The direction [x, z], of length 1, of a bearing. @param {number} bearing @returns {[number, number]} */
export function direction(bearing) {
  return [Math.sin(bearing * RADIANS), -Math.cos(bearing * RADIANS)];
}
