/** Waypoints on the map under the pointer or a finger: dragged, inserted from the middle of a leg, chosen by a click. */

import { swallowDrawnClick } from "../../map/drawn_click.js";
import * as layer from "../../map/layers/hand_route.js";
import { inserted, isFree, moved } from "./hand_route.js";

/** @import { MapLibreMap } from "../../map/types.d.ts" */
/** @import { HandEdit, HandPoint, MissionActions, MissionStore } from "../types.d.ts" */

const REACH_PX = matchMedia("(pointer: coarse)").matches ? 22 : 10;
const MOVED_PX = 4;

/** @typedef {{ x: number, y: number }} Px */
/** @typedef {{ index: number, isNew: boolean, isFixed?: boolean }} Handle a waypoint, or with isNew the one that a leg would get */
/** @typedef {{ from: Px, index: number, points: HandPoint[], isNew: boolean, now: HandPoint[] | null }} Drag */

/** How the leg at an index is drawn. @param {HandEdit} edit @returns {(index: number) => string} */
const stateOf =
  ({ legs, faults }) =>
  (index) => {
    if (faults.legs.has(index)) return "bad";
    const known = legs.get(index);
    if (known === undefined) return "stored";
    return known === null ? "asked" : known.is_clear ? "clear" : "bad";
  };

/** @param {MapLibreMap} map @param {HandEdit | null} edit */
function draw(map, edit) {
  if (!edit) layer.show(map, null);
  else layer.show(map, edit.dragged ?? edit.points, { chosen: edit.chosen, stateOf: stateOf(edit), isFree });
}

/**
 * The nearest waypoint within reach, else the middle of a leg.
 *
 * @param {MapLibreMap} map
 * @param {HandPoint[]} points
 * @param {Px} at
 * @returns {Handle | null}
 */
function handleAt(map, points, at) {
  /** @param {{ position: number[], index: number }[]} list */
  const nearest = (list) =>
    list
      .map(({ position: [longitude, latitude], index }) => {
        const place = map.project([longitude, latitude]);
        return { index, far: Math.hypot(place.x - at.x, place.y - at.y) };
      })
      .filter(({ far }) => far <= REACH_PX)
      .sort((a, b) => a.far - b.far)[0];
  const places = points.map(({ position, kind }, index) => ({ position, index, isFixed: !isFree({ kind }) }));
  const free = nearest(places.filter(({ isFixed }) => !isFixed));
  if (free) return { index: free.index, isNew: false };
  const middle = nearest(layer.middlesOf(map, points));
  if (middle) return { index: middle.index + 1, isNew: true };
  const fixed = nearest(places);
  return fixed ? { index: fixed.index, isNew: false, isFixed: true } : null;
}

/**
 * Returns { isOn(), recolour() }.
 *
 * @param {MapLibreMap} map
 * @param {MissionStore} store
 * @param {MissionActions} actions
 */
export function mountHandMap(map, store, actions) {
  const canvas = map.getCanvasContainer();
  const click = swallowDrawnClick(canvas);
  /** @type {Drag | null} */
  let drag = null;

  /** @param {PointerEvent} event @returns {Px} */
  const pointOf = (event) => {
    const box = canvas.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  };

  canvas.addEventListener(
    "pointerdown",
    (event) => {
      const { hand: edit } = store.state;
      if (!edit || event.button !== 0 || event.shiftKey || !event.isPrimary) return;
      click.begins();
      const at = pointOf(event);
      const handle = handleAt(map, edit.points, at);
      if (!handle) return;
      event.stopPropagation();
      event.preventDefault();
      if (handle.isFixed) {
        actions.chooseManually(handle.index);
        click.ends();
        return;
      }
      map.dragPan.disable();
      canvas.setPointerCapture(event.pointerId);
      const { points } = edit;
      drag = {
        from: at,
        index: handle.index,
        points: handle.isNew ? inserted(points, handle.index - 1) : points,
        isNew: handle.isNew,
        now: null,
      };
    },
    true,
  );
  canvas.addEventListener("pointermove", (event) => {
    const { hand: edit } = store.state;
    if (!edit) return;
    const at = pointOf(event);
    if (!drag) {
      if (event.pointerType === "mouse") canvas.classList.toggle("over-thing", handleAt(map, edit.points, at) !== null);
      return;
    }
    if (!drag.now && Math.hypot(at.x - drag.from.x, at.y - drag.from.y) < MOVED_PX) return;
    const { lng, lat } = map.unproject([at.x, at.y]);
    drag.now = moved(drag.points, drag.index, [lng, lat]);
    actions.dragManually(drag.now, drag.index);
  });
  /** @param {PointerEvent} event */
  function end(event) {
    if (!drag) return;
    const ended = drag;
    drag = null;
    map.dragPan.enable();
    click.ends();
    if (!store.state.hand) return;
    if (event.type === "pointerup" && ended.now) actions.dropManually(ended.now, ended.index);
    else if (event.type === "pointerup" && ended.isNew) actions.dropManually(ended.points, ended.index);
    else if (event.type === "pointerup") actions.chooseManually(ended.index);
    else actions.dropManually(null);
  }
  canvas.addEventListener("pointerup", end);
  canvas.addEventListener("pointercancel", end);
  map.on("zoomend", () => draw(map, store.state.hand)); // more legs have room for a handle
  store.listen(["hand"], ({ hand: edit }) => draw(map, edit));

  return { isOn: () => store.state.hand !== null, recolour: () => layer.recolour(map) };
}
