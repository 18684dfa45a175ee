/** GeoJSON text to geometry and back. The server checks again and is stricter. */

import { t } from "../text.js";

/** @import { Geometry } from "../map/types.d.ts" */

const DIGITS = 7; // about a centimetre

/**
 * { geometry } or { fault: sentence }; neither for empty text.
 *
 * @param {string} text
 * @returns {{ geometry?: Geometry, fault?: string }}
 */
export function parseGeometry(text) {
  if (!text.trim()) return {};
  let geometry;
  try {
    geometry = JSON.parse(text);
  } catch {
    return { fault: t("This is not JSON.") };
  }
  if (!geometry?.type || !Array.isArray(geometry.coordinates))
    return { fault: t("A GeoJSON geometry has a type and coordinates.") };
  const positions = positionsOf(geometry);
  /** @param {number[]} position */
  const isSound = ([longitude, latitude]) =>
    Number.isFinite(longitude) && Number.isFinite(latitude) && Math.abs(longitude) <= 180 && Math.abs(latitude) <= 90;
  if (!positions.length || !positions.every(isSound))
    return { fault: t("A position is longitude, then latitude, in degrees.") };
  return { geometry };
}

/** All positions of a geometry. @param {Geometry} geometry @returns {number[][]} */
export function positionsOf({ coordinates }) {
  if (!coordinates.length) return [];
  return Array.isArray(coordinates[0])
    ? ringsIn(/** @type {unknown[][]} */ (coordinates)).flat()
    : [/** @type {number[]} */ (coordinates)];
}

/** The lists of positions in nested coordinates. @param {unknown[][]} nested @returns {number[][][]} */
function ringsIn(nested) {
  return Array.isArray(nested[0]?.[0])
    ? /** @type {unknown[][][]} */ (nested).flatMap(ringsIn)
    : [/** @type {number[][]} */ (nested)];
}

/** The paths that are drawn, as a feature: an area that crosses itself would not be drawn as an area at all. @param {Geometry} geometry */
export function outlineOf({ coordinates }) {
  const paths = ringsIn(/** @type {unknown[][]} */ (coordinates));
  return { type: "Feature", properties: {}, geometry: { type: "MultiLineString", coordinates: paths } };
}

/** @param {number} longitude @param {number} latitude */
export function pointText(longitude, latitude) {
  return JSON.stringify({
    type: "Point",
    coordinates: [Number(longitude.toFixed(DIGITS)), Number(latitude.toFixed(DIGITS))],
  });
}
