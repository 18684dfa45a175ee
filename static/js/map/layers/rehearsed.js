/** The simulated flight over the plan: dashed in ink, to distinguish it from a real flight. */

import { addSources, setFeatures, setPaint } from "../look/style.js";

/** @import { LayerSpecification } from "/static/lib/maplibre-gl/maplibre-gl.mjs" */
/** @import { Palette } from "../../domain/palette.js" */
/** @import { MapLibreMap } from "../types.d.ts" */

const SOURCE = "rehearsed";
const BEFORE = "line-labels";

/** @param {Palette} palette @returns {LayerSpecification[]} */
function layersOf(palette) {
  const joined = { "line-join": "round" };
  const layers = [
    {
      id: "rehearsed-casing",
      type: "line",
      source: SOURCE,
      layout: joined,
      paint: { "line-color": palette.casing, "line-width": 4, "line-opacity": 0.9 },
    },
    {
      id: "rehearsed",
      type: "line",
      source: SOURCE,
      layout: joined,
      paint: { "line-color": palette.ink, "line-width": 1.75, "line-dasharray": [3, 2] },
    },
  ];
  return /** @type {LayerSpecification[]} */ (layers);
}

/**
 * routes: of a track, null removes them.
 *
 * @param {MapLibreMap} map
 * @param {Palette} palette
 * @param {{ uav: number, flights: { position: number[][] }[] }[] | null} routes
 */
export function show(map, palette, routes) {
  if (!map.getSource(SOURCE)) {
    if (!routes) return;
    addSources(map, [SOURCE]);
    for (const layer of layersOf(palette)) map.addLayer(layer, map.getLayer(BEFORE) ? BEFORE : undefined);
  }
  const features = (routes ?? []).flatMap(({ uav, flights }) =>
    flights
      .filter(({ position }) => position.length > 1)
      .map(({ position }) => ({
        type: "Feature",
        properties: { uav },
        geometry: { type: "LineString", coordinates: position },
      })),
  );
  setFeatures(map, SOURCE, features);
}

/** @param {MapLibreMap} map @param {Palette} palette */
export function recolour(map, palette) {
  if (!map.getSource(SOURCE)) return;
  for (const layer of layersOf(palette)) setPaint(map, layer);
}
