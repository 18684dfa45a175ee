/** What aircraft have inspected and how long ago: bands under lines and railways, discs under towers and bridges. */

import { AGES, mixed, since_s } from "../../domain/inspection_age.js";
import { t } from "../../text.js";
import { readToken, setPaint } from "../look/style.js";

/** @import { LayerSpecification } from "/static/lib/maplibre-gl/maplibre-gl.mjs" */
/** @import { MapLibreMap, SwitchedLayer } from "../types.d.ts" */

const SOURCE = "inspections";
const UNDER = ["railways", "lines-casing"]; // the lowest layers of infrastructure

/** @returns {LayerSpecification[]} */
function layers() {
  const [accent, ground] = ["--accent", "--ground"].map(readToken);
  const colours = AGES.map((age) => mixed(age.accent, accent, ground));
  const steps = AGES.slice(0, -1).map(({ days }, index) => [since_s(days), colours[index]]);
  const colour = ["step", ["get", "inspected_s"], colours[colours.length - 1], ...steps.reverse().flat()];
  const base = { source: SOURCE, "source-layer": "inspections" };
  const layers = [
    {
      ...base,
      id: "inspections",
      type: "line",
      filter: ["!=", ["geometry-type"], "Point"],
      layout: { "line-join": "round", "line-sort-key": ["get", "inspected_s"] },
      paint: { "line-color": colour, "line-width": ["interpolate", ["linear"], ["zoom"], 5, 4, 12, 10, 17, 16] },
    },
    {
      ...base,
      id: "inspections-points",
      type: "circle",
      minzoom: 10,
      filter: ["==", ["geometry-type"], "Point"],
      layout: { "circle-sort-key": ["get", "inspected_s"] },
      paint: {
        "circle-color": colour,
        "circle-radius": ["interpolate", ["linear"], ["zoom"], 10, 3, 14, 7, 17, 10],
      },
    },
  ];
  return /** @type {LayerSpecification[]} */ (/** @type {unknown} */ (layers));
}

/**
 * The entry of the layers menu. Tiles are requested once it is switched on.
 *
 * @param {MapLibreMap} map
 * @param {Promise<unknown>} ready
 * @returns {SwitchedLayer & { recolour: () => void }}
 */
export function createInspectionsLayer(map, ready) {
  let isOn = false;

  async function draw() {
    await ready;
    if (isOn === Boolean(map.getSource(SOURCE))) return;
    if (!isOn) {
      for (const { id } of layers()) map.removeLayer(id);
      map.removeSource(SOURCE);
      return;
    }
    const tiles = [`${location.origin}/api/v1/tiles/inspections/{z}/{x}/{y}`];
    map.addSource(SOURCE, { type: "vector", tiles, minzoom: 0, maxzoom: 15 });
    const before = UNDER.find((id) => map.getLayer(id));
    for (const layer of layers()) map.addLayer(layer, before);
  }

  return {
    words: t("Last inspections"),
    isOn: () => isOn,
    turn(on) {
      isOn = on;
      void draw();
    },
    recolour() {
      if (isOn && map.getSource(SOURCE)) for (const layer of layers()) setPaint(map, layer);
    },
  };
}
