/** The view as part of the page's address, #map=zoom/latitude/longitude, and whether a view shows any data. Values in, values out. */

/** @import { Box, Position } from "./types.d.ts" */

const WORLD_PX = 512; // the whole world at zoom 0
const MIN_PX = 24; // an extent smaller than this on the screen shows nothing
const NEAR_ZOOM = 12; // from here on even a single place is worth looking at

/** @param {number} longitude */
const toX = (longitude) => (longitude + 180) / 360;
/** @param {number} latitude */
const toY = (latitude) => (1 - Math.asinh(Math.tan((latitude * Math.PI) / 180)) / Math.PI) / 2;

/** { zoom, centre: [lon, lat] } or null. @param {string} hash @returns {{ zoom: number, centre: Position } | null} */
export function viewOf(hash) {
  const found = /[#&]map=([\d.]+)\/(-?[\d.]+)\/(-?[\d.]+)/.exec(hash);
  if (!found) return null;
  const [zoom, latitude, longitude] = found.slice(1).map(Number);
  const isPlace = zoom <= 24 && Math.abs(latitude) < 90 && Math.abs(longitude) <= 180;
  return isPlace ? { zoom, centre: [longitude, latitude] } : null;
}

/** @param {{ zoom: number, centre: readonly number[] }} view */
export function hashOf({ zoom, centre: [longitude, latitude] }) {
  const digits = Math.max(2, Math.ceil((zoom * Math.LN2 + Math.log(WORLD_PX / 360 / 0.5)) / Math.LN10)); // half a pixel
  return `#map=${Number(zoom.toFixed(2))}/${latitude.toFixed(digits)}/${longitude.toFixed(digits)}`;
}

/**
 * Whether [west, south, east, north] is recognisable in a view of this size in px. Without an extent every view is accepted.
 *
 * @param {{ zoom: number, centre: Position }} view
 * @param {[number, number]} size width, height [px]
 * @param {Box | null | undefined} extent
 * @param {number} [least_px] size of the extent from which it is recognisable
 */
export function showsAnything(
  { zoom, centre: [longitude, latitude] },
  [width_px, height_px],
  extent,
  least_px = MIN_PX,
) {
  if (!extent) return true;
  const scale = WORLD_PX * 2 ** zoom;
  const [left, right] = [extent[0], extent[2]].map((edge) => (toX(edge) - toX(longitude)) * scale);
  const [top, bottom] = [extent[3], extent[1]].map((edge) => (toY(edge) - toY(latitude)) * scale);
  const isInside = right >= -width_px / 2 && left <= width_px / 2 && bottom >= -height_px / 2 && top <= height_px / 2;
  return isInside && (zoom >= NEAR_ZOOM || Math.max(right - left, bottom - top) >= least_px);
}
