/** A map on which nothing is picked: what the pointer is at is told beside it, and a click tells it to a finger. */

import { routeClicks } from "./click_router.js";
import { tipOf } from "./tips.js";

/** controls: of mountControls; tip: of createTip. */
export function showTipsOnly(map, { controls, tip }) {
  map.on("movestart", () => tip(null));
  routeClicks(map, {
    tool: () => "point",
    kinds: () => null,
    click: (thing, place) =>
      controls.click(place) ||
      (thing &&
        tip(`${thing.kind} ${thing.id}`, map.project(place), (refresh) => tipOf({ ...thing, place }, refresh), {
          soon: true,
        })),
    hover(thing, point, place) {
      controls.hover(place);
      tip(thing && !controls.isMeasuring() ? `${thing.kind} ${thing.id}` : null, point, (refresh) =>
        tipOf({ ...thing, place }, refresh),
      );
    },
    box: () => {},
    lasso: () => {},
  });
}
