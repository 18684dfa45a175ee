/** Which addresses make the offline copy of a mission. Values in, values out. */

/** @import { Mission, MissionState } from "../api_types.d.ts" */

const [MIN_ZOOM, MAX_ZOOM] = [7, 15]; // largest zoom that the map requests
const MAX_TILES = 240;
const AROUND_DEG = 0.01; // some 1 km on each side of a route

/** States in which a mission is approved and not over. @type {Set<MissionState>} */
const KEPT_STATES = new Set(["approved", "dispatched", "active"]);

/** @param {Pick<Mission, "state">} mission */
export const isKept = ({ state }) => KEPT_STATES.has(state);

/**
 * Its pages and documents, which are kept together.
 *
 * @param {string} mission id
 * @param {string[]} fleet addresses of the pages of UAVs
 */
export const wholeOf = (mission, fleet) => [
  `/missions/${mission}`,
  `/missions/${mission}/fly`,
  `/api/v1/missions/${mission}`,
  `/api/v1/missions/${mission}/approval`,
  "/api/v1/ground",
  ...fleet,
];

/** Prefixes of a mission's addresses, which are dropped with it. @param {string} mission id */
export const startsOf = (mission) => [`/missions/${mission}`, `/api/v1/missions/${mission}`];

/** Every place that the mission's map has to show, lon lat. @param {Mission} mission @returns {number[][]} */
export function placesOf({ plan, targets, uavs, lost_link }) {
  const flown = (plan?.routes ?? []).flatMap(({ waypoints }) => waypoints.map(({ position }) => position));
  const picked = targets.flatMap(({ position }) => (position ? [position] : []));
  return [...flown, ...picked, ...uavs.map(({ position }) => position), ...lost_link.rally_points];
}

/**
 * Tiles round the places, from small to large zoom, up to the zoom at which they are too many.
 *
 * @param {number[][]} places lon lat
 * @returns {string[]}
 */
export function tilesOf(places) {
  if (places.length === 0) return [];
  const [longitudes, latitudes] = [places.map(([longitude]) => longitude), places.map(([, latitude]) => latitude)];
  const [west, east] = [Math.min(...longitudes) - AROUND_DEG, Math.max(...longitudes) + AROUND_DEG];
  const [south, north] = [Math.min(...latitudes) - AROUND_DEG, Math.max(...latitudes) + AROUND_DEG];
  /** @type {string[]} */
  const found = [];
  for (let zoom = MIN_ZOOM; zoom <= MAX_ZOOM; zoom += 1) {
    const [left, right] = [columnOf(west, zoom), columnOf(east, zoom)];
    const [top, bottom] = [rowOf(north, zoom), rowOf(south, zoom)];
    if (found.length + (right - left + 1) * (bottom - top + 1) > MAX_TILES) break;
    for (let column = left; column <= right; column += 1)
      for (let row = top; row <= bottom; row += 1) found.push(`/api/v1/tiles/${zoom}/${column}/${row}`);
  }
  return found;
}

/** @param {number} longitude @param {number} zoom */
const columnOf = (longitude, zoom) => Math.floor(((longitude + 180) / 360) * 2 ** zoom);

/** Row of a tile in the Mercator projection of web maps. @param {number} latitude @param {number} zoom */
function rowOf(latitude, zoom) {
  const angle = (latitude * Math.PI) / 180;
  return Math.floor(((1 - Math.asinh(Math.tan(angle)) / Math.PI) / 2) * 2 ** zoom);
}
