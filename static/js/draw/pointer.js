/** Pointer and touch of the editor: clicks that draw, handles that are dragged, a long press that removes a vertex. */

import { beside } from "../domain/geodesy.js";
import * as drawings from "./drawing.js";
import { handlesOf, showSnap } from "./layers.js";
import * as shapes from "./shape.js";
import { snap } from "./snapping.js";

/** @import { MapLibreMap, ScreenPoint } from "../map/types.d.ts" */
/** @import { Editor } from "./editor.js" */
/** @import { Handle, Shape, Snapped, VertexPath } from "./types.d.ts" */

const REACH_PX = matchMedia("(pointer: coarse)").matches ? 22 : 9; // on touch the target is 44 px wide
const MOVED_PX = 4;
const LONG_PRESS_MS = 550;
const RANK = { vertex: 0, radius: 1, middle: 2, whole: 3 };

/**
 * A press, and what becomes of it. `first` is the shape when it began, `now` what the drag has made of it.
 *
 * @typedef {object} Drag
 * @property {Handle["role"]} role
 * @property {VertexPath | null} at
 * @property {ScreenPoint} from
 * @property {Shape} first
 * @property {Shape | null} now
 * @property {boolean} moved
 * @property {Snapped | null} snapped
 * @property {ReturnType<typeof setTimeout>} [timer]
 */

/** @param {MapLibreMap} map @param {Editor} editor */
export function listenToPointer(map, editor) {
  const pointer = new Pointer(map, editor);
  const canvas = map.getCanvasContainer();
  canvas.addEventListener("pointerdown", (event) => pointer.down(event), true);
  canvas.addEventListener("pointermove", (event) => pointer.moved(event));
  canvas.addEventListener("pointerup", (event) => pointer.up(event));
  canvas.addEventListener("pointercancel", (event) => pointer.cancelled(event));
  canvas.addEventListener("contextmenu", (event) => {
    if (editor.isActive()) event.preventDefault(); // a long press removes a vertex
  });
  map.on("dblclick", (event) => {
    if (editor.isActive()) event.preventDefault();
  });
}

class Pointer {
  #map;
  #editor;
  #canvas;
  /** @type {Set<number>} */
  #fingers = new Set();
  /** A handle that is held. @type {Drag | null} */
  #drag = null;
  /** A press beside every handle. @type {{ from: ScreenPoint, moved: boolean } | null} */
  #press = null;

  /** @param {MapLibreMap} map @param {Editor} editor */
  constructor(map, editor) {
    this.#map = map;
    this.#editor = editor;
    this.#canvas = map.getCanvasContainer();
  }

  /** @param {PointerEvent} event */
  down(event) {
    const editor = this.#editor;
    this.#fingers.add(event.pointerId);
    if (!editor.isActive() || event.button !== 0 || event.shiftKey) return;
    if (this.#fingers.size > 1) {
      this.#press = null;
      if (!this.#drag) return;
      this.#endDrag(); // two fingers move the map
      editor.notify();
      return;
    }
    const point = this.#pointOf(event);
    const handle = editor.growing ? null : this.#handleAt(point);
    if (!handle) {
      this.#press = { from: point, moved: false };
      return;
    }
    event.stopPropagation();
    event.preventDefault();
    this.#map.dragPan.disable();
    this.#canvas.setPointerCapture(event.pointerId);
    this.#drag = this.#dragOf(handle, point);
    if (handle.role === "vertex") {
      editor.chosen = handle.at;
      if (event.pointerType === "touch") this.#drag.timer = setTimeout(() => this.#longPress(), LONG_PRESS_MS);
    }
    editor.showShape(editor.drawing.shape, editor.faults());
  }

  /** @param {PointerEvent} event */
  moved(event) {
    const editor = this.#editor;
    if (!editor.isActive()) return;
    const point = this.#pointOf(event);
    if (this.#press) this.#press.moved ||= isFar(point, this.#press.from);
    if (this.#drag) {
      this.#drag.moved ||= isFar(point, this.#drag.from);
      if (this.#drag.moved) this.#dragTo(this.#drag, event, point);
      return;
    }
    if (this.#map.isMoving()) return;
    if (!editor.growing) {
      this.#canvas.classList.toggle("over-thing", event.pointerType === "mouse" && this.#handleAt(point) !== null);
      return;
    }
    const snapped = this.#snapAt(event, point);
    editor.pointer = snapped?.position ?? this.#positionOf(point);
    showSnap(this.#map, snapped?.position ?? null);
    editor.preview();
  }

  /** @param {PointerEvent} event */
  up(event) {
    const editor = this.#editor;
    this.#fingers.delete(event.pointerId);
    const press = this.#press;
    this.#press = null;
    if (!editor.isActive()) return;
    if (press) {
      if (press.moved) return;
      if (editor.growing) this.#click(event, this.#pointOf(event));
      else if (editor.chosen) editor.choose(null);
      return;
    }
    const ended = this.#endDrag();
    if (!ended) return;
    if (ended.role === "vertex" && !ended.moved && event.altKey) {
      editor.removeChosen();
      return;
    }
    if (ended.role === "vertex" || ended.role === "middle") editor.chosen = ended.at;
    const next = ended.moved ? ended.now : ended.role === "middle" ? ended.first : null;
    if (!next || !editor.takeShape(next)) editor.notify();
    else if (ended.at) editor.settle(ended.at, ended.snapped);
  }

  /** @param {PointerEvent} event */
  cancelled(event) {
    this.#fingers.delete(event.pointerId);
    this.#press = null;
    if (this.#editor.isActive() && this.#endDrag()) this.#editor.notify();
  }

  /** The drag that a press on a handle begins; one on a middle adds a vertex. @param {Handle} handle @param {ScreenPoint} point */
  #dragOf({ role, at }, point) {
    /** @type {Drag} */
    const drag = { role, at, from: point, first: this.#editor.drawing.shape, now: null, moved: false, snapped: null };
    if (role !== "middle" || !at) return drag;
    drag.first = shapes.insertAfter(drag.first, at, this.#positionOf(point));
    drag.at = [at[0], at[1], at[2] + 1];
    return drag;
  }

  #longPress() {
    if (!this.#drag || this.#drag.moved) return;
    this.#endDrag();
    this.#editor.removeChosen();
  }

  /** @param {Drag} drag @param {PointerEvent} event @param {ScreenPoint} point */
  #dragTo(drag, event, point) {
    const isVertex = drag.role === "vertex" || drag.role === "middle";
    drag.snapped = isVertex ? this.#snapAt(event, point, drag.at) : null;
    const position = drag.snapped ? shapes.rounded(drag.snapped.position) : this.#positionOf(point);
    showSnap(this.#map, drag.snapped?.position ?? null);
    if (isVertex && drag.at) drag.now = shapes.move(drag.first, drag.at, position);
    else if (drag.role === "radius") drag.now = shapes.radiusTo(drag.first, position);
    else {
      const from = this.#map.unproject([drag.from.x, drag.from.y]);
      const to = this.#map.unproject([point.x, point.y]);
      drag.now = shapes.moveAll(drag.first, [to.lng - from.lng, to.lat - from.lat]);
    }
    this.#editor.previewDrag(drag.now);
  }

  /** Ends the drag, and returns it. */
  #endDrag() {
    const ended = this.#drag;
    this.#drag = null;
    if (!ended) return null;
    clearTimeout(ended.timer);
    this.#map.dragPan.enable();
    showSnap(this.#map, null);
    return ended;
  }

  /** @param {PointerEvent} event @param {ScreenPoint} point */
  #click(event, point) {
    const editor = this.#editor;
    const snapped = this.#snapAt(event, point);
    const ring = drawings.growingRing(editor.drawing);
    const near = this.#isNear(ring.at(-1), point) ? "last" : this.#isNear(ring[0], point) ? "first" : null;
    const clicked = snapped ? shapes.rounded(snapped.position) : this.#positionOf(point);
    const position = near === "first" ? ring[0] : clicked; // a line may end where it began
    const at = [...(editor.growing ?? []), ring.length];
    if (editor.take(drawings.placed(editor.drawing, position, near)) && !near) editor.settle(at, snapped);
    showSnap(this.#map, null);
  }

  /** @param {ScreenPoint} point */
  #positionOf({ x, y }) {
    return shapes.rounded(this.#map.unproject([x, y]).toArray());
  }

  /** @param {PointerEvent} event @returns {ScreenPoint} */
  #pointOf(event) {
    const box = this.#canvas.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  }

  /**
   * What a vertex would snap to; null with Ctrl or Alt held.
   *
   * @param {PointerEvent} event
   * @param {ScreenPoint} point
   * @param {VertexPath | null} [moved] the vertex that is dragged: it does not snap to itself
   */
  #snapAt(event, point, moved = null) {
    if (event.altKey || event.ctrlKey || event.metaKey) return null;
    const { drawing, growing, without } = this.#editor;
    const own = growing ? [] : shapes.verticesOf(drawing.shape).filter(({ at }) => at.join() !== moved?.join());
    return snap(this.#map, point, { but: without, own });
  }

  /** @param {number[] | undefined} position @param {ScreenPoint} point */
  #isNear(position, point) {
    if (!position) return false;
    const place = this.#map.project([position[0], position[1]]);
    return Math.hypot(place.x - point.x, place.y - point.y) <= REACH_PX;
  }

  /**
   * The handle under the pointer: of vertices, radius and middles the first that is within reach, then the nearest.
   *
   * @param {ScreenPoint} point
   * @returns {Handle | null}
   */
  #handleAt(point) {
    if (this.#editor.isMoving) return { role: "whole", at: null, position: [] };
    const northWest = this.#map.unproject([point.x - REACH_PX, point.y - REACH_PX]);
    const southEast = this.#map.unproject([point.x + REACH_PX, point.y + REACH_PX]);
    /** @type {(Handle & { far: number }) | null} */
    let best = null;
    for (const handle of handlesOf(this.#editor.drawing.shape)) {
      const longitude = beside(northWest.lng, handle.position[0]);
      const latitude = handle.position[1];
      if (longitude < northWest.lng || longitude > southEast.lng) continue;
      if (latitude < southEast.lat || latitude > northWest.lat) continue;
      const place = this.#map.project([longitude, latitude]);
      const far = Math.hypot(place.x - point.x, place.y - point.y) + RANK[handle.role] * REACH_PX;
      if (!best || far < best.far) best = { ...handle, far };
    }
    return best;
  }
}

/** @param {ScreenPoint} point @param {ScreenPoint} from */
const isFar = (point, from) => Math.hypot(point.x - from.x, point.y - from.y) >= MOVED_PX;
