/** The world's coasts and countries under everything, where no base map is shown: Natural Earth, made at set-up from world-atlas. */

import { staticAddress } from "../../static_address.js";
import { LAST_OUTLINE_ZOOM } from "./far_layers.js";
import { setFeatures } from "./style.js";

/** @import { MapLibreMap } from "../types.d.ts" */

const UNITS_PER_DEG = 100; // of scripts/installation/world_outline.py
const KINDS = /** @type {const} */ (["coasts", "borders"]);
const LAYERS = ["outline-coasts", "outline-borders"];

/** Positions of a line stored as its first position and steps. @param {number[]} steps */
export function positionsOf(steps) {
  const positions = [];
  for (let index = 0, x = 0, y = 0; index < steps.length; index += 2) {
    x += steps[index];
    y += steps[index + 1];
    positions.push([x / UNITS_PER_DEG, y / UNITS_PER_DEG]);
  }
  return positions;
}

/** The outline of a map, read once it is needed. @param {MapLibreMap} map @param {boolean} isOn */
export function createOutline(map, isOn) {
  let isRead = false;
  function read() {
    if (isRead || !isOn || map.getZoom() >= LAST_OUTLINE_ZOOM) return;
    isRead = true;
    void draw(map);
  }
  return {
    /** Call it once the map has its style. */
    start() {
      map.on("zoomend", read);
      read();
    },
    /** @param {boolean} next */
    turn(next) {
      isOn = next;
      for (const id of LAYERS) map.setLayoutProperty(id, "visibility", isOn ? "visible" : "none");
      read();
    },
  };
}

/** Read the outline and draw it; the map is complete without. @param {MapLibreMap} map */
async function draw(map) {
  try {
    const answer = await fetch(staticAddress("lib/world-atlas/outline.json"), { priority: "low" });
    if (!answer.ok) return;
    /** @type {Record<typeof KINDS[number], number[][]>} */
    const lines = await answer.json();
    const features = KINDS.map((kind) => ({
      type: "Feature",
      properties: { kind },
      geometry: { type: "MultiLineString", coordinates: lines[kind].map(positionsOf) },
    }));
    setFeatures(map, "outline", features);
  } catch {
    /* offline, or the page has gone */
  }
}
