/** Layers of the far view: coasts and countries, regions as dots with names, and numbers of the assets that are drawn from nearer. */

import { TILES } from "./voltages.js";

/** @import { LayerSpecification } from "/static/lib/maplibre-gl/maplibre-gl.mjs" */
/** @import { Palette } from "../../domain/palette.js" */

const LAST_COUNT_ZOOM = 8; // from here on lines of all but the lowest voltages and railways are drawn
export const LAST_OUTLINE_ZOOM = 10; // nearer the outline is too coarse
const isSmall = [">", ["get", "until"], ["zoom"]];
const number = ["number-format", ["get", "count"], { "max-fraction-digits": 0 }];

/** @param {Palette} palette @param {boolean} isShown @returns {LayerSpecification[]} */
export function outlineLayers(palette, isShown) {
  /** @param {string} kind @param {object} paint */
  const line = (kind, paint) => ({
    id: `outline-${kind}`,
    type: "line",
    source: "outline",
    maxzoom: LAST_OUTLINE_ZOOM,
    filter: ["==", ["get", "kind"], kind],
    layout: { visibility: isShown ? "visible" : "none", "line-join": "round" },
    paint: { "line-color": palette.outline, ...paint },
  });
  const layers = [
    line("coasts", { "line-width": ["interpolate", ["linear"], ["zoom"], 2, 0.8, 6, 1.4] }),
    line("borders", { "line-width": 0.8, "line-dasharray": [4, 3] }),
  ];
  return /** @type {LayerSpecification[]} */ (layers);
}

/** @param {Palette} palette @returns {LayerSpecification[]} */
export function regionLayers(palette) {
  const layers = [
    {
      id: "region-dots",
      type: "circle",
      source: "regions",
      filter: isSmall,
      paint: {
        "circle-color": palette.tower,
        "circle-radius": 5,
        "circle-stroke-color": palette.casing,
        "circle-stroke-width": 2,
      },
    },
    {
      id: "region-names",
      type: "symbol",
      source: "regions",
      filter: isSmall,
      layout: {
        "text-font": palette.fonts,
        "text-field": ["format", ["get", "name"], {}, "\n", {}, ["get", "counts"], { "font-scale": 0.85 }],
        "text-size": 13,
        "text-variable-anchor": ["top", "bottom", "left", "right"],
        "text-radial-offset": 0.8,
        "text-max-width": 14,
        "text-justify": "auto",
      },
      paint: { "text-color": palette.ink, "text-halo-color": palette.halo, "text-halo-width": 2 },
    },
  ];
  return /** @type {LayerSpecification[]} */ (layers);
}

/** @param {Palette} palette @returns {LayerSpecification[]} */
export function countLayers(palette) {
  const counts = { source: TILES, "source-layer": "counts", maxzoom: LAST_COUNT_ZOOM };
  const layers = [
    {
      ...counts,
      id: "count-discs",
      type: "circle",
      paint: {
        "circle-color": palette.casing,
        "circle-opacity": 0.85,
        "circle-stroke-color": palette.voltUnknown,
        "circle-stroke-width": 1,
        "circle-radius": ["interpolate", ["linear"], ["log10", ["get", "count"]], 0, 9, 3, 17, 5, 24],
      },
    },
    {
      ...counts,
      id: "count-numbers",
      type: "symbol",
      layout: { "text-font": palette.fonts, "text-field": number, "text-size": 11, "text-allow-overlap": true },
      paint: { "text-color": palette.label },
    },
  ];
  return /** @type {LayerSpecification[]} */ (layers);
}
