/** Waypoints on the map under the pointer or a finger: dragged, drawn out of the middle of a leg, chosen by a click. */

import { swallowDrawnClick } from "../../map/drawn_click.js";
import * as layer from "../../map/layers/hand_route.js";
import { inserted, isFree, moved } from "./hand_route.js";

const REACH_PX = matchMedia("(pointer: coarse)").matches ? 22 : 10;
const MOVED_PX = 4;

/** Returns { isOn(), recolour() }. */
export function mountHandMap(map, store, actions) {
  const canvas = map.getCanvasContainer();
  const click = swallowDrawnClick(canvas);
  let drag = null; // { from: px, index, points, isNew, hasMoved }

  const pointOf = (event) => {
    const box = canvas.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  };

  const stateOf = (legs, faults) => (index) => {
    if (faults.legs.has(index)) return "bad";
    if (!legs.has(index)) return "stored";
    const known = legs.get(index);
    return known === null ? "asked" : known.is_clear ? "clear" : "bad";
  };

  function draw({ hand }) {
    if (!hand) return layer.show(map, null);
    return layer.show(map, hand.dragged ?? hand.points, {
      chosen: hand.chosen,
      stateOf: stateOf(hand.legs, hand.faults),
      isFree,
    });
  }

  /** The nearest waypoint within reach, else the middle of a leg. */
  function handleAt(at) {
    const { points } = store.state.hand;
    const far = (position) => {
      const place = map.project(position);
      return Math.hypot(place.x - at.x, place.y - at.y);
    };
    const nearest = (list) =>
      list
        .map((item) => ({ ...item, far: far(item.position) }))
        .filter((item) => item.far <= REACH_PX)
        .sort((a, b) => a.far - b.far)[0];
    const free = nearest(
      points
        .map(({ position, kind }, index) => ({ position, index, isFixed: !isFree({ kind }) }))
        .filter(({ isFixed }) => !isFixed),
    );
    if (free) return { index: free.index, isNew: false };
    const middle = nearest(layer.middlesOf(map, points));
    if (middle) return { index: middle.index + 1, isNew: true };
    const fixed = nearest(points.map(({ position }, index) => ({ position, index })));
    return fixed ? { index: fixed.index, isNew: false, isFixed: true } : null;
  }

  canvas.addEventListener(
    "pointerdown",
    (event) => {
      if (!store.state.hand || event.button !== 0 || event.shiftKey || !event.isPrimary) return;
      click.begins();
      const at = pointOf(event);
      const handle = handleAt(at);
      if (!handle) return;
      event.stopPropagation();
      event.preventDefault();
      if (handle.isFixed) {
        actions.chooseByHand(handle.index);
        click.ends();
        return;
      }
      map.dragPan.disable();
      canvas.setPointerCapture(event.pointerId);
      const { points } = store.state.hand;
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
    if (!store.state.hand) return;
    const at = pointOf(event);
    if (!drag) {
      if (event.pointerType === "mouse") canvas.classList.toggle("over-thing", handleAt(at) !== null);
      return;
    }
    if (!drag.now && Math.hypot(at.x - drag.from.x, at.y - drag.from.y) < MOVED_PX) return;
    const { lng, lat } = map.unproject([at.x, at.y]);
    drag.now = moved(drag.points, drag.index, [lng, lat]);
    actions.dragByHand(drag.now, drag.index);
  });
  function end(event) {
    if (!drag) return;
    const ended = drag;
    drag = null;
    map.dragPan.enable();
    click.ends();
    if (!store.state.hand) return;
    if (event.type === "pointerup" && ended.now) actions.dropByHand(ended.now, ended.index);
    else if (event.type === "pointerup" && ended.isNew) actions.dropByHand(ended.points, ended.index);
    else if (event.type === "pointerup") actions.chooseByHand(ended.index);
    else actions.dropByHand(null);
  }
  canvas.addEventListener("pointerup", end);
  canvas.addEventListener("pointercancel", end);
  map.on("zoomend", () => store.state.hand && draw(store.state)); // more legs have room for a handle
  store.listen(["hand"], draw);

  return { isOn: () => store.state.hand !== null, recolour: () => layer.recolour(map) };
}
