/** Where a vertex is meant to be when it comes near to what is there already: vertices first, then the sides of lines. */

import { get } from "../api.js";
import { distance_m, nearestOnLine } from "../domain/geodesy.js";
import { TILES } from "../map/look/voltages.js";

const REACH_PX = matchMedia("(pointer: coarse)").matches ? 18 : 11;
const LAYERS = ["towers", "towers-high", "towers-ring", "lines", "lines-unknown", "railways", "bridges"];
const TILE_STEPS = 4096; // a tile rounds positions to its grid; the asset itself has them exactly
const EQUATOR_M = 40_075_017;

const ringsOf = ({ type, coordinates }) =>
  ({
    Point: [[coordinates]],
    LineString: [coordinates],
    MultiLineString: coordinates,
    Polygon: coordinates,
    MultiPolygon: coordinates.flat(),
  })[type] ?? [];
const isLine = ({ type }) => type === "LineString" || type === "MultiLineString";

/**
 * { position, asset, isVertex } of the nearest vertex within reach, else of the nearest place on a line; null where there is nothing.
 * `own` are vertices of the shape itself, { position }; they have no asset.
 */
export function snap(map, point, { but = null, own = [] } = {}) {
  const box = [
    [point.x - REACH_PX, point.y - REACH_PX],
    [point.x + REACH_PX, point.y + REACH_PX],
  ];
  const met = map
    .queryRenderedFeatures(box, { layers: LAYERS.filter((id) => map.getLayer(id)) })
    .filter((feature) => feature.source === TILES && feature.properties.id !== but);
  let best = null;
  const offer = (position, asset, isVertex) => {
    const place = map.project(position);
    const far = Math.hypot(place.x - point.x, place.y - point.y);
    if (far <= REACH_PX && (!best || far < best.far)) best = { position, asset, isVertex, far };
  };
  for (const { position } of own) offer(position, null, true);
  for (const feature of met) {
    for (const path of ringsOf(feature.geometry))
      for (const position of path) offer(position, feature.properties.id, true);
  }
  if (best) return best;
  const { lng, lat } = map.unproject(point);
  for (const { geometry, properties } of met) {
    if (isLine(geometry)) offer(nearestOnLine(geometry, [lng, lat]), properties.id, false);
  }
  return best;
}

const shapes = new Map(); // asset id → promise of its geometry

export const forgetShapes = () => shapes.clear();

function shapeOfAsset(asset) {
  if (!shapes.has(asset))
    shapes.set(
      asset,
      get(`/assets/${asset}`).then(
        ({ data }) => data.geometry,
        () => (shapes.delete(asset), null),
      ),
    );
  return shapes.get(asset);
}

/** The asset's own vertex, else the place on its own line, to the last digit; the position itself where the asset cannot be had. */
export async function exact(map, { position, asset, isVertex }) {
  const geometry = await shapeOfAsset(asset);
  if (!geometry) return position;
  const rounding_m = (2 * EQUATOR_M) / 2 ** Math.floor(map.getZoom()) / TILE_STEPS;
  if (isVertex) {
    const [nearest] = ringsOf(geometry)
      .flat()
      .map((vertex) => ({ vertex, far: distance_m(vertex, position) }))
      .sort((a, b) => a.far - b.far);
    if (nearest && nearest.far <= rounding_m) return nearest.vertex.slice(0, 2);
  }
  return isLine(geometry) ? nearestOnLine(geometry, position) : position; // where a tile cuts a line there is no vertex
}
