/** Names and counts of the regions at low zoom; a click brings one into view. */

import { zoomOfRegion } from "../../domain/regions.js";
import { countsText } from "../look/region_words.js";
import { setFeatures } from "../look/style.js";

/** @import { Box, MapLibreMap, Region, ScreenPoint } from "../types.d.ts" */

const LAYERS = ["region-dots", "region-names"];

/** Whether a region's dot or name is there: a click brings the region into view, and does nothing else. @param {MapLibreMap} map @param {ScreenPoint} point */
export const isAt = (map, point) =>
  map.queryRenderedFeatures([point.x, point.y], { layers: LAYERS.filter((id) => map.getLayer(id)) }).length > 0;

/** @param {readonly Region[]} regions */
export const featuresOf = (regions) =>
  regions.map(({ id, name, extent, counts }) => ({
    type: "Feature",
    id,
    properties: { name, counts: countsText(counts), until: zoomOfRegion(extent) },
    geometry: { type: "Point", coordinates: [(extent[0] + extent[2]) / 2, (extent[1] + extent[3]) / 2] },
  }));

/**
 * @param {MapLibreMap} map
 * @param {readonly Region[]} regions
 * @param {(box: Box) => void} show
 */
export function addTo(map, regions, show) {
  setFeatures(map, "regions", featuresOf(regions));
  map.on("click", LAYERS, ({ features }) => {
    const region = regions.find(({ id }) => id === features?.[0]?.id);
    if (region) show(region.extent);
  });
  map.on("mouseenter", LAYERS, () => {
    map.getCanvas().style.cursor = "pointer";
  });
  map.on("mouseleave", LAYERS, () => {
    map.getCanvas().style.cursor = "";
  });
}
