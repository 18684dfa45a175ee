/** A map on which nothing is picked: the thing at the pointer is shown in a tooltip, and after a tap on touch screens. */

import { routeClicks } from "./click_router.js";
import { tipOf } from "./tips.js";

/** @import { MapControls, MapLibreMap, MapThing, Tip } from "./types.d.ts" */

/**
 * controls: of mountControls; tip: of createTip.
 *
 * @param {MapLibreMap} map
 * @param {{ controls: MapControls, tip: Tip }} parts
 */
export function showTipsOnly(map, { controls, tip }) {
  map.on("movestart", () => tip(null));
  routeClicks(map, {
    tool: () => "point",
    kinds: () => null,
    click: (thing, place) =>
      controls.click(place) ||
      (thing && tip(keyOf(thing), map.project(place), (fill) => tipOf({ ...thing, place }, fill), { soon: true })),
    hover(thing, point, place) {
      controls.hover(place);
      if (thing && !controls.isMeasuring()) tip(keyOf(thing), point, (fill) => tipOf({ ...thing, place }, fill));
      else tip(null);
    },
    box: () => {},
    lasso: () => {},
  });
}

/** @param {MapThing} thing */
const keyOf = ({ kind, id }) => `${kind} ${id}`;
