/** Terrain on the map: extent of the models, the line of the profile, its points and its cursor. */

import { addSources, readToken, setFeatures, setPaint } from "../map/look/style.js";

/** @import { LayerSpecification } from "/static/lib/maplibre-gl/maplibre-gl.mjs" */
/** @import { ModelFeature } from "../api_types.d.ts" */
/** @import { MapLibreMap } from "../map/types.d.ts" */

const SOURCES = ["terrain-models", "terrain-line", "terrain-points", "terrain-cursor"];

/** @returns {LayerSpecification[]} */
function layers() {
  const [outline, casing, accent, raised, ink] = ["--outline", "--map-casing", "--accent", "--raised", "--ink"].map(
    readToken,
  );
  const isChosen = ["boolean", ["get", "chosen"], false];
  const round = { "line-cap": "round", "line-join": "round" };
  const layers = [
    {
      id: "terrain-fill",
      type: "fill",
      source: "terrain-models",
      paint: { "fill-color": ink, "fill-opacity": ["case", isChosen, 0.1, 0.035] },
    },
    {
      id: "terrain-edge",
      type: "line",
      source: "terrain-models",
      paint: {
        "line-color": ["case", isChosen, ink, outline],
        "line-width": ["case", isChosen, 2, 1.25],
        "line-dasharray": [4, 3],
      },
    },
    {
      id: "terrain-line-casing",
      type: "line",
      source: "terrain-line",
      layout: round,
      paint: { "line-color": casing, "line-width": 7 },
    },
    {
      id: "terrain-line",
      type: "line",
      source: "terrain-line",
      layout: round,
      paint: { "line-color": accent, "line-width": 3 },
    },
    {
      id: "terrain-points",
      type: "circle",
      source: "terrain-points",
      paint: { "circle-radius": 5, "circle-color": accent, "circle-stroke-color": raised, "circle-stroke-width": 2 },
    },
    {
      id: "terrain-cursor",
      type: "circle",
      source: "terrain-cursor",
      paint: { "circle-radius": 5, "circle-color": raised, "circle-stroke-color": ink, "circle-stroke-width": 2.5 },
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

/**
 * What counts on top is drawn last.
 *
 * @param {MapLibreMap} map
 * @param {Pick<ModelFeature, "id" | "geometry">[]} models
 * @param {number | null} [chosenId]
 */
export function showModels(map, models, chosenId = null) {
  setFeatures(
    map,
    "terrain-models",
    [...models].reverse().map(({ id, geometry }) => feature(geometry, { chosen: id === chosenId })),
  );
}

/** @param {MapLibreMap} map @param {number[][]} positions @param {number[][]} points */
export function showLine(map, positions, points) {
  setFeatures(
    map,
    "terrain-line",
    positions.length > 1 ? [feature({ type: "LineString", coordinates: positions })] : [],
  );
  setFeatures(
    map,
    "terrain-points",
    points.map((coordinates) => feature({ type: "Point", coordinates })),
  );
}

/** @param {MapLibreMap} map @param {number[] | null} position */
export function showCursor(map, position) {
  setFeatures(map, "terrain-cursor", position ? [feature({ type: "Point", coordinates: position })] : []);
}
