/** Layers that a page adds to the map: routes, targets, picked and measured things. */

/** @import { DataDrivenPropertyValueSpecification, LayerSpecification } from "/static/lib/maplibre-gl/maplibre-gl.mjs" */
/** @import { Palette } from "../../domain/palette.js" */

/** Of a feature by its `route`, from 1; -1: critical. @param {Palette} palette */
export const routeColour = (palette) => [
  "match",
  ["get", "route"],
  -1,
  palette.critical,
  ...palette.routes.flatMap((colour, index) => [index + 1, colour]),
  palette.inkSecond,
];
/** @param {number} [more] [px] */
const routeWidth = (more = 0) => ["interpolate", ["linear"], ["zoom"], 10, 2.8 + more, 14, 4.5 + more];
const ROUTE_OFFSET = ["interpolate", ["linear"], ["zoom"], 10, 2.4, 14, 4.5]; // drive on the right
/** @param {boolean} isDashed */
const whereDashed = (isDashed) => ["==", ["get", "dashed"], isDashed];

/** @param {Palette} palette @returns {LayerSpecification[]} */
export function routeLayers(palette) {
  const base = { source: "routes", layout: { "line-cap": "round", "line-join": "round" } };
  const layers = [
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
  return /** @type {LayerSpecification[]} */ (layers);
}

/** @param {Palette} palette @returns {LayerSpecification[]} */
export function selectionLayers(palette) {
  const layers = [
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
  return /** @type {LayerSpecification[]} */ (layers);
}

/** @param {Palette} palette @returns {LayerSpecification[]} */
export function measureLayers(palette) {
  const round = { "line-cap": "round", "line-join": "round" };
  /** @param {string} role */
  const whereRole = (role) => ["==", ["get", "role"], role];
  const layers = [
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
  return /** @type {LayerSpecification[]} */ (layers);
}

/**
 * The opacity of all parts of a route, when one route is selected.
 *
 * @param {Palette} palette
 * @param {number | null} lookedAt sequence of a route
 * @returns {DataDrivenPropertyValueSpecification<number>}
 */
export function routeOpacity(palette, lookedAt) {
  return lookedAt === null ? 1 : ["case", ["==", ["get", "sequence"], lookedAt], 1, palette.isDark ? 0.42 : 0.3];
}
