/** Where a vertex is meant to be when it comes near to what is there already: vertices first, then the sides of lines. */

import { TILES } from "../map/style.js";
import { nearestOnLine } from "../map/click_router.js";
import { get } from "../api.js";
import { distance_m } from "./measure.js";

const REACH_PX = matchMedia("(pointer: coarse)").matches ? 18 : 11;
const LAYERS = ["towers", "towers-high", "towers-ring", "lines", "lines-unknown", "railways", "bridges"];
const ROUNDING_M = 3; // tiles round positions; the asset itself has them exactly

const pathsOf = ({ type, coordinates }) =>
  ({ Point: [[coordinates]], LineString: [coordinates], MultiLineString: coordinates, Polygon: coordinates, MultiPolygon: coordinates.flat() })[type] ?? [];

const far_px = (map, position, point) => {
  const place = map.project(position);
  return Math.hypot(place.x - point.x, place.y - point.y);
};

/** { position, asset } of the nearest vertex within reach, else of the nearest place on a line; null where there is nothing. */
export function snap(map, point, { but = null } = {}) {
  const box = [[point.x - REACH_PX, point.y - REACH_PX], [point.x + REACH_PX, point.y + REACH_PX]];
  const met = map.queryRenderedFeatures(box, { layers: LAYERS.filter((id) => map.getLayer(id)) }).filter((feature) => feature.source === TILES && feature.properties.id !== but);
  let best = null;
  const offer = (position, asset, isVertex) => {
    const far = far_px(map, position, point);
    if (far > REACH_PX || (best && (best.isVertex === isVertex ? best.far <= far : best.isVertex))) return;
    best = { position, asset, isVertex, far };
  };
  for (const feature of met) {
    for (const path of pathsOf(feature.geometry)) for (const position of path) offer(position, feature.properties.id, true);
  }
  if (!best) {
    const { lng, lat } = map.unproject(point);
    for (const feature of met) {
      if (!["LineString", "MultiLineString"].includes(feature.geometry.type)) continue;
      const position = nearestOnLine(feature.geometry, [lng, lat]);
      if (position) offer(position, feature.properties.id, false);
    }
  }
  return best;
}

const shapes = new Map(); // asset id → promise of its positions

/** The asset's own vertex there, to the last digit; the position itself where none is near, or the asset cannot be had. */
export async function exact({ position, asset, isVertex }) {
  if (!isVertex) return position;
  if (!shapes.has(asset)) {
    shapes.set(
      asset,
      get(`/assets/${asset}`).then(({ data }) => pathsOf(data.geometry).flat(), () => (shapes.delete(asset), [])),
    );
  }
  const vertices = await shapes.get(asset);
  const near = vertices.map((vertex) => ({ vertex, far: distance_m(vertex, position) })).sort((a, b) => a.far - b.far)[0];
  return near && near.far < ROUNDING_M ? [near.vertex[0], near.vertex[1]] : position;
}
