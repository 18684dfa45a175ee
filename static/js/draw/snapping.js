/** Snapping of a vertex to nearby features: vertices first, then the sides of lines. */

import { get } from "../api.js";
import { distance_m, nearestOnLine } from "../domain/geodesy.js";
import { TILES } from "../map/look/voltages.js";

/** @import { Answer } from "../api.js" */
/** @import { AssetDetailFeature } from "../api_types.d.ts" */
/** @import { Line } from "../domain/geodesy.js" */
/** @import { Geometry, MapLibreMap, ScreenPoint } from "../map/types.d.ts" */
/** @import { Snapped } from "./types.d.ts" */

const REACH_PX = matchMedia("(pointer: coarse)").matches ? 18 : 11;
const LAYERS = ["towers", "towers-high", "towers-ring", "lines", "lines-unknown", "railways", "bridges"];
const TILE_STEPS = 4096; // a tile rounds positions to its grid; the asset itself has them exactly
const EQUATOR_M = 40_075_017;

/** @param {Geometry} geometry @returns {number[][][]} */
function ringsOf(geometry) {
  if (geometry.type === "Point") return [[geometry.coordinates]];
  if (geometry.type === "LineString") return [geometry.coordinates];
  if (geometry.type === "MultiLineString" || geometry.type === "Polygon") return geometry.coordinates;
  return geometry.type === "MultiPolygon" ? geometry.coordinates.flat() : [];
}
/** @param {Geometry} geometry @returns {geometry is Line} */
const isLine = (geometry) => geometry.type === "LineString" || geometry.type === "MultiLineString";

/**
 * { position, asset, isVertex } of the nearest vertex within reach, else of the nearest place on a line; null without any.
 * `own` are vertices of the shape itself; they have no asset.
 *
 * @param {MapLibreMap} map
 * @param {ScreenPoint} point
 * @param {{ but?: number | null, own?: { position: number[] }[] }} [options]
 * @returns {Snapped | null}
 */
export function snap(map, point, { but = null, own = [] } = {}) {
  /** @type {[[number, number], [number, number]]} */
  const box = [
    [point.x - REACH_PX, point.y - REACH_PX],
    [point.x + REACH_PX, point.y + REACH_PX],
  ];
  const met = map
    .queryRenderedFeatures(box, { layers: LAYERS.filter((id) => map.getLayer(id)) })
    .filter((feature) => feature.source === TILES && feature.properties.id !== but);
  /** @type {(Snapped & { far: number })[]} */
  const offers = [];
  /** @param {number[]} position @param {number | null} asset @param {boolean} isVertex */
  const offer = (position, asset, isVertex) => {
    const place = map.project([position[0], position[1]]);
    const far = Math.hypot(place.x - point.x, place.y - point.y);
    if (far <= REACH_PX) offers.push({ position, asset, isVertex, far });
  };
  for (const { position } of own) offer(position, null, true);
  for (const feature of met) {
    for (const path of ringsOf(/** @type {Geometry} */ (feature.geometry)))
      for (const position of path) offer(position, feature.properties.id, true);
  }
  if (offers.length) return nearestOf(offers);
  const { lng, lat } = map.unproject([point.x, point.y]);
  for (const feature of met) {
    const geometry = /** @type {Geometry} */ (feature.geometry);
    const place = isLine(geometry) && nearestOnLine(geometry, [lng, lat]);
    if (place) offer(place, feature.properties.id, false);
  }
  return nearestOf(offers);
}

/** @param {(Snapped & { far: number })[]} offers */
const nearestOf = (offers) => offers.reduce((best, next) => (next.far < best.far ? next : best), offers[0]) ?? null;

/** By asset. @type {Map<number, Promise<Geometry | null>>} */
const shapes = new Map();

export const forgetShapes = () => shapes.clear();

/** @param {number} asset */
function shapeOfAsset(asset) {
  const kept = shapes.get(asset) ?? readShape(asset);
  shapes.set(asset, kept);
  return kept;
}

/** @param {number} asset @returns {Promise<Geometry | null>} */
async function readShape(asset) {
  try {
    const { data } = /** @type {Answer<AssetDetailFeature>} */ (await get(`/assets/${asset}`));
    return /** @type {Geometry} */ (data.geometry);
  } catch {
    shapes.delete(asset);
    return null;
  }
}

/**
 * The asset's own vertex, else the place on its line, in full precision; the position itself where the asset cannot be loaded.
 *
 * @param {MapLibreMap} map
 * @param {Snapped} snapped
 * @returns {Promise<number[]>}
 */
export async function exact(map, { position, asset, isVertex }) {
  const geometry = asset === null ? null : await shapeOfAsset(asset);
  if (!geometry) return position;
  const rounding_m = (2 * EQUATOR_M) / 2 ** Math.floor(map.getZoom()) / TILE_STEPS;
  if (isVertex) {
    const [nearest] = ringsOf(geometry)
      .flat()
      .map((vertex) => ({ vertex, far: distance_m(vertex, position) }))
      .sort((a, b) => a.far - b.far);
    if (nearest && nearest.far <= rounding_m) return nearest.vertex.slice(0, 2);
  }
  return (isLine(geometry) && nearestOnLine(geometry, position)) || position; // where a tile cuts a line there is no vertex
}
