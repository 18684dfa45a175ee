/** A manually edited route: its points as handles, middles of its legs, and the state of each edited leg. */

import { addSources, readToken, setFeatures, setPaint } from "../look/style.js";

/** @import { LayerSpecification } from "/static/lib/maplibre-gl/maplibre-gl.mjs" */
/** @import { MapLibreMap, Position } from "../types.d.ts" */

/** @typedef {{ position: number[], isManual: boolean }} HandPoint */
/** @typedef {{ chosen: number | null, stateOf: (leg: number) => string, isFree: (point: any) => boolean }} HandLook */

const SOURCE = "hand-route";
const MIN_MIDDLE_PX = 44; // a shorter leg has no room for a handle

/** @type {HandLook} */
const NO_LOOK = { chosen: null, stateOf: () => "stored", isFree: () => false };

const touch = matchMedia("(pointer: coarse)").matches;
/** @param {string} role */
const isRole = (role) => ["==", ["get", "role"], role];

/** Small from afar, where a route has hundreds. @param {number} px */
const radius = (px) => ["case", ["get", "chosen"], touch ? 10 : 8, ["get", "fixed"], Math.min(3, px), px];

/** @returns {LayerSpecification[]} */
function layers() {
  const [ink, casing, raised, accent, critical, quiet] = [
    "--ink",
    "--map-casing",
    "--raised",
    "--accent",
    "--critical",
    "--ink-2",
  ].map(readToken);
  const round = { "line-cap": "round", "line-join": "round" };
  /** @param {string} id @param {string} state @param {object} paint */
  const leg = (id, state, paint) => ({
    id,
    type: "line",
    source: SOURCE,
    filter: ["all", isRole("leg"), ["==", ["get", "state"], state]],
    layout: round,
    paint,
  });
  const layers = [
    {
      id: "hand-casing",
      type: "line",
      source: SOURCE,
      filter: isRole("leg"),
      layout: round,
      paint: { "line-color": casing, "line-width": 7 },
    },
    leg("hand-legs", "stored", { "line-color": ink, "line-width": 2 }),
    leg("hand-clear", "clear", { "line-color": accent, "line-width": 4 }),
    leg("hand-asked", "asked", { "line-color": quiet, "line-width": 3, "line-dasharray": [1.5, 1.5] }),
    leg("hand-bad", "bad", { "line-color": critical, "line-width": 4, "line-dasharray": [2.5, 1.2] }),
    {
      id: "hand-middles",
      type: "circle",
      source: SOURCE,
      filter: isRole("middle"),
      paint: {
        "circle-radius": touch ? 6 : 4,
        "circle-color": raised,
        "circle-opacity": 0.85,
        "circle-stroke-color": ink,
        "circle-stroke-width": 1.25,
      },
    },
    {
      id: "hand-points",
      type: "circle",
      source: SOURCE,
      filter: isRole("point"),
      paint: {
        "circle-radius": ["interpolate", ["linear"], ["zoom"], 10, radius(2), 12.5, radius(touch ? 8 : 5.5)],
        "circle-color": ["case", ["get", "fixed"], ink, ["get", "manualEdit"], accent, raised],
        "circle-stroke-color": ["case", ["get", "chosen"], ink, ["get", "fixed"], raised, quiet],
        "circle-stroke-width": ["case", ["get", "chosen"], 3, 1.5],
      },
    },
  ];
  return /** @type {LayerSpecification[]} */ (layers);
}

/** @param {string} role @param {string} type @param {unknown} coordinates @param {object} rest */
const feature = (role, type, coordinates, rest) => ({
  type: "Feature",
  properties: { role, ...rest },
  geometry: { type, coordinates },
});

/**
 * points, chosen: see hand_route.js; stateOf(leg): "stored", "clear", "bad" or "asked"; isFree(point). Null points remove it.
 *
 * @param {MapLibreMap} map
 * @param {HandPoint[] | null} points
 * @param {HandLook} [look]
 */
export function show(map, points, { chosen, stateOf, isFree } = NO_LOOK) {
  if (!map.getSource(SOURCE)) {
    if (!points) return;
    addSources(map, [SOURCE]);
    for (const layer of layers()) map.addLayer(layer);
  }
  if (!points) {
    for (const { id } of layers()) map.removeLayer(id);
    map.removeSource(SOURCE);
    return;
  }
  const legs = points
    .slice(1)
    .map(({ position }, index) =>
      feature("leg", "LineString", [points[index].position, position], { state: stateOf(index) }),
    );
  const middles = middlesOf(map, points).map(({ index, position }) => feature("middle", "Point", position, { index }));
  const dots = points.map((point, index) =>
    feature("point", "Point", point.position, {
      index,
      chosen: index === chosen,
      fixed: !isFree(point),
      manualEdit: point.isManual,
    }),
  );
  const features = [...legs, ...middles, ...dots];
  setFeatures(map, SOURCE, features);
}

/**
 * Handles for new points in the middle of legs: [{ index, position }], of legs that are long enough on the screen.
 *
 * @param {MapLibreMap} map
 * @param {readonly { position: number[] }[]} points
 * @returns {{ index: number, position: number[] }[]}
 */
export function middlesOf(map, points) {
  return points.slice(1).flatMap(({ position }, index) => {
    const from = points[index].position;
    const [a, b] = [from, position].map((place) => map.project(/** @type {Position} */ (place)));
    if (Math.hypot(a.x - b.x, a.y - b.y) < MIN_MIDDLE_PX) return [];
    return [{ index, position: [(from[0] + position[0]) / 2, (from[1] + position[1]) / 2] }];
  });
}

/** @param {MapLibreMap} map */
export function recolour(map) {
  if (!map.getSource(SOURCE)) return;
  for (const layer of layers()) setPaint(map, layer);
}
