/** Fences that UAVs keep to by themselves, as uploaded to them. */

import { addSources, readToken, setFeatures, setPaint } from "../look/style.js";

/** @import { LayerSpecification } from "/static/lib/maplibre-gl/maplibre-gl.mjs" */
/** @import { MapLibreMap } from "../types.d.ts" */

const SOURCE = "fences";

/** @returns {LayerSpecification[]} */
const layers = () => [
  {
    id: "fences",
    type: "line",
    source: SOURCE,
    paint: { "line-color": readToken("--zone"), "line-width": 2.5, "line-dasharray": [2, 1.5] },
  },
];

/** @param {MapLibreMap} map @param {number[][][]} rings lon lat, closed */
export function show(map, rings) {
  if (!map.getSource(SOURCE)) {
    addSources(map, [SOURCE]);
    for (const layer of layers()) map.addLayer(layer);
  }
  const features = rings.map((ring) => ({
    type: "Feature",
    properties: {},
    geometry: { type: "Polygon", coordinates: [ring] },
  }));
  setFeatures(map, SOURCE, features);
}

/** @param {MapLibreMap} map */
export function recolour(map) {
  if (map.getSource(SOURCE)) for (const layer of layers()) setPaint(map, layer);
}
