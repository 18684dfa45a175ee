/** Routes: one colour per UAV, drawn on the right of the way, with arrows. */

import { ROUTE_COUNT, routeNumber } from "../../domain/palette.js";
import { routeOpacity } from "../page_layers.js";

const LAYERS = {
  "routes-casing": "line-opacity",
  routes: "line-opacity",
  "routes-dashed": "line-opacity",
  "routes-arrows": "icon-opacity",
};

/** routes: [{ sequence, geometry }] */
export function update(map, routes) {
  map.getSource("routes").setData({
    type: "FeatureCollection",
    features: routes
      .filter((route) => route.geometry)
      .map((route) => ({
        type: "Feature",
        properties: {
          sequence: route.sequence,
          route: routeNumber(route.sequence),
          dashed: route.sequence >= ROUTE_COUNT,
        },
        geometry: route.geometry,
      })),
  });
}

/** Places where UAVs wait: [{ kind: "base" | "charging", position }]. */
export function showStops(map, stops) {
  map.getSource("route-stops").setData({
    type: "FeatureCollection",
    features: stops.map(({ kind, position }) => ({
      type: "Feature",
      properties: { kind },
      geometry: { type: "Point", coordinates: position },
    })),
  });
}

/** The best routes of a search that goes on: lines with the number of their UAV; null once there is a plan. */
export function showSoFar(map, lines) {
  map.getSource("routes-so-far").setData({
    type: "FeatureCollection",
    features: (lines?.features ?? []).map(({ geometry, properties }) => ({
      type: "Feature",
      properties: { route: routeNumber(properties.uav) },
      geometry,
    })),
  });
}

/** Brings one route forward; null gives all of them back. */
export function lookAt(map, palette, sequence) {
  const opacity = routeOpacity(palette, sequence);
  for (const [layer, property] of Object.entries(LAYERS)) map.setPaintProperty(layer, property, opacity);
}

/** The distance that the pointer shows in a strip, as a dot on the map; null takes it away. */
export function showPoint(map, position) {
  map.getSource("strip-point")?.setData({
    type: "FeatureCollection",
    features: position ? [{ type: "Feature", properties: {}, geometry: { type: "Point", coordinates: position } }] : [],
  });
}
