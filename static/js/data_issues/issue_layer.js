/** Data issues on the map: dots for those in the list, the chosen one drawn whole, and what a repair would draw. */

import { addSources, readToken, setFeatures, setPaint } from "../map/look/style.js";

/** @import { LayerSpecification } from "/static/lib/maplibre-gl/maplibre-gl.mjs" */
/** @import { MapLibreMap, ScreenPoint } from "../map/types.d.ts" */
/** @import { Collection, DataIssue } from "./types.d.ts" */

const SOURCES = ["issues", "issue", "issue-repair"];
const DOTS = "issues-dots";
const REACH_PX = matchMedia("(pointer: coarse)").matches ? 16 : 7;

/** @param {number} far @param {number} near [px] */
const byZoom = (far, near) => ["interpolate", ["linear"], ["zoom"], 9, far, 13, near]; // keeps a hundred places of one line readable
const isPoint = ["==", ["geometry-type"], "Point"];
const isLine = ["==", ["geometry-type"], "LineString"];

/** @returns {LayerSpecification[]} */
function layers() {
  const [mark, casing, ground, accent, raised] = [
    "--warning-mark",
    "--map-casing",
    "--ground",
    "--accent",
    "--raised",
  ].map(readToken);
  const round = { "line-cap": "round", "line-join": "round" };
  const layers = [
    {
      id: DOTS,
      type: "circle",
      source: "issues",
      paint: { "circle-radius": 4, "circle-color": mark, "circle-stroke-color": casing, "circle-stroke-width": 1.5 },
    },
    {
      id: "issue-casing",
      type: "line",
      source: "issue",
      filter: isLine,
      layout: round,
      paint: { "line-color": casing, "line-width": 9 },
    },
    {
      id: "issue-line",
      type: "line",
      source: "issue",
      filter: isLine,
      paint: { "line-color": mark, "line-width": 4, "line-dasharray": [2, 1.2] },
    },
    {
      id: "issue-halo",
      type: "circle",
      source: "issue",
      filter: isPoint,
      paint: { "circle-radius": byZoom(4, 11), "circle-color": mark, "circle-opacity": 0.18 },
    },
    {
      id: "issue-places",
      type: "circle",
      source: "issue",
      filter: isPoint,
      paint: {
        "circle-radius": byZoom(1.6, 5.5),
        "circle-color": ground,
        "circle-stroke-color": mark,
        "circle-stroke-width": byZoom(1, 2.5),
      },
    },
    {
      id: "issue-repair-casing",
      type: "line",
      source: "issue-repair",
      filter: isLine,
      layout: round,
      paint: { "line-color": casing, "line-width": 6.5 },
    },
    {
      id: "issue-repair-line",
      type: "line",
      source: "issue-repair",
      filter: isLine,
      layout: round,
      paint: { "line-color": accent, "line-width": 3 },
    },
    {
      id: "issue-repair-places",
      type: "circle",
      source: "issue-repair",
      filter: isPoint,
      paint: {
        "circle-radius": byZoom(2, 5),
        "circle-color": accent,
        "circle-stroke-color": raised,
        "circle-stroke-width": byZoom(0.5, 1.5),
      },
    },
  ];
  return /** @type {LayerSpecification[]} */ (layers);
}

/** @param {MapLibreMap} map */
export function addTo(map) {
  addSources(map, SOURCES);
  for (const layer of layers()) map.addLayer(layer);
}

/** @param {MapLibreMap} map */
export function recolour(map) {
  for (const layer of layers()) setPaint(map, layer);
}

/** @param {object} geometry @param {object} [properties] */
const feature = (geometry, properties = {}) => ({ type: "Feature", properties, geometry });
/** @param {number[][]} positions */
const points = (positions) => positions.map((coordinates) => feature({ type: "Point", coordinates }));

/** @param {MapLibreMap} map @param {DataIssue[]} issues */
export function showAll(map, issues) {
  const features = issues.map((issue) =>
    feature({ type: "Point", coordinates: issue.properties.position }, { id: issue.id }),
  );
  setFeatures(map, "issues", features);
}

/**
 * The issue's own geometry, with a ring at each of its places; of a dead end also the way to the next part of the network.
 *
 * @param {MapLibreMap} map
 * @param {DataIssue | null} issue
 */
export function showIssue(map, issue) {
  const features = issue ? [feature(issue.geometry), ...points(placesOf(issue.geometry))] : [];
  const nearest = issue?.properties.details.nearest;
  if (nearest) features.unshift(feature({ type: "LineString", coordinates: [issue.properties.position, nearest] }));
  setFeatures(map, "issue", features);
}

/**
 * A FeatureCollection, or null. Lines first, so that towers stand on them.
 *
 * @param {MapLibreMap} map
 * @param {Collection | null} preview
 */
export function showRepair(map, preview) {
  const features =
    preview?.features.filter(({ geometry }) => geometry.type === "Point" || geometry.type === "LineString") ?? [];
  setFeatures(map, "issue-repair", features);
}

/** @param {MapLibreMap} map @param {number[][]} positions */
export function showPlaces(map, positions) {
  setFeatures(map, "issue-repair", points(positions));
}

/**
 * The id of the issue whose dot is within reach of a point of the screen, or null.
 *
 * @param {MapLibreMap} map
 * @param {ScreenPoint} point
 * @returns {number | null}
 */
export function issueAt(map, { x, y }) {
  if (!map.getLayer(DOTS)) return null;
  const met = map.queryRenderedFeatures(
    [
      [x - REACH_PX, y - REACH_PX],
      [x + REACH_PX, y + REACH_PX],
    ],
    { layers: [DOTS] },
  );
  /** @param {{ geometry: object }} feature */
  const away = ({ geometry }) => {
    const { coordinates } = /** @type {{ coordinates: [number, number] }} */ (geometry);
    const place = map.project(coordinates);
    return Math.hypot(place.x - x, place.y - y);
  };
  return met.sort((a, b) => away(a) - away(b))[0]?.properties.id ?? null;
}

/** @param {DataIssue["geometry"]} geometry @returns {number[][]} */
export function placesOf(geometry) {
  return geometry.type === "Point" ? [geometry.coordinates] : geometry.coordinates;
}
