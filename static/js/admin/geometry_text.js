/** GeoJSON text to geometry and back. The server checks again and is stricter. */

import { t } from "../text.js";

const DIGITS = 7; // about a centimetre

/** { geometry } or { fault: sentence }; neither for empty text. */
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
  const isSound = ([longitude, latitude]) =>
    Number.isFinite(longitude) && Number.isFinite(latitude) && Math.abs(longitude) <= 180 && Math.abs(latitude) <= 90;
  if (!positions.length || !positions.every(isSound))
    return { fault: t("A position is longitude, then latitude, in degrees.") };
  return { geometry };
}

export function positionsOf(geometry) {
  const positions = [];
  const walk = (value) => (Array.isArray(value[0]) ? value.forEach(walk) : positions.push(value));
  if (geometry.coordinates.length) walk(geometry.coordinates);
  return positions;
}

/** The paths that are drawn, as a feature: an area that crosses itself would not be drawn as an area at all. */
export function outlineOf(geometry) {
  const paths = [];
  const walk = (value) => (Array.isArray(value[0]?.[0]) ? value.forEach(walk) : paths.push(value));
  walk(geometry.coordinates);
  return { type: "Feature", properties: {}, geometry: { type: "MultiLineString", coordinates: paths } };
}

export function pointText(longitude, latitude) {
  return JSON.stringify({
    type: "Point",
    coordinates: [Number(longitude.toFixed(DIGITS)), Number(latitude.toFixed(DIGITS))],
  });
}
