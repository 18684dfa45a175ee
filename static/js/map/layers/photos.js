/** Planned photos on the map: a cone for each, along its yaw. */

import { addSources, setFeatures } from "../look/style.js";

/** @import { LayerSpecification } from "/static/lib/maplibre-gl/maplibre-gl.mjs" */
/** @import { MapLibreMap } from "../types.d.ts" */

/** @typedef {{ position: number[], yaw_deg: number }} Photo */

const PLAN_PHOTOS = "plan-photos";
const NEAREST_ZOOM = 15; // of a plan's photos: from farther away they cover one another

/**
 * @param {string} id of the layer and of its source
 * @param {number} [minzoom]
 */
export function coneLayer(id, minzoom = 0) {
  const layer = {
    id,
    type: "symbol",
    source: id,
    minzoom,
    layout: {
      "icon-image": ["case", ["get", "isChosen"], "photo-chosen", "photo"],
      "icon-size": ["case", ["get", "isChosen"], 1.5, 1],
      "icon-rotate": ["get", "yaw_deg"],
      "icon-rotation-alignment": "map",
      "icon-allow-overlap": true,
      "symbol-sort-key": ["case", ["get", "isChosen"], 1, 0],
    },
  };
  return /** @type {LayerSpecification} */ (layer);
}

/** @param {readonly Photo[]} photos @param {number | null} [chosen] its place among them */
export const conesOf = (photos, chosen = null) =>
  photos.map(({ position, yaw_deg }, number) => ({
    type: "Feature",
    properties: { number, yaw_deg, isChosen: number === chosen },
    geometry: { type: "Point", coordinates: position },
  }));

/** The photos of a plan's routes. @param {MapLibreMap} map @param {readonly Photo[]} photos */
export function showPlanPhotos(map, photos) {
  if (!map.getSource(PLAN_PHOTOS)) {
    if (!photos.length) return;
    addSources(map, [PLAN_PHOTOS]);
    map.addLayer(coneLayer(PLAN_PHOTOS, NEAREST_ZOOM));
  }
  setFeatures(map, PLAN_PHOTOS, conesOf(photos));
}
