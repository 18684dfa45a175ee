/** The flown path, the place of the last report, and the ellipse of an estimate: layers between routes and labels. */

import { addSources, setPaint, sourceOf } from "../../map/look/style.js";
import { ellipseRing, metresPerPixel } from "./ellipse.js";

/** @import { Palette } from "../../domain/palette.js" */
/** @import { LayerSpecification } from "/static/lib/maplibre-gl/maplibre-gl.mjs" */
/** @import { FeatureCollection, Geometry, MapLibreMap } from "../../map/types.d.ts" */
/** @import { DrawnUav, FlownLine, OfferedRoute } from "../types.d.ts" */

/** A UAV that is estimated or lost. @typedef {Pick<DrawnUav, "colour" | "certainty" | "position" | "bound" | "last" | "words">} UncertainUav */

const BEFORE = "line-labels";
const MIN_RING_PX = 14;
const CLEAR_PX = 48;
const SOURCES = ["flown", "last-report", "ellipses", "offered"];

/** @param {Palette} palette */
const colourOf = (palette) => [
  "case",
  ["get", "isLost"],
  palette.inkSecond,
  ["match", ["get", "route"], ...palette.routes.flatMap((colour, index) => [index + 1, colour]), palette.inkSecond],
];

/** @param {Palette} palette @returns {LayerSpecification[]} */
function layersOf(palette) {
  const round = { "line-cap": "round", "line-join": "round" };
  const colour = colourOf(palette);
  const layers = [
    {
      id: "offered",
      type: "line",
      source: "offered",
      layout: round,
      paint: { "line-color": colour, "line-width": 3, "line-dasharray": [2, 2] },
    },
    {
      id: "flown-casing",
      type: "line",
      source: "flown",
      layout: round,
      paint: { "line-color": palette.casing, "line-width": 6 },
    },
    { id: "flown", type: "line", source: "flown", layout: round, paint: { "line-color": colour, "line-width": 3.6 } },
    { id: "ellipses", type: "fill", source: "ellipses", paint: { "fill-color": colour, "fill-opacity": 0.15 } },
    {
      id: "ellipses-line",
      type: "line",
      source: "ellipses",
      paint: { "line-color": colour, "line-width": 1.75, "line-dasharray": [3, 2] },
    },
    {
      id: "last-report-line",
      type: "line",
      source: "last-report",
      filter: ["==", ["geometry-type"], "LineString"],
      paint: { "line-color": colour, "line-width": 2, "line-dasharray": [2, 2] },
    },
    {
      id: "last-report",
      type: "circle",
      source: "last-report",
      filter: ["==", ["geometry-type"], "Point"],
      paint: {
        "circle-radius": 4,
        "circle-color": colour,
        "circle-stroke-color": palette.casing,
        "circle-stroke-width": 2,
      },
    },
    {
      id: "last-report-time",
      type: "symbol",
      source: "last-report",
      filter: ["==", ["geometry-type"], "Point"],
      layout: {
        "text-font": palette.fonts,
        "text-size": 11,
        "text-field": ["get", "words"],
        "text-anchor": "top",
        "text-offset": [0, 0.6],
      },
      paint: { "text-color": palette.ink, "text-halo-color": palette.halo, "text-halo-width": 2 },
    },
  ];
  return /** @type {LayerSpecification[]} */ (layers);
}

/** @param {MapLibreMap} map */
const thinRoutes = (map) => map.setPaintProperty("routes", "line-width", 1.6);

/** @param {MapLibreMap} map @param {Palette} palette */
export function addTo(map, palette) {
  addSources(map, SOURCES);
  for (const layer of layersOf(palette)) map.addLayer(layer, BEFORE);
  map.setPaintProperty("routes-casing", "line-width", 4);
  thinRoutes(map);
}

/** @param {MapLibreMap} map @param {Palette} palette */
export function recolour(map, palette) {
  for (const layer of layersOf(palette)) setPaint(map, layer);
  map.setPaintProperty("routes-casing", "line-width", 4);
  thinRoutes(map);
}

/** @param {{ colour: number | null, certainty: string }} uav @param {Geometry} geometry */
const feature = (uav, geometry, more = {}) => ({
  type: "Feature",
  properties: { route: uav.colour ?? 0, isLost: uav.certainty === "lost", ...more },
  geometry,
});
const shown = new WeakMap(); // source → key of its content

/**
 * Draw only changes: each update costs a frame of the whole map, and the clock ticks even if nothing has moved.
 *
 * @param {MapLibreMap} map
 * @param {string} name of the source
 * @param {object[]} features
 * @param {string} [key]
 */
function show(map, name, features, key = JSON.stringify(features)) {
  const source = sourceOf(map, name);
  if (!source || shown.get(source) === key) return;
  shown.set(source, key);
  source.setData(/** @type {FeatureCollection} */ ({ type: "FeatureCollection", features }));
}

/** A line of thousands of places grows at its end. @param {FlownLine[]} uavs */
const lineKey = (uavs) =>
  JSON.stringify(
    uavs.map(({ colour, parts }) => [colour, parts.length, parts.at(-1)?.length, parts.at(-1)?.at(-1), parts[0]?.[0]]),
  );

/** uavs: [{ colour, certainty, parts: [[lon lat, …], …] }] @param {MapLibreMap} map @param {FlownLine[]} uavs */
export function showFlown(map, uavs) {
  show(
    map,
    "flown",
    uavs.map((uav) =>
      feature(
        { ...uav, certainty: "measured" },
        { type: "MultiLineString", coordinates: uav.parts.filter((part) => part.length > 1) },
      ),
    ),
    lineKey(uavs),
  );
}

/**
 * Whether the last report is clear of the UAV itself; its time is left out otherwise.
 *
 * @param {MapLibreMap} map
 * @param {number[]} last
 * @param {number[]} position
 */
function isClear(map, last, position) {
  const [from, to] = [last, position].map(([longitude, latitude]) => map.project([longitude, latitude]));
  return Math.hypot(from.x - to.x, from.y - to.y) >= CLEAR_PX;
}

/**
 * uavs that are estimated or lost: [{ colour, certainty, position, bound, last: lon lat or null, words }].
 *
 * @param {MapLibreMap} map
 * @param {UncertainUav[]} uavs
 */
export function showUncertain(map, uavs) {
  const zoom = map.getZoom();
  show(
    map,
    "ellipses",
    uavs.flatMap((uav) => {
      if (!uav.bound) return [];
      const ring = ellipseRing(uav.position, uav.bound, MIN_RING_PX * metresPerPixel(zoom, uav.position[1]));
      return feature(uav, { type: "Polygon", coordinates: [ring] });
    }),
  );
  show(
    map,
    "last-report",
    uavs.flatMap((uav) => {
      const { last, position, words } = uav;
      if (!last) return [];
      return [
        feature(uav, { type: "LineString", coordinates: [last, position] }),
        feature(uav, { type: "Point", coordinates: last }, { words: isClear(map, last, position) ? words : "" }),
      ];
    }),
  );
}

/**
 * Routes of another plan that is offered: [{ colour, geometry }].
 *
 * @param {MapLibreMap} map
 * @param {OfferedRoute[]} routes
 */
export function showOffered(map, routes) {
  show(
    map,
    "offered",
    routes.map(({ colour, geometry }) => feature({ colour, certainty: "measured" }, geometry)),
  );
}
