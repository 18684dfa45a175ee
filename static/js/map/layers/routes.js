/** Routes: one colour per UAV, drawn on the right of the way, with arrows. */

import { ROUTE_COUNT, routeNumber } from "../../domain/palette.js";
import { routeOpacity } from "../look/page_layers.js";
import { setFeatures } from "../look/style.js";

/** @import { Palette } from "../../domain/palette.js" */
/** @import { Geometry, MapLibreMap } from "../types.d.ts" */

/** @type {[string, "line-opacity" | "icon-opacity"][]} */
const LAYERS = [
  ["routes-casing", "line-opacity"],
  ["routes", "line-opacity"],
  ["routes-dashed", "line-opacity"],
  ["routes-arrows", "icon-opacity"],
];

/**
 * routes: [{ sequence, geometry, colour }]; colour: of the UAV
 *
 * @param {MapLibreMap} map
 * @param {{ sequence: number, geometry: Geometry | null, colour?: number }[]} routes
 */
export function update(map, routes) {
  setFeatures(
    map,
    "routes",
    routes
      .filter((route) => route.geometry)
      .map((route) => ({
        type: "Feature",
        properties: {
          sequence: route.sequence,
          route: route.colour ?? routeNumber(route.sequence),
          dashed: route.sequence >= ROUTE_COUNT,
        },
        geometry: route.geometry,
      })),
  );
}

/**
 * Places where UAVs wait: [{ kind: "base" | "charging", position }].
 *
 * @param {MapLibreMap} map
 * @param {{ kind: "base" | "charging", position: number[] }[]} stops
 */
export function showStops(map, stops) {
  setFeatures(
    map,
    "route-stops",
    stops.map(({ kind, position }) => ({
      type: "Feature",
      properties: { kind },
      geometry: { type: "Point", coordinates: position },
    })),
  );
}

/**
 * The best routes of a running search: lines with the number of their UAV; null once there is a plan.
 *
 * @param {MapLibreMap} map
 * @param {{ features: { geometry: Geometry, properties: { uav: number } }[] } | null} lines
 */
export function showSoFar(map, lines) {
  setFeatures(
    map,
    "routes-so-far",
    (lines?.features ?? []).map(({ geometry, properties }) => ({
      type: "Feature",
      properties: { route: routeNumber(properties.uav) },
      geometry,
    })),
  );
}

/**
 * Highlight one route; null resets all.
 *
 * @param {MapLibreMap} map
 * @param {Palette} palette
 * @param {number | null} sequence
 */
export function lookAt(map, palette, sequence) {
  const opacity = routeOpacity(palette, sequence);
  for (const [layer, property] of LAYERS) map.setPaintProperty(layer, property, opacity);
}

/**
 * The distance at the pointer in a strip, as a dot on the map; null removes it.
 *
 * @param {MapLibreMap} map
 * @param {number[] | null} position
 */
export function showPoint(map, position) {
  setFeatures(
    map,
    "strip-point",
    position ? [{ type: "Feature", properties: {}, geometry: { type: "Point", coordinates: position } }] : [],
  );
}
