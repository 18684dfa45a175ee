/** Drawing and editing one shape on the map, with pointer, touch and keys. */

import { createSteps } from "./history.js";
import { HANDLES, addTo, recolour, show, showSnap } from "./layers.js";
import * as shapes from "./shape.js";
import { exact, snap } from "./snapping.js";
import { faultsOf } from "./validity.js";

const REACH_PX = matchMedia("(pointer: coarse)").matches ? 22 : 9;
const MOVED_PX = 4;
const LONG_PRESS_MS = 550;
const HANDLE_LAYERS = [HANDLES, "draw-middles"];

/**
 * onChange(state) is told after each step: { shape, faults, chosen, isDrawing, canUndo, canRedo }. Returns the editor: start(shape, { but }),
 * stop(), and what buttons and keys call. `but` is the asset that is edited: it does not snap to itself.
 */
export function createEditor(map, { onChange }) {
  const canvas = map.getCanvasContainer();
  let steps = null;
  let drawing = null; // [part, ring] that grows with each click
  let chosen = null;
  let pointer = null; // where the next vertex would be
  let drag = null;
  let but = null;

  const shape = () => steps?.value ?? null;
  const isActive = () => steps !== null;

  function draw() {
    if (!isActive()) {
      show(map, null);
      showSnap(map, null);
      return;
    }
    const ring = drawing ? shapes.ringAt(shape(), drawing) : [];
    const faults = drawing ? faultsOf(shape()).filter((fault) => fault.sides.length) : faultsOf(shape());
    show(map, shape(), { chosen, faults, next: drawing && pointer && ring.length ? [ring.at(-1), pointer] : null });
  }

  function tell() {
    draw();
    onChange({
      shape: shape(), faults: isActive() ? faultsOf(shape()) : [], chosen, isDrawing: drawing !== null,
      canUndo: steps?.canUndo ?? false, canRedo: steps?.canRedo ?? false,
    });
  }

  function take(next) {
    if (next && steps.take(next)) tell();
  }

  const roundedAt = (point) => {
    const { lng, lat } = map.unproject(point);
    return [shapes.round(lng), shapes.round(lat)];
  };
  const pointOf = (event) => {
    const box = canvas.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  };
  const isFree = (event) => event.altKey || event.ctrlKey || event.metaKey;
  const snapAt = (event, point) => (isFree(event) ? null : snap(map, point, { but }));

  /** The vertex goes where it was put at once, and to the last digit of what it snapped to when that is known. */
  async function settle(at, snapped) {
    if (!snapped?.isVertex) return;
    const position = await exact(snapped);
    if (!isActive() || shapes.positionAt(shape(), at)?.join() !== snapped.position.map(shapes.round).join()) return;
    steps.amend(shapes.move(shape(), at, position));
    tell();
  }

  function addVertex(event, point) {
    const snapped = snapAt(event, point);
    const position = snapped ? snapped.position.map(shapes.round) : roundedAt(point);
    const now = shape();
    if (now.kind === "point") {
      drawing = null;
      take({ ...now, parts: [[[position]]] });
      settle([0, 0, 0], snapped);
      tell();
      return;
    }
    if (now.kind === "circle") {
      if (!now.parts[0][0].length) take({ ...now, parts: [[[position]]] });
      else {
        drawing = null;
        take(shapes.radiusTo(now, position));
        tell();
      }
      return;
    }
    const ring = shapes.ringAt(now, drawing);
    const isFirst = ring.length >= shapes.leastOf(now.kind) && near(ring[0], point);
    const isLast = ring.length >= shapes.leastOf(now.kind) && near(ring.at(-1), point);
    if (isLast || (now.kind === "area" && isFirst)) {
      finish();
      return;
    }
    const at = [...drawing, ring.length];
    take(shapes.append(now, drawing, position));
    settle(at, snapped);
  }

  const near = (position, point) => {
    const place = map.project(position);
    return Math.hypot(place.x - point.x, place.y - point.y) <= REACH_PX;
  };

  function finish() {
    if (!drawing) return false;
    drawing = null;
    pointer = null;
    showSnap(map, null);
    const whole = shapes.withoutStubs(shape());
    if (JSON.stringify(whole) !== JSON.stringify(shape())) steps.take(whole);
    tell();
    return true;
  }

  /** After a step back or forth: a ring that is not whole is the one that is being drawn. */
  function goOnWith() {
    if (chosen && !shapes.positionAt(shape(), chosen)) chosen = null;
    drawing = shapes.stubOf(shape());
    pointer = null;
    tell();
  }

  function handleAt(point) {
    const box = [[point.x - REACH_PX, point.y - REACH_PX], [point.x + REACH_PX, point.y + REACH_PX]];
    const met = map.queryRenderedFeatures(box, { layers: HANDLE_LAYERS.filter((id) => map.getLayer(id)) });
    const rank = { vertex: 0, radius: 1, middle: 2 };
    const best = met.sort((a, b) => rank[a.properties.role] - rank[b.properties.role])[0];
    return best ? { role: best.properties.role, at: best.properties.at ? best.properties.at.split(",").map(Number) : null } : null;
  }

  function down(event) {
    if (!isActive() || event.button !== 0 || event.shiftKey) return;
    const point = pointOf(event);
    const handle = drawing ? null : handleAt(point);
    if (!handle) {
      drag = { role: "none", from: point, moved: false };
      return;
    }
    event.stopPropagation();
    event.preventDefault();
    map.dragPan.disable();
    canvas.setPointerCapture(event.pointerId);
    let at = handle.at;
    let start = shape();
    if (handle.role === "middle") {
      start = shapes.insertAfter(start, at, roundedAt(point));
      at = [at[0], at[1], at[2] + 1];
    }
    drag = { role: handle.role, at, from: point, before: shape(), start, moved: false, snapped: null, timer: 0 };
    if (handle.role === "vertex") {
      chosen = at;
      drag.timer = setTimeout(() => !drag?.moved && event.pointerType === "touch" && (endDrag(), removeChosen()), LONG_PRESS_MS);
    }
    draw();
  }

  function moved(event) {
    if (!isActive()) return;
    const point = pointOf(event);
    if (drag && drag.role !== "none") {
      if (!drag.moved && Math.hypot(point.x - drag.from.x, point.y - drag.from.y) < MOVED_PX) return;
      drag.moved = true;
      dragTo(event, point);
      return;
    }
    if (drag) drag.moved ||= Math.hypot(point.x - drag.from.x, point.y - drag.from.y) >= MOVED_PX;
    if (!drawing || map.isMoving()) return;
    const snapped = snapAt(event, point);
    pointer = snapped?.position ?? roundedAt(point);
    showSnap(map, snapped?.position ?? null);
    draw();
  }

  function dragTo(event, point) {
    const snapped = drag.role === "radius" ? null : snapAt(event, point);
    const position = snapped ? snapped.position.map(shapes.round) : roundedAt(point);
    drag.snapped = snapped;
    showSnap(map, snapped?.position ?? null);
    drag.now = drag.role === "radius" ? shapes.radiusTo(drag.start, position) : shapes.move(drag.start, drag.at, position);
    show(map, drag.now, { chosen, faults: faultsOf(drag.now) });
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
    if (!isActive() || !drag) return;
    const ended = endDrag();
    if (ended.role === "none") {
      if (!ended.moved && drawing) addVertex(event, pointOf(event));
      else if (!ended.moved && chosen) {
        chosen = null;
        tell();
      }
      return;
    }
    if (ended.role === "vertex" && !ended.moved && event.altKey) {
      removeChosen();
      return;
    }
    if (ended.role !== "radius") chosen = ended.at;
    const next = ended.moved ? ended.now : ended.role === "middle" ? ended.start : null;
    if (next && steps.take(next)) settle(ended.at, ended.snapped);
    tell();
  }

  function removeChosen() {
    if (!chosen) return false;
    const next = shapes.removeVertex(shape(), chosen);
    chosen = null;
    if (next === shape()) {
      tell();
      return false;
    }
    take(next);
    return true;
  }

  canvas.addEventListener("pointerdown", down, true);
  canvas.addEventListener("pointermove", moved);
  canvas.addEventListener("pointerup", up);
  canvas.addEventListener("pointercancel", () => isActive() && drag && (endDrag(), draw()));
  map.on("dblclick", (event) => {
    if (!isActive()) return;
    event.preventDefault();
    finish();
  });

  return {
    addTo: () => addTo(map),
    recolour: () => (recolour(map), draw()),
    isActive,
    get state() {
      return { shape: shape(), faults: isActive() ? faultsOf(shape()) : [], isDrawing: drawing !== null };
    },
    /** An empty shape is drawn from its first click, another one is edited. */
    start(first, { without = null } = {}) {
      steps = createSteps(first);
      but = without;
      chosen = null;
      drawing = shapes.isEmpty(first) || (first.kind === "circle" && !first.radius_m) ? [0, 0] : null;
      map.doubleClickZoom.disable();
      canvas.classList.add("drawing");
      tell();
    },
    stop() {
      steps = drawing = chosen = pointer = null;
      map.doubleClickZoom.enable();
      canvas.classList.remove("drawing");
      tell();
    },
    finish,
    removeChosen,
    undo() {
      if (!steps?.undo()) return false;
      goOnWith();
      return true;
    },
    redo() {
      if (!steps?.redo()) return false;
      goOnWith();
      return true;
    },
    /** One step back: the last vertex while drawing, then what is chosen, then nothing. */
    back() {
      if (drawing && shapes.ringAt(shape(), drawing).length) {
        take(shapes.dropLast(shape(), drawing));
        return true;
      }
      if (drawing && drawing.join() !== "0,0") return finish();
      if (!chosen) return false;
      chosen = null;
      tell();
      return true;
    },
    startHole() {
      const now = shape();
      take(shapes.addHole(now, 0));
      drawing = [0, now.parts[0].length];
      tell();
    },
    startPart() {
      const now = shape();
      take(shapes.addPart(now));
      drawing = [now.parts.length, 0];
      tell();
    },
    choose(at) {
      chosen = at;
      tell();
    },
    /** Moves the chosen vertex by pixels of the screen. */
    nudge(right_px, down_px) {
      if (!chosen) return false;
      const place = map.project(shapes.positionAt(shape(), chosen));
      take(shapes.move(shape(), chosen, roundedAt({ x: place.x + right_px, y: place.y + down_px })));
      return true;
    },
    put: (at, position) => take(shapes.move(shape(), at, position)),
    setRadius: (radius_m) => take(shapes.withRadius(shape(), radius_m)),
    replace: (next) => ((drawing = null), take(next)),
  };
}
