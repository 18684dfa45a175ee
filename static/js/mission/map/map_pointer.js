/** What clicks on a mission's map and the pointer over it do. */

import { h } from "../../dom.js";
import { routeClicks } from "../../map/click_router.js";
import { createTip } from "../../map/furniture.js";
import { tipOf } from "../../map/tips.js";
import { toast } from "../../page/toast.js";
import { t } from "../../text.js";
import { createMapPicking } from "./map_picking.js";

/** @import { createTargets } from "../../map/layers/targets.js" */
/** @import { MapControls, MapLibreMap, MapThing, Position, ScreenPoint } from "../../map/types.d.ts" */
/** @import { Drawn } from "../panels/temporary_zone.js" */
/** @import { MissionActions, MissionStore } from "../types.d.ts" */
/** @import { createPickedShapes } from "./picked_shapes.js" */
/** @import { mountReachLayer } from "./reach_layer.js" */

/**
 * @typedef {object} PointerContext
 * @property {MapLibreMap} map
 * @property {HTMLElement} frame
 * @property {MissionStore} store
 * @property {MissionActions} actions
 * @property {boolean} canPlan
 * @property {MapControls} controls
 * @property {ReturnType<typeof createTargets>} targets
 * @property {ReturnType<typeof createPickedShapes>} shapes
 * @property {() => ReturnType<typeof mountReachLayer> | null} reach null until the map has its style
 * @property {() => boolean} isHandOn whether a route is manually edited
 * @property {(position: number[]) => void} askForUav
 * @property {(drawn: Drawn) => unknown} askForZone
 */

/** @param {PointerContext} context */
export function mountMapPointer(context) {
  const { map, frame, store, actions, canPlan, controls, targets, shapes } = context;
  const tip = createTip(frame);
  const picking = createMapPicking({ frame, store, actions, opened: () => tip(null) });
  map.on("movestart", () => {
    picking.close();
    tip(null);
    shapes.point(null); // the feature under the pointer moves away from it
  });
  /** @param {MapThing} thing */
  const keyOf = (thing) => `${thing.kind} ${thing.id}`;

  /**
   * The text of the tooltip, with the reason why the asset can be inspected or not while that layer is shown.
   *
   * @param {MapThing} thing
   * @param {Position | null} place
   */
  const tipTextOf = (thing, place) => /** @param {(content: (Node | string)[]) => void} refresh */ (refresh) => {
    const tip = tipOf({ ...thing, place }, refresh);
    const words = thing.kind === "zone" ? "" : context.reach()?.textOf(thing.id);
    return words ? [...tip, h("div", { class: "reach-said" }, words)] : tip;
  };

  /** @param {MapThing | null} thing @param {Position} place @param {ScreenPoint} point */
  function click(thing, place, point) {
    picking.close();
    tip(null);
    if (controls.click(place)) return;
    const { tool } = store.state;
    if (tool === "rally") actions.addRallyPoint(place);
    else if (context.isHandOn()) return;
    else if (tool === "zone") context.askForZone({ centre: place });
    else if (tool === "place") context.askForUav(place.map((degrees) => Number(degrees.toFixed(6))));
    else {
      const met = tool === "stretch" ? null : targets.at(point);
      if (met) store.update({ chosenTarget: met });
      else if (thing) clickThing(thing, place, point);
      else if (canPlan)
        toast(t("Nothing to inspect here. Zoom in, or click nearer to a tower, line, railway or bridge."));
    }
  }

  /**
   * Handle a click on a thing. Touch has no hovering, so a notice states what cannot be picked or inspected.
   *
   * @param {MapThing} thing
   * @param {Position} place
   * @param {ScreenPoint} point
   */
  function clickThing(thing, place, point) {
    const isPicked = canPlan && thing.kind !== "zone";
    if (isPicked) picking.pick(thing, place, point);
    const reachability = context.reach()?.reachability(thing.id);
    if (!isPicked || reachability === "no" || reachability === "partly")
      tip(keyOf(thing), point, tipTextOf(thing, place), { soon: true });
  }

  let litHere = false; // the target that is lit is under the pointer
  /** @param {MapThing | null} thing @param {ScreenPoint | null} point @param {Position | null} place */
  function hover(thing, point, place) {
    controls.hover(place);
    const target = point && targets.at(point);
    if (target !== (store.state.litTarget ?? null) && (target || litHere)) store.update({ litTarget: target });
    litHere = Boolean(target);
    const isElsewhere = controls.isMeasuring() || target || picking.isOpen() || context.isHandOn();
    const met = isElsewhere ? null : thing;
    if (met) tip(keyOf(met), point, tipTextOf(met, place));
    else tip(null, point);
    shapes.point(met && met.kind !== "zone" ? met : null);
  }

  routeClicks(map, {
    tool: () => store.state.tool,
    kinds: picking.kinds,
    click,
    hover,
    box: (box) => {
      if (canPlan) void actions.catchBox(box);
    },
    lasso: (ring) => (store.state.tool === "zone" ? context.askForZone({ ring }) : actions.catchArea(ring)),
  });
  return picking;
}
