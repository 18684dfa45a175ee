/** Rings round zones that the page refers to. */

import { TILES } from "../look/voltages.js";

/** @import { MapLibreMap } from "../types.d.ts" */

const SOURCE_LAYER = "zones";
/** @type {WeakMap<MapLibreMap, number[]>} */
const litOn = new WeakMap(); // map → ids

/** ids: of zones; an empty list removes the rings. @param {MapLibreMap} map @param {number[]} ids */
export function light(map, ids) {
  for (const id of litOn.get(map) ?? [])
    map.setFeatureState({ source: TILES, sourceLayer: SOURCE_LAYER, id }, { lit: false });
  for (const id of ids) map.setFeatureState({ source: TILES, sourceLayer: SOURCE_LAYER, id }, { lit: true });
  litOn.set(map, ids);
}
