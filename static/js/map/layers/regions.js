/** Names and counts of the regions at low zoom; a click brings one into view. */

import { zoomOfRegion } from "../../domain/regions.js";
import { countsText } from "../look/region_words.js";
import { setFeatures } from "../look/style.js";
import { answerClicks } from "./clicks.js";

/** @import { Box, MapLibreMap, Region } from "../types.d.ts" */

const LAYERS = ["region-dots", "region-names"];

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
  answerClicks(map, LAYERS, ({ id }) => {
    const region = regions.find((candidate) => candidate.id === id);
    if (region) show(region.extent);
  });
}
