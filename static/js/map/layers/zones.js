/** Zones that something on the page speaks of: a ring round each. */

import { TILES } from "../voltages.js";

const SOURCE_LAYER = "zones";
const litOn = new WeakMap(); // map → ids

/** ids: of zones; none takes the rings away. */
export function light(map, ids) {
  for (const id of litOn.get(map) ?? [])
    map.setFeatureState({ source: TILES, sourceLayer: SOURCE_LAYER, id }, { lit: false });
  for (const id of ids) map.setFeatureState({ source: TILES, sourceLayer: SOURCE_LAYER, id }, { lit: true });
  litOn.set(map, ids);
}
