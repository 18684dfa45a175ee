/** Layers that answer to clicks themselves, such as the regions' dots: nothing else is picked there. */

/** @import { MapGeoJSONFeature } from "/static/lib/maplibre-gl/maplibre-gl.mjs" */
/** @import { MapLibreMap, ScreenPoint } from "../types.d.ts" */

/** @type {Set<string>} ids of the layers */
const answering = new Set();

/**
 * Calls `act` with the feature that is clicked, and shows that it can be.
 *
 * @param {MapLibreMap} map
 * @param {string[]} layers
 * @param {(feature: MapGeoJSONFeature) => void} act
 */
export function answerClicks(map, layers, act) {
  for (const id of layers) answering.add(id);
  map.on("click", layers, ({ features }) => features?.length && act(features[0]));
  map.on("mouseenter", layers, () => {
    map.getCanvas().style.cursor = "pointer";
  });
  map.on("mouseleave", layers, () => {
    map.getCanvas().style.cursor = "";
  });
}

/** Whether a layer answers to a click there. @param {MapLibreMap} map @param {ScreenPoint} point */
export const isAnswered = (map, point) =>
  map.queryRenderedFeatures([point.x, point.y], { layers: [...answering].filter((id) => map.getLayer(id)) }).length > 0;
