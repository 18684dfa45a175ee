/** The map's look as data: sources and layers in the order from below, made from the palette. */

import { t } from "../text.js";

const NOTHING = { type: "FeatureCollection", features: [] };
export const TILES = "ground-tiles";

/** Layers that a click or the pointer can meet, in the order of picking. */
export const PICKABLE = [
  "towers",
  "towers-high",
  "towers-ring",
  "bridges-fill",
  "bridges",
  "bridge-points",
  "railways",
  "lines",
  "lines-unknown",
  "zones-fill",
];

/** What the layers menu switches, and the layers behind it. */
export const GROUPS = [
  { key: "lines", layers: ["lines-casing", "lines", "lines-unknown", "line-labels"] },
  { key: "towers", layers: ["towers", "towers-high", "towers-ring", "tower-labels"] },
  { key: "railways", layers: ["railways", "railways-ties"] },
  { key: "bridges", layers: ["bridges-fill", "bridges", "bridge-points"] },
  {
    key: "zones",
    layers: [
      "zones-fill",
      "zones-hatch",
      "zones-outline",
      "zones-outline-timed",
      "zones-outline-resting",
      "zones-lit",
      "zone-labels",
    ],
  },
];

const voltage = ["coalesce", ["get", "voltage"], -1];
const byVoltage = (...values) => {
  const [unknown, under50, from50, from100, from200, from380] = values;
  return ["step", voltage, unknown, 0, under50, 50, from50, 100, from100, 200, from200, 380, from380];
};
/** Bands of voltage by their least kV, and the one of a feature. */
export const BANDS = ["380", "200", "100", "50", "0", "none"];
export const bandOf = byVoltage("none", "0", "50", "100", "200", "380");
export const voltageBand = (voltage_kv) =>
  voltage_kv === undefined || voltage_kv === null ? "none" : BANDS.find((band) => voltage_kv >= Number(band));
const whereResting = (yes, no) => ["case", ["boolean", ["feature-state", "resting"], false], yes, no]; // a zone that its schedule does not put in force now
const isTimed = ["has", "schedule"];
const WIDTHS_PX = [1.2, 0.8, 1.1, 1.6, 2.2, 3]; // at zoom 12: not stated, under 50, 50, 100, 200, 380 kV and over
const widthsTimes = (factor, more = 0) => byVoltage(...WIDTHS_PX.map((width) => width * factor + more));
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
const NEAR_ZOOM = 13; // zone names stand from here on, however small the zone
const isPole = ["==", ["get", "subtype"], "pole"];

/** Colour of a voltage in kV, for the legend and the tests. */
export function voltageColour(palette, voltage_kv) {
  if (voltage_kv === null || voltage_kv === undefined) return palette.voltUnknown;
  const steps = [
    [380, "volt400"],
    [200, "volt220"],
    [100, "volt132"],
    [50, "volt66"],
  ];
  return palette[steps.find(([least]) => voltage_kv >= least)?.[1] ?? "volt20"];
}

const routeColour = (palette) => [
  "match",
  ["get", "route"],
  -1,
  palette.critical,
  ...palette.routes.flatMap((colour, index) => [index + 1, colour]),
  palette.inkSecond,
];
const routeWidth = (more = 0) => ["interpolate", ["linear"], ["zoom"], 10, 2.8 + more, 14, 4.5 + more];
const ROUTE_OFFSET = ["interpolate", ["linear"], ["zoom"], 10, 2.4, 14, 4.5]; // drive on the right
const whereDashed = (isDashed) => ["==", ["get", "dashed"], isDashed];

function rasterSource(layer) {
  return { type: "raster", tiles: [layer.tiles], tileSize: 256, maxzoom: 19 };
}

function rasterLayer(id, palette, visible) {
  return {
    id,
    type: "raster",
    source: id,
    layout: { visibility: visible ? "visible" : "none" },
    paint: {
      "raster-opacity": id === "satellite" ? 0.85 : 0.6,
      "raster-saturation": id === "satellite" ? -0.2 : -0.6,
      "raster-brightness-max": palette.isDark ? 0.45 : 1,
      "raster-fade-duration": 120,
    },
  };
}

/** options: { tilesAddress, baseMap, satellite, under: "base-map" | "satellite" | "" } */
export function mapStyle(palette, options) {
  const raster = [
    ["base-map", options.baseMap],
    ["satellite", options.satellite],
  ].filter(([, layer]) => layer?.tiles);
  return {
    version: 8,
    sources: {
      ...Object.fromEntries(raster.map(([id, layer]) => [id, rasterSource(layer)])),
      graticule: { type: "geojson", data: NOTHING },
      [TILES]: { type: "vector", tiles: [options.tilesAddress], minzoom: 0, maxzoom: 15 },
      "picked-shapes": { type: "geojson", data: NOTHING },
      routes: { type: "geojson", data: NOTHING },
      "route-stops": { type: "geojson", data: NOTHING },
      "routes-so-far": { type: "geojson", data: NOTHING },
      "strip-point": { type: "geojson", data: NOTHING },
      "many-targets": { type: "geojson", data: NOTHING },
      selection: { type: "geojson", data: NOTHING },
      measure: { type: "geojson", data: NOTHING },
    },
    layers: [
      { id: "ground", type: "background", paint: { "background-color": palette.ground } },
      ...raster.map(([id]) => rasterLayer(id, palette, options.under === id)),
      {
        id: "graticule",
        type: "line",
        source: "graticule",
        paint: { "line-color": palette.graticule, "line-width": 1 },
      },
      ...infrastructureLayers(palette),
      ...routeLayers(palette),
      ...labelLayers(palette),
      ...selectionLayers(palette),
      ...measureLayers(palette),
    ],
  };
}

function infrastructureLayers(palette) {
  const tiles = (id, type, sourceLayer, rest) => ({ id, type, source: TILES, "source-layer": sourceLayer, ...rest });
  const round = { "line-cap": "round", "line-join": "round" };
  const towerDot = { "circle-color": palette.tower, "circle-radius": 1.2 };
  const isTower = ["!", isPole]; // a pole would be too small to see, and what is not drawn cannot be clicked
  const lineColour = byVoltage(
    palette.voltUnknown,
    palette.volt20,
    palette.volt66,
    palette.volt132,
    palette.volt220,
    palette.volt400,
  );
  return [
    tiles("zones-fill", "fill", "zones", {
      paint: { "fill-color": palette.zone, "fill-opacity": palette.isDark ? 0.08 : 0.07 },
    }),
    tiles("zones-hatch", "fill", "zones", {
      paint: { "fill-pattern": ["case", isTimed, "hatch-timed", "hatch"], "fill-opacity": whereResting(0, 0.75) },
    }),
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
    tiles("lines-casing", "line", "lines", {
      minzoom: 11,
      layout: round,
      paint: { "line-color": palette.casing, "line-width": lineWidth(2), "line-opacity": 0.7 },
    }),
    tiles("lines-unknown", "line", "lines", {
      filter: ["!", ["has", "voltage"]],
      paint: { "line-color": palette.voltUnknown, "line-width": lineWidth(), "line-dasharray": [4, 2] },
    }),
    tiles("lines", "line", "lines", {
      filter: ["has", "voltage"],
      layout: round,
      paint: { "line-color": lineColour, "line-width": lineWidth() },
    }),
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
      paint: { "line-color": palette.select, "line-width": 1.75, "line-gap-width": 7 },
    },
  ];
}

function routeLayers(palette) {
  const base = { source: "routes", layout: { "line-cap": "round", "line-join": "round" } };
  return [
    {
      ...base,
      id: "routes-casing",
      type: "line",
      paint: { "line-color": palette.casing, "line-width": routeWidth(4), "line-offset": ROUTE_OFFSET },
    },
    {
      ...base,
      id: "routes",
      type: "line",
      filter: whereDashed(false),
      paint: { "line-color": routeColour(palette), "line-width": routeWidth(), "line-offset": ROUTE_OFFSET },
    },
    {
      ...base,
      id: "routes-dashed",
      type: "line",
      filter: whereDashed(true),
      layout: { "line-join": "round" },
      paint: {
        "line-color": routeColour(palette),
        "line-width": routeWidth(),
        "line-offset": ROUTE_OFFSET,
        "line-dasharray": [6, 2],
      },
    },
    {
      id: "routes-so-far",
      type: "line",
      source: "routes-so-far",
      layout: { "line-join": "round" },
      paint: {
        "line-color": routeColour(palette),
        "line-width": routeWidth(-0.8),
        "line-offset": ROUTE_OFFSET,
        "line-opacity": 0.8,
        "line-dasharray": [2, 1.5],
      },
    },
    {
      id: "routes-arrows",
      type: "symbol",
      source: "routes",
      layout: {
        "symbol-placement": "line",
        "symbol-spacing": 120,
        "icon-image": ["concat", "arrow-", ["to-string", ["get", "route"]]],
        "icon-offset": [0, 4],
        "icon-allow-overlap": true,
        "icon-rotation-alignment": "map",
      },
    },
    {
      id: "route-stops",
      type: "symbol",
      source: "route-stops",
      layout: { "icon-image": ["concat", "stop-", ["get", "kind"]], "icon-allow-overlap": true },
    },
    {
      id: "strip-point",
      type: "circle",
      source: "strip-point",
      paint: {
        "circle-radius": 5,
        "circle-color": palette.raised,
        "circle-stroke-color": palette.ink,
        "circle-stroke-width": 2,
      },
    },
  ];
}

/** The opacity of everything that belongs to a route, when one of them is looked at. */
export function routeOpacity(palette, lookedAt) {
  return lookedAt === null ? 1 : ["case", ["==", ["get", "sequence"], lookedAt], 1, palette.isDark ? 0.42 : 0.3];
}

const zoneName = ["coalesce", ["get", "name"], ["get", "label"], ""];
const zoneWidth_px = ["*", ["coalesce", ["get", "width_deg"], 0], 512 / 360, ["^", 2, ["zoom"]]];
const zoneNameWidth_px = ["min", 100, ["*", 6.5, ["length", zoneName]]]; // longer names are broken

function labelLayers(palette) {
  const halo = { "text-color": palette.label, "text-halo-color": palette.halo, "text-halo-width": 2 };
  const text = (size = 11) => ({ "text-font": palette.fonts, "text-size": size });
  const tiles = { type: "symbol", source: TILES };
  return [
    {
      ...tiles,
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
      ...tiles,
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
      ...tiles,
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
}

function selectionLayers(palette) {
  return [
    {
      id: "many-targets",
      type: "circle",
      source: "many-targets",
      paint: {
        "circle-radius": 7,
        "circle-color": palette.raised,
        "circle-stroke-width": 2,
        "circle-stroke-color": routeColour(palette),
      },
    },
    {
      id: "many-targets-labels",
      type: "symbol",
      source: "many-targets",
      minzoom: 11,
      layout: { "text-font": palette.fonts, "text-size": 11, "text-field": ["get", "label"], "text-offset": [0, 1.3] },
      paint: { "text-color": palette.ink, "text-halo-color": palette.halo, "text-halo-width": 1.5 },
    },
    {
      id: "selection",
      type: "circle",
      source: "selection",
      filter: ["==", ["geometry-type"], "Point"],
      paint: {
        "circle-radius": 8,
        "circle-opacity": 0,
        "circle-stroke-color": palette.select,
        "circle-stroke-width": 2,
      },
    },
    {
      id: "selection-line",
      type: "line",
      source: "selection",
      filter: ["!=", ["geometry-type"], "Point"],
      layout: { "line-join": "round" }, // no caps: the pieces of a line overlap at the edges of tiles
      paint: { "line-color": palette.select, "line-width": 2, "line-gap-width": 6 },
    },
  ];
}

function measureLayers(palette) {
  const round = { "line-cap": "round", "line-join": "round" };
  const whereRole = (role) => ["==", ["get", "role"], role];
  return [
    {
      id: "measure-casing",
      type: "line",
      source: "measure",
      filter: whereRole("path"),
      layout: round,
      paint: { "line-color": palette.casing, "line-width": 5.5 },
    },
    {
      id: "measure-path",
      type: "line",
      source: "measure",
      filter: whereRole("path"),
      layout: round,
      paint: { "line-color": palette.ink, "line-width": 2 },
    },
    {
      id: "measure-next",
      type: "line",
      source: "measure",
      filter: whereRole("next"),
      paint: { "line-color": palette.ink, "line-width": 1.5, "line-dasharray": [3, 2] },
    },
    {
      id: "measure-points",
      type: "circle",
      source: "measure",
      filter: whereRole("point"),
      paint: {
        "circle-radius": 4,
        "circle-color": palette.raised,
        "circle-stroke-color": palette.ink,
        "circle-stroke-width": 2,
      },
    },
    {
      id: "measure-labels",
      type: "symbol",
      source: "measure",
      filter: whereRole("point"),
      layout: {
        "text-font": palette.fonts,
        "text-size": 12,
        "text-field": ["get", "label"],
        "text-anchor": "bottom",
        "text-offset": [0, -0.7],
        "text-allow-overlap": true,
      },
      paint: { "text-color": palette.ink, "text-halo-color": palette.halo, "text-halo-width": 2 },
    },
  ];
}

/** Gives each layer of a living map the colours of another palette. */
export function repaint(map, palette, options) {
  for (const layer of mapStyle(palette, options).layers) {
    if (!map.getLayer(layer.id)) continue;
    for (const [name, value] of Object.entries(layer.paint ?? {})) map.setPaintProperty(layer.id, name, value);
  }
}
