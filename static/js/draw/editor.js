/** Drawing and editing one shape on the map. drawing.js decides the effect of a click; pointer.js reads the pointer. */

import * as drawings from "./drawing.js";
import { createSteps } from "./history.js";
import { addTo, recolour, show, showNext, showSnap } from "./layers.js";
import { listenToPointer } from "./pointer.js";
import * as shapes from "./shape.js";
import { exact, forgetShapes } from "./snapping.js";
import { faultsOf } from "./validity.js";

/** @import { MapLibreMap } from "../map/types.d.ts" */
/** @import { Drawing, EditorState, Fault, Shape, Snapped, VertexPath } from "./types.d.ts" */

/**
 * @typedef {object} EditorOptions
 * @property {(state: EditorState) => void} onChange called after each step
 * @property {(shape: Shape) => void} [onPreview] called with what the shape would be if the pointer were clicked
 */

/** @param {MapLibreMap} map @param {EditorOptions} options */
export const createEditor = (map, options) => new Editor(map, options);

export class Editor {
  #onChange;
  #onPreview;
  /** @type {ReturnType<typeof createSteps<Drawing>> | null} */
  #steps = null;
  /** @type {VertexPath | null} */
  chosen = null;
  isMoving = false; // the whole shape, not its vertices
  /** Where the next vertex would be. @type {number[] | null} */
  pointer = null;
  /** The asset that is edited: it does not snap to itself. @type {number | null} */
  without = null;

  /** @param {MapLibreMap} map @param {EditorOptions} options */
  constructor(map, { onChange, onPreview = () => {} }) {
    this.map = map;
    this.#onChange = onChange;
    this.#onPreview = onPreview;
    listenToPointer(map, this);
  }

  addTo() {
    addTo(this.map);
  }

  recolour() {
    recolour(this.map);
    if (this.isActive()) this.notify();
  }

  isActive = () => this.#steps !== null;

  /** Only while something is drawn. @returns {Drawing} */
  get drawing() {
    if (!this.#steps) throw new Error("nothing is drawn");
    return this.#steps.value;
  }

  get growing() {
    return this.#steps?.value.growing ?? null;
  }

  /** @returns {EditorState} */
  get state() {
    return {
      shape: this.#steps?.value.shape ?? null,
      faults: this.faults(),
      chosen: this.chosen,
      isDrawing: this.growing !== null,
      isMoving: this.isMoving,
      canUndo: this.#steps?.canUndo ?? false,
      canRedo: this.#steps?.canRedo ?? false,
    };
  }

  /** @returns {Fault[]} */
  faults() {
    return this.#steps ? faultsOf(this.drawing.shape, this.growing) : [];
  }

  /**
   * Start: an empty shape is drawn from its first click, an unfinished one is continued, a complete one is edited.
   *
   * @param {Shape} first
   * @param {{ without?: number | null }} [options]
   */
  start(first, { without = null } = {}) {
    this.#steps = createSteps(drawings.begin(first));
    this.without = without;
    this.chosen = null;
    this.pointer = null;
    this.isMoving = false;
    forgetShapes();
    this.map.doubleClickZoom.disable();
    this.notify();
  }

  stop() {
    this.#steps = null;
    this.chosen = null;
    this.pointer = null;
    this.isMoving = false;
    showSnap(this.map, null);
    this.map.doubleClickZoom.enable();
    this.map.getCanvasContainer().classList.remove("over-thing");
    this.notify();
  }

  /** Draw the present shape and report it. */
  notify() {
    const { map } = this;
    if (this.chosen && (!this.#steps || !shapes.positionAt(this.drawing.shape, this.chosen))) this.chosen = null;
    if (this.growing) this.isMoving = false;
    else this.pointer = null;
    if (this.#steps) this.showShape(this.drawing.shape, this.faults());
    else show(map, null);
    // With a point chosen the arrow keys are the point's, else the map's.
    if (this.#steps && (this.chosen || this.isMoving)) map.keyboard.disable();
    else map.keyboard.enable();
    map.getCanvasContainer().classList.toggle("drawing", this.growing !== null);
    this.#onChange(this.state);
    this.preview();
  }

  /** @param {Shape} shape @param {Fault[]} faults */
  showShape(shape, faults) {
    show(this.map, shape, { chosen: this.chosen, faults, growing: this.growing, hasHandles: !this.isMoving });
  }

  /** Shows what the next click would add. */
  preview() {
    if (!this.growing || !this.pointer) {
      showNext(this.map, null);
      return;
    }
    const next = drawings.preview(this.drawing, this.pointer);
    const last = drawings.growingRing(this.drawing).at(-1);
    if (!last) showNext(this.map, null);
    else if (next.kind === "circle") showNext(this.map, next);
    else showNext(this.map, { kind: "line", parts: [[[last, this.pointer]]], radius_m: null });
    this.#onPreview(next);
  }

  /** Shows a shape that a drag would make. @param {Shape} shape */
  previewDrag(shape) {
    this.showShape(shape, faultsOf(shape));
    this.#onPreview(shape);
  }

  /** Apply one step; false where it changes nothing. @param {Drawing} drawing */
  take(drawing) {
    const isNew = this.#steps?.take(drawing) ?? false;
    if (isNew) this.notify();
    return isNew;
  }

  /** @param {Shape} shape */
  takeShape(shape) {
    return this.take({ ...this.drawing, shape });
  }

  /**
   * Place a vertex at once, and exactly at the feature that it snapped to once that is loaded.
   *
   * @param {VertexPath} at
   * @param {Snapped | null} snapped
   */
  async settle(at, snapped) {
    if (!snapped?.asset) return;
    const was = shapes.rounded(snapped.position);
    const position = await exact(this.map, snapped);
    if (!this.#steps || shapes.positionAt(this.drawing.shape, at)?.join() !== was.join()) return;
    this.#steps.amend({ ...this.drawing, shape: shapes.move(this.drawing.shape, at, position) });
    this.notify();
  }

  // --- what buttons and keys call: each does nothing and returns false while nothing is drawn

  /** @param {VertexPath | null} at */
  choose = (at) => {
    if (!this.#steps) return false;
    this.chosen = at;
    this.notify();
    return true;
  };

  finish = () => this.#steps !== null && this.take(drawings.ended(this.drawing));

  removeChosen = () => this.#remove(shapes.removeVertex);

  /** The hole or part that the chosen vertex belongs to. */
  removeRing = () => this.#remove(shapes.removeRing);

  /** @param {(shape: Shape, at: VertexPath) => Shape} without */
  #remove(without) {
    if (!this.#steps || !this.chosen || this.growing) return false;
    const { shape } = this.drawing;
    const next = without(shape, this.chosen);
    if (next === shape) return false;
    this.chosen = null;
    return this.takeShape(next);
  }

  undo = () => this.#step("undo");

  redo = () => this.#step("redo");

  /** @param {"undo" | "redo"} direction */
  #step(direction) {
    if (!this.#steps?.[direction]()) return false;
    this.notify();
    return true;
  }

  /** Undo one step: the last vertex while drawing, then the selection; false where there is none. */
  back = () => {
    if (!this.#steps) return false;
    if (this.growing) return this.take(drawings.stepBack(this.drawing));
    if (!this.chosen && !this.isMoving) return false;
    this.isMoving = false;
    return this.choose(null);
  };

  startHole = () => this.#steps !== null && this.take(drawings.withHole(this.drawing, this.chosen?.[0] ?? 0));

  startPart = () => this.#steps !== null && this.take(drawings.withPart(this.drawing));

  /** The whole shape follows pointer and arrow keys, instead of its vertices. @param {boolean} on */
  moveWhole = (on) => {
    if (!this.#steps) return false;
    this.isMoving = on && !this.growing;
    return this.choose(null);
  };

  /** A vertex in the middle of the map, for those who draw without a pointer. */
  addInMiddle = () => {
    if (!this.#steps || !this.growing) return false;
    const at = [...this.growing, drawings.growingRing(this.drawing).length];
    const middle = shapes.rounded(this.map.getCenter().toArray());
    if (!this.take(drawings.placed(this.drawing, middle))) return false;
    if (shapes.positionAt(this.drawing.shape, at)) this.choose(at);
    return true;
  };

  /** Moves the chosen vertex, or the whole shape, by pixels of the screen. @param {number} right_px @param {number} down_px */
  nudge = (right_px, down_px) => {
    if (!this.#steps || (!this.chosen && !this.isMoving)) return false;
    const { map, chosen } = this;
    const { shape } = this.drawing;
    const centre = map.getCenter().toArray();
    const [longitude, latitude] = (chosen && shapes.positionAt(shape, chosen)) ?? centre;
    const place = map.project([longitude, latitude]);
    const to = shapes.rounded(map.unproject([place.x + right_px, place.y + down_px]).toArray());
    const moved = chosen
      ? shapes.move(shape, chosen, to)
      : shapes.moveAll(shape, [to[0] - longitude, to[1] - latitude]);
    this.takeShape(moved);
    return true;
  };

  /** @param {VertexPath} at @param {number[]} position */
  put = (at, position) =>
    this.#steps !== null && this.takeShape(shapes.move(this.drawing.shape, at, shapes.rounded(position)));

  /** @param {number} radius_m */
  setRadius = (radius_m) =>
    this.#steps !== null && radius_m > 0 && this.takeShape(shapes.withRadius(this.drawing.shape, radius_m));
}
