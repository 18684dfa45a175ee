/** Drawing and editing one shape on the map, with pointer, touch and keys. What a click means is decided in drawing.js. */

import { beside } from "../domain/geodesy.js";
import * as drawings from "./drawing.js";
import { createSteps } from "./history.js";
import { addTo, handlesOf, recolour, show, showNext, showSnap } from "./layers.js";
import * as shapes from "./shape.js";
import { exact, forgetShapes, snap } from "./snapping.js";
import { faultsOf } from "./validity.js";

const REACH_PX = matchMedia("(pointer: coarse)").matches ? 22 : 9; // on touch the target is 44 px wide
const MOVED_PX = 4;
const LONG_PRESS_MS = 550;
const RANK = { vertex: 0, radius: 1, middle: 2 };

/**
 * onChange(state) is told after each step: { shape, faults, chosen, isDrawing, isMoving, canUndo, canRedo }; onPreview(shape) what the
 * shape would be if the pointer were clicked. Returns the editor: start(shape, { without }), stop(), and what buttons and keys call.
 * `without` is the asset that is edited: it does not snap to itself.
 */
export function createEditor(map, { onChange, onPreview = () => {} }) {
  const canvas = map.getCanvasContainer();
  const fingers = new Set();
  let steps = null; // of drawings: { shape, growing }
  let chosen = null;
  let isMoving = false; // the whole shape, not its vertices
  let pointer = null; // where the next vertex would be
  let drag = null;
  let but = null;

  const isActive = () => steps !== null;
  const shape = () => steps?.value.shape ?? null;
  const growing = () => steps?.value.growing ?? null;
  const faultsNow = () => (isActive() ? faultsOf(shape(), growing()) : []);
  const stateNow = () => ({
    shape: shape(),
    faults: faultsNow(),
    chosen,
    isDrawing: growing() !== null,
    isMoving,
    canUndo: steps?.canUndo ?? false,
    canRedo: steps?.canRedo ?? false,
  });

  function tell() {
    if (chosen && (!isActive() || !shapes.positionAt(shape(), chosen))) chosen = null;
    if (growing()) isMoving = false;
    else pointer = null;
    if (isActive()) show(map, shape(), { chosen, faults: faultsNow(), growing: growing(), hasHandles: !isMoving });
    else show(map, null);
    // With a point chosen the arrow keys are the point's, else the map's.
    if (isActive() && (chosen || isMoving)) map.keyboard.disable();
    else map.keyboard.enable();
    canvas.classList.toggle("drawing", growing() !== null);
    onChange(stateNow());
    preview();
  }

  function preview() {
    if (!growing() || !pointer) {
      showNext(map, null);
      return;
    }
    const next = drawings.preview(steps.value, pointer);
    const ring = drawings.growingRing(steps.value);
    showNext(
      map,
      ring.length
        ? shape().kind === "circle"
          ? next
          : { kind: "line", parts: [[[ring.at(-1), pointer]]], radius_m: null }
        : null,
    );
    onPreview(next);
  }

  function take(state) {
    const isNew = steps.take(state);
    if (isNew) tell();
    return isNew;
  }
  const takeShape = (next) => take({ ...steps.value, shape: next });

  const positionOf = (point) => shapes.rounded(map.unproject(point).toArray());
  const pointOf = (event) => {
    const box = canvas.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  };
  const isFree = (event) => event.altKey || event.ctrlKey || event.metaKey;
  const snapAt = (event, point, { moved = null } = {}) =>
    isFree(event)
      ? null
      : snap(map, point, {
          but,
          own: shapes.verticesOf(shape()).filter(({ at }) => !growing() && at.join() !== moved?.join()),
        });
  const near = (position, point) => {
    if (!position) return false;
    const place = map.project(position);
    return Math.hypot(place.x - point.x, place.y - point.y) <= REACH_PX;
  };

  /** The vertex goes where it was put at once, and to the last digit of what it snapped to when that is known. */
  async function settle(at, snapped) {
    if (!snapped?.asset) return;
    const was = shapes.rounded(snapped.position);
    const position = await exact(map, snapped);
    if (!isActive() || shapes.positionAt(shape(), at)?.join() !== was.join()) return;
    steps.amend({ ...steps.value, shape: shapes.move(shape(), at, position) });
    tell();
  }

  function click(event, point) {
    const snapped = snapAt(event, point);
    const ring = drawings.growingRing(steps.value);
    const met = near(ring.at(-1), point) ? "last" : near(ring[0], point) ? "first" : null;
    const position = met === "first" ? ring[0] : snapped ? shapes.rounded(snapped.position) : positionOf(point); // a line may end where it began
    const at = [...growing(), ring.length];
    if (take(drawings.placed(steps.value, position, met)) && !met) settle(at, snapped);
    showSnap(map, null);
  }

  /** The handle under the pointer: of vertices, radius and middles the first that is within reach, then the nearest. */
  function handleAt(point) {
    if (isMoving) return { role: "whole", at: null };
    const corners = [
      [-1, -1],
      [1, 1],
    ].map(([right, down]) => map.unproject([point.x + right * REACH_PX, point.y + down * REACH_PX]));
    const [west, east] = corners.map(({ lng }) => lng);
    const [north, south] = corners.map(({ lat }) => lat);
    let best = null;
    for (const handle of handlesOf(shape())) {
      const longitude = beside(west, handle.position[0]);
      if (longitude < west || longitude > east || handle.position[1] < south || handle.position[1] > north) continue;
      const place = map.project([longitude, handle.position[1]]);
      const far = Math.hypot(place.x - point.x, place.y - point.y) + RANK[handle.role] * REACH_PX;
      if (!best || far < best.far) best = { ...handle, far };
    }
    return best;
  }

  function down(event) {
    fingers.add(event.pointerId);
    if (!isActive() || event.button !== 0 || event.shiftKey) return;
    if (fingers.size > 1) {
      if (drag) endDrag(), tell(); // two fingers move the map
      return;
    }
    const point = pointOf(event);
    const handle = growing() ? null : handleAt(point);
    if (!handle) {
      drag = { role: "none", from: point, moved: false };
      return;
    }
    event.stopPropagation();
    event.preventDefault();
    map.dragPan.disable();
    canvas.setPointerCapture(event.pointerId);
    let { at } = handle;
    let first = shape();
    if (handle.role === "middle") {
      first = shapes.insertAfter(first, at, positionOf(point));
      at = [at[0], at[1], at[2] + 1];
    }
    drag = { role: handle.role, at, from: point, first, now: null, moved: false, snapped: null, timer: 0 };
    if (handle.role === "vertex") {
      chosen = at;
      if (event.pointerType === "touch")
        drag.timer = setTimeout(() => drag && !drag.moved && (endDrag(), remove()), LONG_PRESS_MS);
    }
    show(map, shape(), { chosen, faults: faultsNow(), hasHandles: !isMoving });
  }

  function moved(event) {
    if (!isActive()) return;
    const point = pointOf(event);
    if (drag) {
      drag.moved ||= Math.hypot(point.x - drag.from.x, point.y - drag.from.y) >= MOVED_PX;
      if (drag.moved && drag.role !== "none") dragTo(event, point);
      if (drag.role !== "none") return;
    }
    if (map.isMoving()) return;
    if (!growing()) {
      canvas.classList.toggle("over-thing", event.pointerType === "mouse" && handleAt(point) !== null);
      return;
    }
    const snapped = snapAt(event, point);
    pointer = snapped?.position ?? positionOf(point);
    showSnap(map, snapped?.position ?? null);
    preview();
  }

  function dragTo(event, point) {
    const isVertex = drag.role === "vertex" || drag.role === "middle";
    const snapped = isVertex ? snapAt(event, point, { moved: drag.at }) : null;
    const position = snapped ? shapes.rounded(snapped.position) : positionOf(point);
    drag.snapped = snapped;
    showSnap(map, snapped?.position ?? null);
    if (isVertex) drag.now = shapes.move(drag.first, drag.at, position);
    else if (drag.role === "radius") drag.now = shapes.radiusTo(drag.first, position);
    else {
      const from = map.unproject(drag.from);
      const to = map.unproject(point);
      drag.now = shapes.moveAll(drag.first, [to.lng - from.lng, to.lat - from.lat]);
    }
    show(map, drag.now, { chosen, faults: faultsOf(drag.now), hasHandles: !isMoving });
    onPreview(drag.now);
  }

  function endDrag() {
    clearTimeout(drag?.timer);
    map.dragPan.enable();
    showSnap(map, null);
    const ended = drag;
    drag = null;
    return ended;
  }

  function up(event) {
    fingers.delete(event.pointerId);
    if (!isActive() || !drag) return;
    const ended = endDrag();
    if (ended.role === "none") {
      if (ended.moved) return;
      if (growing()) click(event, pointOf(event));
      else if (chosen) choose(null);
      return;
    }
    if (ended.role === "vertex" && !ended.moved && event.altKey) {
      remove();
      return;
    }
    if (ended.role === "vertex" || ended.role === "middle") chosen = ended.at;
    const next = ended.moved ? ended.now : ended.role === "middle" ? ended.first : null;
    if (next && takeShape(next)) settle(ended.at, ended.snapped);
    else tell();
  }

  function cancelled(event) {
    fingers.delete(event.pointerId);
    if (isActive() && drag) endDrag(), tell();
  }

  function choose(at) {
    chosen = at;
    tell();
  }

  function remove(without = shapes.removeVertex) {
    if (!chosen || growing()) return false;
    const next = without(shape(), chosen);
    if (next === shape()) return false;
    chosen = null;
    return takeShape(next);
  }

  canvas.addEventListener("pointerdown", down, true);
  canvas.addEventListener("pointermove", moved);
  canvas.addEventListener("pointerup", up);
  canvas.addEventListener("pointercancel", cancelled);
  canvas.addEventListener("contextmenu", (event) => isActive() && event.preventDefault()); // a long press removes a vertex
  map.on("dblclick", (event) => isActive() && event.preventDefault());

  const whileActive =
    (act) =>
    (...given) =>
      isActive() ? act(...given) : false;

  return {
    addTo: () => addTo(map),
    recolour() {
      recolour(map);
      if (isActive()) tell();
    },
    isActive,
    get state() {
      return stateNow();
    },
    /** An empty shape is drawn from its first click, one that was left in the middle goes on there, a whole one is edited. */
    start(first, { without = null } = {}) {
      steps = createSteps(drawings.begin(first));
      but = without;
      chosen = pointer = null;
      isMoving = false;
      forgetShapes();
      map.doubleClickZoom.disable();
      tell();
    },
    stop() {
      steps = chosen = pointer = null;
      isMoving = false;
      showSnap(map, null);
      map.doubleClickZoom.enable();
      canvas.classList.remove("over-thing");
      tell();
    },
    finish: whileActive(() => take(drawings.ended(steps.value))),
    removeChosen: whileActive(() => remove()),
    /** The hole or part that the chosen vertex belongs to. */
    removeRing: whileActive(() => remove(shapes.removeRing)),
    undo: whileActive(() => steps.undo() && (tell(), true)),
    redo: whileActive(() => steps.redo() && (tell(), true)),
    /** One step back: the last vertex while drawing, then what is chosen; false where there is nothing to step back from. */
    back: whileActive(() => {
      if (growing()) return take(drawings.stepBack(steps.value));
      if (!chosen && !isMoving) return false;
      isMoving = false;
      choose(null);
      return true;
    }),
    startHole: whileActive(() => take(drawings.withHole(steps.value, chosen?.[0] ?? 0))),
    startPart: whileActive(() => take(drawings.withPart(steps.value))),
    /** The whole shape follows pointer and arrow keys, instead of its vertices. */
    moveWhole: whileActive((on) => {
      isMoving = on && !growing();
      choose(null);
    }),
    choose: whileActive(choose),
    /** A vertex in the middle of the map, for those who draw without a pointer. */
    addInMiddle: whileActive(() => {
      if (!growing()) return false;
      const at = [...growing(), drawings.growingRing(steps.value).length];
      if (!take(drawings.placed(steps.value, shapes.rounded(map.getCenter().toArray())))) return false;
      if (shapes.positionAt(shape(), at)) choose(at);
      return true;
    }),
    /** Moves the chosen vertex, or the whole shape, by pixels of the screen. */
    nudge: whileActive((right_px, down_px) => {
      if (!chosen && !isMoving) return false;
      const from = chosen ? shapes.positionAt(shape(), chosen) : map.getCenter().toArray();
      const place = map.project(from);
      const to = positionOf({ x: place.x + right_px, y: place.y + down_px });
      takeShape(
        chosen ? shapes.move(shape(), chosen, to) : shapes.moveAll(shape(), [to[0] - from[0], to[1] - from[1]]),
      );
      return true;
    }),
    put: whileActive((at, position) => takeShape(shapes.move(shape(), at, shapes.rounded(position)))),
    setRadius: whileActive((radius_m) => radius_m > 0 && takeShape(shapes.withRadius(shape(), radius_m))),
  };
}
