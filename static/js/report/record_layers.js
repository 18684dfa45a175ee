/** Flown over planned: measured solid, estimated dotted, and the selected leg under both. */

import { setPaint, sourceOf } from "../map/look/style.js";

/** @import { ExpressionSpecification, LineLayerSpecification } from "/static/lib/maplibre-gl/maplibre-gl.mjs" */
/** @import { Palette } from "../domain/palette.js" */
/** @import { FeatureCollection, MapLibreMap } from "../map/types.d.ts" */
/** @import { Estimate, Sample } from "../record/track.js" */
/** @import { ReplayRoute } from "./types.d.ts" */

/** @typedef {FeatureCollection["features"][number]} Feature */

const BEFORE = "line-labels";
/** @type {FeatureCollection} */
const NOTHING = { type: "FeatureCollection", features: [] };
const THIN_PX = 1.6;

/** @param {number[][]} coordinates @param {Partial<Pick<ReplayRoute, "place" | "colour">>} [of] the UAV's place and colour @returns {Feature} */
const feature = (coordinates, { place, colour } = {}) => ({
  type: "Feature",
  properties: { place, route: colour },
  geometry: { type: "LineString", coordinates },
});
/** @param {Feature[]} features @returns {FeatureCollection} */
const collection = (features) => ({ type: "FeatureCollection", features });

/** @param {Palette} palette @returns {LineLayerSpecification[]} */
function layersOf(palette) {
  /** @type {LineLayerSpecification["layout"]} */
  const round = { "line-cap": "round", "line-join": "round" };
  const [first, ...others] = palette.routes;
  /** @type {ExpressionSpecification} */
  const colour = [
    "match",
    ["get", "route"],
    1,
    first,
    ...others.flatMap((value, index) => [index + 2, value]),
    palette.inkSecond,
  ];
  return [
    {
      id: "record-leg",
      type: "line",
      source: "record-leg",
      layout: round,
      paint: { "line-color": palette.select, "line-width": 11, "line-opacity": 0.3 },
    },
    {
      id: "record-flown-casing",
      type: "line",
      source: "record-flown",
      layout: round,
      paint: { "line-color": palette.casing, "line-width": 5.6 },
    },
    {
      id: "record-flown",
      type: "line",
      source: "record-flown",
      layout: round,
      paint: { "line-color": colour, "line-width": 3.6 },
    },
    {
      id: "record-estimated",
      type: "line",
      source: "record-estimated",
      layout: round,
      paint: { "line-color": colour, "line-width": 3, "line-dasharray": [0.1, 2] },
    },
  ];
}

/** @param {MapLibreMap} map */
const thinRoutes = (map) => map.setPaintProperty("routes", "line-width", THIN_PX);

/** @param {MapLibreMap} map @param {Palette} palette */
export function addTo(map, palette) {
  for (const { source } of layersOf(palette))
    if (!map.getSource(source)) map.addSource(source, { type: "geojson", data: NOTHING });
  const before = map.getLayer(BEFORE) ? BEFORE : undefined;
  for (const layer of layersOf(palette)) map.addLayer(layer, before);
  thinRoutes(map);
}

/** @param {MapLibreMap} map @param {Palette} palette */
export function recolour(map, palette) {
  for (const layer of layersOf(palette)) setPaint(map, layer);
  thinRoutes(map);
}

/** @param {readonly (Sample | Estimate)[]} run */
const positionsOf = (run) => run.flatMap(({ position }) => (position ? [position] : []));
/** @param {readonly (readonly (Sample | Estimate)[])[]} runs @param {Pick<ReplayRoute, "place" | "colour">} route */
const linesOf = (runs, route) =>
  runs
    .map(positionsOf)
    .filter((line) => line.length > 1)
    .map((line) => feature(line, route));

/** @param {MapLibreMap} map @param {readonly Pick<ReplayRoute, "place" | "colour" | "track">[]} routes */
export function showTracks(map, routes) {
  sourceOf(map, "record-flown")?.setData(collection(routes.flatMap((route) => linesOf(route.track.measured, route))));
  sourceOf(map, "record-estimated")?.setData(
    collection(routes.flatMap((route) => linesOf(route.track.estimated, route))),
  );
}

/** @param {MapLibreMap} map @param {number[][] | null} positions of a leg */
export function lightLeg(map, positions) {
  sourceOf(map, "record-leg")?.setData(positions ? collection([feature(positions)]) : NOTHING);
}

/**
 * Highlight one UAV; null resets all.
 *
 * @param {MapLibreMap} map
 * @param {number | null} place
 * @param {number} rest opacity of the others
 */
export function lookAt(map, place, rest) {
  /** @type {number | ExpressionSpecification} */
  const opacity = place === null ? 1 : ["case", ["==", ["get", "place"], place], 1, rest];
  for (const id of ["record-flown", "record-estimated"]) map.setPaintProperty(id, "line-opacity", opacity);
}
