/** Lines that are picked as a whole, drawn once their shape is loaded, and the ring round the thing at the pointer. */

import { get } from "../../api.js";
import { routeNumber } from "../../domain/palette.js";
import { piecesOf } from "../../map/click_router.js";
import * as selectionLayer from "../../map/layers/selection.js";
import { shownPlaces } from "../plan/plan_view.js";
import { isWhole } from "../tasks.js";
import { partOfLine } from "./line_part.js";

/** @import { Answer } from "../../api.js" */
/** @import { AssetDetailFeature } from "../../api_types.d.ts" */
/** @import { Geometry, MapLibreMap, MapThing } from "../../map/types.d.ts" */
/** @import { MissionPageState, MissionStore, PickedTarget } from "../types.d.ts" */

/** @param {number[]} coordinates @returns {Geometry} */
const pointAt = (coordinates) => ({ type: "Point", coordinates });

/** @param {MapLibreMap} map @param {MissionStore} store */
export function createPickedShapes(map, store) {
  /** Asset id → geometry of assets that are picked whole; null while it is loaded. @type {Map<number, Geometry | null>} */
  const shapes = new Map();
  /** @type {MapThing | null} what the pointer is at on the map */
  let pointed = null;

  /** @param {PickedTarget[]} targets */
  async function fetchShapes(targets) {
    const lines = targets.flatMap((target) => (target.asset !== null && isWhole(target) ? target.asset : []));
    const wanted = new Set(lines.filter((asset) => !shapes.has(asset)));
    await Promise.all(
      [...wanted].map(async (asset) => {
        shapes.set(asset, null);
        try {
          const { data } = /** @type {Answer<AssetDetailFeature>} */ (await get(`/assets/${asset}`));
          shapes.set(asset, /** @type {Geometry} */ (data.geometry));
        } catch {
          shapes.delete(asset); // drawn with the next change
        }
      }),
    );
    if (wanted.size) drawShapes(store.state);
  }

  /** What of a line is picked, where its shape has been loaded. @param {PickedTarget} target */
  function shapeOf(target) {
    const shape = isWhole(target) ? (shapes.get(target.asset ?? -1) ?? null) : null;
    return shape && target.stretch ? partOfLine(shape, target.stretch) : shape;
  }

  /** @param {Pick<MissionPageState, "selection" | "plan">} state */
  function drawShapes(state) {
    const { places } = shownPlaces(state);
    selectionLayer.update(
      map,
      state.selection.targets.flatMap((target) => {
        const [geometry, place] = [shapeOf(target), places.get(target.key)];
        return geometry ? [{ geometry, route: place ? routeNumber(place.sequence) : null }] : [];
      }),
    );
  }

  /**
   * Ring the feature of the active list row or pill, else the one at the pointer.
   *
   * @param {Readonly<MissionPageState>} state
   */
  function ringHovered({ litTarget, selection, stretchFrom, caught }) {
    if (caught) {
      selectionLayer.showHovered(
        map,
        caught.chosen.map(({ centre }) => pointAt(centre)),
      );
      return;
    }
    const target = selection.targets.find(({ key }) => key === litTarget);
    const shape = target ? shapeOf(target) : null;
    const begun = stretchFrom ? [pointAt(stretchFrom.centre)] : [];
    if (shape) selectionLayer.showHovered(map, [shape]);
    else if (target?.centre) selectionLayer.showHovered(map, [pointAt(target.centre)]);
    else selectionLayer.showHovered(map, pointed ? [...begun, ...piecesOf(map, pointed)] : begun);
  }

  return {
    shapeOf,
    /** Ring the thing at the pointer; null: none. @param {MapThing | null} thing */
    point(thing) {
      if (thing !== null && thing.id === pointed?.id && thing.kind === pointed.kind) return;
      if (thing === null && pointed === null) return;
      pointed = thing;
      ringHovered(store.state);
    },
    /** Once the map has its style. */
    start() {
      store.listen(["selection", "plan"], (state) => {
        drawShapes(state);
        void fetchShapes(state.selection.targets);
      });
      store.listen(["litTarget", "selection", "stretchFrom", "caught"], ringHovered);
    },
  };
}
