/** Layers of the infrastructure and the zones, from the vector tiles. */

import { t } from "../../text.js";
import { routeColour } from "./page_layers.js";
import { bandsOf, TILES, voltage } from "./voltages.js";

/** @import { LayerSpecification } from "/static/lib/maplibre-gl/maplibre-gl.mjs" */
/** @import { Palette } from "../../domain/palette.js" */

/** @param {number} yes @param {number} no */
const whereResting = (yes, no) => ["case", ["boolean", ["feature-state", "resting"], false], yes, no]; // a zone that is out of force now by its schedule
const isTimed = ["has", "schedule"];
const WIDTHS_PX = [1.2, 0.8, 1.1, 1.6, 2.2, 3]; // at zoom 12: not stated, under 50, 50, 100, 200, 380 kV and over
/** @param {number} factor @param {number} [more] */
const widthsTimes = (factor, more = 0) => bandsOf(...WIDTHS_PX.map((width) => width * factor + more));
/** @param {number} [more] [px] */
const lineWidth = (more = 0) => [
  "interpolate",
  ["linear"],
  ["zoom"],
  5,
  widthsTimes(0.5, more),
  9,
  widthsTimes(0.75, more),
  12,
  widthsTimes(1, more),
  17,
  widthsTimes(1.7, more),
];
const NEAR_ZOOM = 13; // zone names are shown from here on, for zones of any size
const isPole = ["==", ["get", "subtype"], "pole"];

/**
 * A layer of the vector tiles.
 *
 * @param {string} id
 * @param {string} type
 * @param {string} sourceLayer
 * @param {object} rest
 */
const tiles = (id, type, sourceLayer, rest) => ({ id, type, source: TILES, "source-layer": sourceLayer, ...rest });
const ROUND = { "line-cap": "round", "line-join": "round" };

/** The insides of zones. @param {Palette} palette */
function zoneFills(palette) {
  return [
    tiles("zones-fill", "fill", "zones", {
      paint: { "fill-color": palette.zone, "fill-opacity": palette.isDark ? 0.08 : 0.07 },
    }),
    tiles("zones-hatch", "fill", "zones", {
      paint: { "fill-pattern": ["case", isTimed, "hatch-timed", "hatch"], "fill-opacity": whereResting(0, 0.75) },
    }),
  ];
}

/** Railways and bridges. @param {Palette} palette */
function transportLayers(palette) {
  return [
    tiles("railways", "line", "railways", {
      minzoom: 8,
      paint: {
        "line-color": palette.railway,
        "line-width": ["interpolate", ["linear"], ["zoom"], 8, 1, 12, 1.8, 15, 2.6],
      },
    }),
    tiles("railways-ties", "line", "railways", {
      minzoom: 12,
      paint: {
        "line-color": palette.ground,
        "line-width": ["interpolate", ["linear"], ["zoom"], 12, 0.8, 15, 1.4],
        "line-dasharray": [5, 5],
      },
    }),
    tiles("bridges-fill", "fill", "bridges", {
      minzoom: 13,
      paint: { "fill-color": palette.bridge, "fill-opacity": 0.14 },
    }),
    tiles("bridges", "line", "bridges", {
      minzoom: 10,
      paint: {
        "line-color": palette.bridge,
        "line-width": ["interpolate", ["linear"], ["zoom"], 10.5, 2.4, 13, 2.4, 15, 1.5],
      },
    }),
    tiles("bridge-points", "circle", "bridge_points", {
      minzoom: 10,
      maxzoom: 13,
      paint: {
        "circle-color": palette.bridge,
        "circle-radius": ["interpolate", ["linear"], ["zoom"], 10, 1.4, 13, 2.6],
      },
    }),
  ];
}

/** Power lines. @param {Palette} palette */
function lineLayers(palette) {
  const lineColour = bandsOf(
    palette.voltUnknown,
    palette.volt20,
    palette.volt66,
    palette.volt132,
    palette.volt220,
    palette.volt400,
  );
  return [
    tiles("lines-casing", "line", "lines", {
      minzoom: 11,
      layout: ROUND,
      paint: { "line-color": palette.casing, "line-width": lineWidth(2), "line-opacity": 0.7 },
    }),
    tiles("lines-unknown", "line", "lines", {
      filter: ["!", ["has", "voltage"]],
      paint: { "line-color": palette.voltUnknown, "line-width": lineWidth(), "line-dasharray": [4, 2] },
    }),
    tiles("lines", "line", "lines", {
      filter: ["has", "voltage"],
      layout: ROUND,
      paint: { "line-color": lineColour, "line-width": lineWidth() },
    }),
  ];
}

/** Towers and poles. @param {Palette} palette */
function towerLayers(palette) {
  const towerDot = { "circle-color": palette.tower, "circle-radius": 1.2 };
  const isTower = ["!", isPole]; // a pole would be too small to see, and hidden features cannot be clicked
  return [
    tiles("towers-high", "circle", "towers", {
      minzoom: 10,
      maxzoom: 10.6,
      filter: ["all", isTower, [">=", voltage, 200]],
      paint: towerDot,
    }),
    tiles("towers", "circle", "towers", { minzoom: 10.6, maxzoom: 12.6, filter: isTower, paint: towerDot }),
    tiles("towers-ring", "circle", "towers", {
      minzoom: 12.6,
      paint: {
        "circle-color": palette.ground,
        "circle-radius": [
          "interpolate",
          ["linear"],
          ["zoom"],
          12.6,
          ["case", isPole, 1.6, 2.4],
          14,
          ["case", isPole, 2.1, 2.8],
          17,
          ["case", isPole, 3, 4],
        ],
        "circle-stroke-color": palette.tower,
        "circle-stroke-width": ["case", isPole, 1, 1.4],
      },
    }),
  ];
}

/** Outlines of zones, and the rings round picked features. @param {Palette} palette */
function outlineLayers(palette) {
  return [
    tiles("zones-outline", "line", "zones", {
      filter: ["!", isTimed],
      paint: { "line-color": palette.zone, "line-width": 1.75, "line-opacity": whereResting(0, 1) },
    }),
    tiles("zones-outline-timed", "line", "zones", {
      filter: isTimed,
      paint: {
        "line-color": palette.zone,
        "line-width": 2,
        "line-dasharray": [6, 1.5, 1, 1.5],
        "line-opacity": whereResting(0, 1),
      },
    }),
    tiles("zones-outline-resting", "line", "zones", {
      paint: {
        "line-color": palette.zone,
        "line-width": 1.5,
        "line-dasharray": [5, 4],
        "line-opacity": whereResting(1, 0),
      },
    }),
    tiles("zones-lit", "line", "zones", {
      layout: { "line-join": "round" },
      paint: {
        "line-color": palette.select,
        "line-width": 2,
        "line-gap-width": 6,
        "line-opacity": ["case", ["boolean", ["feature-state", "lit"], false], 1, 0],
      },
    }),
    {
      id: "picked-shapes",
      type: "line",
      source: "picked-shapes",
      layout: { "line-cap": "round", "line-join": "round" },
      paint: {
        "line-color": ["case", ["has", "route"], routeColour(palette), palette.select],
        "line-width": ["case", ["has", "route"], 2.5, 1.75],
        "line-gap-width": ["case", ["has", "route"], 11, 7],
        "line-opacity": ["case", ["has", "route"], 0.65, 1],
      },
    },
  ];
}

/** From below. @param {Palette} palette @returns {LayerSpecification[]} */
export function infrastructureLayers(palette) {
  const layers = [
    ...zoneFills(palette),
    ...transportLayers(palette),
    ...lineLayers(palette),
    ...towerLayers(palette),
    ...outlineLayers(palette),
  ];
  return /** @type {LayerSpecification[]} */ (layers);
}

const zoneName = ["coalesce", ["get", "name"], ["get", "label"], ""];
const zoneWidth_px = ["*", ["coalesce", ["get", "width_deg"], 0], 512 / 360, ["^", 2, ["zoom"]]];
const zoneNameWidth_px = ["min", 100, ["*", 6.5, ["length", zoneName]]]; // longer names are broken

/** @param {Palette} palette @returns {LayerSpecification[]} */
export function labelLayers(palette) {
  const halo = { "text-color": palette.label, "text-halo-color": palette.halo, "text-halo-width": 2 };
  /** @param {number} [size] [px] */
  const text = (size = 11) => ({ "text-font": palette.fonts, "text-size": size });
  const symbols = { type: "symbol", source: TILES };
  const layers = [
    {
      ...symbols,
      id: "line-labels",
      "source-layer": "lines",
      minzoom: 11,
      filter: ["has", "voltage"],
      layout: {
        ...text(),
        "symbol-placement": "line",
        "symbol-spacing": 340,
        "text-field": ["concat", ["to-string", ["get", "voltage"]], " kV"],
      },
      paint: halo,
    },
    {
      ...symbols,
      id: "tower-labels",
      "source-layer": "towers",
      minzoom: 14,
      filter: ["all", ["has", "ref"], ["!=", ["get", "ref"], ""]],
      layout: {
        ...text(),
        "text-field": ["get", "ref"],
        "text-anchor": "left",
        "text-offset": [0.8, 0],
        "text-optional": true,
      },
      paint: halo,
    },
    {
      ...symbols,
      id: "zone-labels",
      "source-layer": "zone_labels",
      minzoom: 9,
      filter: ["any", [">=", ["zoom"], NEAR_ZOOM], [">=", zoneWidth_px, zoneNameWidth_px]],
      layout: {
        ...text(12),
        "text-field": ["case", isTimed, ["concat", zoneName, "\n", t("at times")], zoneName],
        "text-max-width": 9,
      },
      paint: { ...halo, "text-color": palette.zone },
    },
  ];
  return /** @type {LayerSpecification[]} */ (layers);
}
