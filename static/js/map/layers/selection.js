/** Lines that are picked as a whole, and the feature at the pointer or of a list row. */

import { setFeatures } from "../look/style.js";
import { TILES } from "../look/voltages.js";

/** @import { Geometry, MapLibreMap } from "../types.d.ts" */

/** @type {number | null} */
let lit = null; // the zone that is ringed

/** @param {Geometry[]} geometries */
const featuresOf = (geometries) => geometries.map((geometry) => ({ type: "Feature", properties: {}, geometry }));

/**
 * Picked lines; in the colour of the route that inspects them, by its number, if there is one.
 *
 * @param {MapLibreMap} map
 * @param {{ geometry: Geometry, route: number | null }[]} shapes
 */
export function update(map, shapes) {
  setFeatures(
    map,
    "picked-shapes",
    shapes.map(({ geometry, route }) => ({ type: "Feature", properties: route === null ? {} : { route }, geometry })),
  );
}

/**
 * Ring of a zone of the tiles, whose pieces end at the edges of tiles; null removes it.
 *
 * @param {MapLibreMap} map
 * @param {number | null} id
 */
export function showZone(map, id) {
  if (id === lit) return;
  /** @param {number} of */
  const zone = (of) => ({ source: TILES, sourceLayer: "zones", id: of });
  if (lit !== null) map.setFeatureState(zone(lit), { lit: false });
  if (id !== null) map.setFeatureState(zone(id), { lit: true });
  lit = id;
}

/** Geometries to ring: a point, or all pieces of a line. @param {MapLibreMap} map @param {Geometry[]} geometries */
export function showHovered(map, geometries) {
  setFeatures(map, "selection", featuresOf(geometries));
}
