/** Which assets can be inspected, over their own drawing: filled where they can, hollow where not. Only loaded features get a state. */

import { readToken, setPaint } from "../look/style.js";
import { TILES } from "../look/voltages.js";

/** @import { LayerSpecification } from "/static/lib/maplibre-gl/maplibre-gl.mjs" */
/** @import { MapLibreMap } from "../types.d.ts" */

const SOURCE_LAYERS = ["lines", "railways", "bridges", "bridge_points", "towers"];
/** @type {Record<string, number>} */
const CODE = { yes: 1, partly: 2, no: 3 };
const reach = ["coalesce", ["feature-state", "reach"], 0];
/** @param {number} yes @param {number} partly @param {number} no */
const byReach = (yes, partly, no) => ["match", reach, 1, yes, 2, partly, 3, no, 0];

/** @returns {LayerSpecification[]} */
function layers() {
  const [yes, partly, no, casing, raised] = ["--accent", "--ink-2", "--warning-mark", "--map-casing", "--raised"].map(
    readToken,
  );
  const colour = ["match", reach, 1, yes, 2, partly, 3, no, "rgba(0,0,0,0)"];
  /** @param {string} id @param {string} sourceLayer @param {number} minzoom @param {number} radius [px] */
  const dots = (id, sourceLayer, minzoom, radius) => ({
    id,
    type: "circle",
    source: TILES,
    "source-layer": sourceLayer,
    minzoom,
    paint: {
      "circle-radius": ["interpolate", ["linear"], ["zoom"], 10, radius * 0.6, 14, radius * 1.3],
      "circle-color": ["match", reach, 1, yes, 2, partly, raised],
      "circle-opacity": byReach(1, 1, 0.9),
      "circle-stroke-color": ["match", reach, 3, no, casing],
      "circle-stroke-width": byReach(1, 1, 2),
      "circle-stroke-opacity": byReach(1, 1, 1),
    },
  });
  /** @param {string} id @param {string} sourceLayer @param {number} minzoom */
  const lines = (id, sourceLayer, minzoom) => ({
    id,
    type: "line",
    source: TILES,
    "source-layer": sourceLayer,
    minzoom,
    layout: { "line-join": "round" },
    paint: {
      "line-color": colour,
      "line-width": byReach(4, 2.5, 1.5),
      "line-gap-width": byReach(0, 0, 4),
      "line-opacity": byReach(0.85, 0.85, 1),
    },
  });
  const layers = [
    lines("reach-lines", "lines", 0),
    lines("reach-railways", "railways", 8),
    lines("reach-bridges", "bridges", 10),
    dots("reach-bridge-points", "bridge_points", 10, 3),
    dots("reach-towers", "towers", 10, 4),
  ];
  return /** @type {LayerSpecification[]} */ (layers);
}

/** @type {WeakMap<MapLibreMap, Set<string>>} */
const stated = new WeakMap(); // map → Set of "layer id" that have a state

/**
 * reachabilityOf(id): "yes", "partly", "no" or "". Called again for features loaded later.
 *
 * @param {MapLibreMap} map
 * @param {(id: number) => string} reachabilityOf
 */
export function update(map, reachabilityOf) {
  if (!map.getLayer("reach-lines")) {
    const before = map.getLayer("routes-casing") ? "routes-casing" : undefined;
    for (const layer of layers()) map.addLayer(layer, before);
  }
  /** @type {Set<string>} */
  const known = stated.get(map) ?? new Set();
  stated.set(map, known);
  for (const sourceLayer of SOURCE_LAYERS) {
    for (const feature of map.querySourceFeatures(TILES, { sourceLayer })) {
      const id = Number(feature.id);
      const key = `${sourceLayer} ${id}`;
      if (known.has(key)) continue;
      known.add(key);
      map.setFeatureState({ source: TILES, sourceLayer, id }, { reach: CODE[reachabilityOf(id)] ?? 0 });
    }
  }
}

/** Before another answer is shown. @param {MapLibreMap} map */
export const forget = (map) => stated.delete(map);

/** @param {MapLibreMap} map */
export function remove(map) {
  forget(map);
  for (const { id } of layers()) if (map.getLayer(id)) map.removeLayer(id);
  for (const sourceLayer of SOURCE_LAYERS) map.removeFeatureState({ source: TILES, sourceLayer });
}

/** @param {MapLibreMap} map */
export function recolour(map) {
  for (const layer of layers()) if (map.getLayer(layer.id)) setPaint(map, layer);
}
