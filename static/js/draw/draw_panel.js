/** The panel of a drawing: tools, length or area, faults, and its vertices as a table. */

import { h, icon } from "../dom.js";
import { measure } from "../domain/geodesy.js";
import { t, tn } from "../text.js";
import { areaText, lengthText } from "../units.js";
import { circleOf, removeRing, removeVertex, verticesOf } from "./shape.js";
import { createVertexTable } from "./vertex_table.js";

/** @import { Editor } from "./editor.js" */
/** @import { EditorState, Fault, Shape, ShapeKind } from "./types.d.ts" */

const MAX_FAULTS = 5;
/** @type {Record<ShapeKind, string>} */
const ASK = {
  point: t("Click where it stands."),
  line: t("Click along the line; Enter or a click on the last point ends it."),
  area: t("Click round the area; Enter or a click on the first point closes it."),
  circle: t("Click the centre, then how far it reaches."),
};

/** @type {Record<ShapeKind, string>} */
const HINTS = {
  point: t("Drag it to its place, or write where it stands under Points."),
  line: t("Drag a point; drag the small one between two to add another."),
  area: t("Drag a point; drag the small one between two to add another."),
  circle: t("Drag the centre, or the point on the rim."),
};
const HOLD = matchMedia("(pointer: coarse)").matches
  ? ` ${t("Hold a point to remove it.")}`
  : ` ${t("Alt-click removes a point. Hold Ctrl or Alt to turn off snapping.")}`;
const MOVING = t("Drag the whole shape, or move it with the arrow keys.");

/** @param {string} words @param {string} name of an icon @param {() => unknown} act @param {Record<string, string>} [rest] */
const button = (words, name, act, rest = {}) =>
  h("button", { type: "button", class: "button", onclick: act, ...rest }, icon(name, "small"), words);
/** @param {string} words @param {string} name of an icon @param {() => unknown} act */
const tool = (words, name, act) =>
  h("button", { type: "button", class: "icon-button", "aria-label": words, title: words, onclick: act }, icon(name));

/** Lengths and areas as the server found them, on the ellipsoid. @typedef {{ length_m?: number | null, area_m2?: number | null }} Figures */
/** @typedef {(position: number[]) => void} ShowPlace moves the map there */

/** @param {Editor} editor @param {{ show: ShowPlace }} options */
export const createDrawPanel = (editor, options) => new DrawPanel(editor, options.show);

class DrawPanel {
  #show;
  #tools;
  #vertices;
  #ask = h("p", { class: "caption" });
  #figures = h("p", { class: "draw-figures", role: "status" });
  #coming = h("p", { class: "draw-figures", "aria-hidden": "true", hidden: true }); // follows the pointer: not read out
  #faults = h("div", { class: "draw-faults" });
  #radius = h("input", { class: "input", id: "draw-radius", type: "number", min: 1, max: 500_000, step: 1 });
  #radiusField = h(
    "div",
    { class: "field" },
    h("label", { for: "draw-radius" }, t("Radius")),
    h("div", { class: "with-unit" }, this.#radius, h("span", { class: "unit" }, "m")),
  );
  /** @type {EditorState | null} */
  #now = null;
  /** Figures from the server. @type {Fault | null} */
  #reported = null;

  /** @param {Editor} editor @param {ShowPlace} show */
  constructor(editor, show) {
    this.#show = show;
    this.#tools = toolsOf(editor);
    this.#vertices = createVertexTable(editor, show);
    this.#radius.addEventListener("change", () => editor.setRadius(Number(this.#radius.value)));
    this.element = h(
      "div",
      { class: "draw-panel" },
      h("div", { class: "draw-tools", role: "toolbar", "aria-label": t("Drawing") }, Object.values(this.#tools)),
      this.#ask,
      this.#figures,
      this.#coming,
      this.#radiusField,
      this.#faults,
      this.#vertices.element,
    );
  }

  /** @param {EditorState} state */
  update(state) {
    this.#now = state;
    this.#reported = null;
    this.#draw();
  }

  /** Show figures of the shape with a vertex at the pointer. @param {Shape} shape */
  preview(shape) {
    this.#coming.textContent = figuresOf(shape);
    this.#coming.hidden = false;
    this.#figures.hidden = true;
  }

  /** Shows what the server found. @param {{ fault: { message: string, position: number[] | null } | null } & Figures} found */
  showCheck({ fault, length_m, area_m2 }) {
    this.#reported = fault && {
      message: `${fault.message[0].toUpperCase()}${fault.message.slice(1)}.`,
      position: fault.position,
      sides: [],
    };
    this.#draw();
    if (this.#now?.shape) this.#figures.textContent = figuresOf(this.#now.shape, { length_m, area_m2 });
  }

  #draw() {
    const state = this.#now;
    if (!state?.shape) return;
    const { shape, isDrawing, isMoving } = state;
    showTools(this.#tools, state, shape);
    const hold = shape.kind === "line" || shape.kind === "area" ? HOLD : "";
    this.#ask.textContent = isDrawing ? ASK[shape.kind] : isMoving ? MOVING : HINTS[shape.kind] + hold;
    this.#figures.textContent = figuresOf(shape);
    this.#coming.hidden = true;
    this.#figures.hidden = false;
    this.#radiusField.hidden = !circleOf(shape);
    if (document.activeElement !== this.#radius) this.#radius.value = String(shape.radius_m ?? "");
    this.#faults.replaceChildren(
      ...this.#wrong(state)
        .slice(0, MAX_FAULTS)
        .map((fault) => this.#faultLine(fault)),
    );
    this.#vertices.update(state);
  }

  /** @param {EditorState} state @returns {Fault[]} */
  #wrong({ isDrawing, faults }) {
    if (isDrawing) return faults.filter((fault) => fault.sides.length);
    return faults.length || !this.#reported ? faults : [this.#reported];
  }

  /** @param {Fault} fault */
  #faultLine({ message, position }) {
    const see = position && (() => this.#show(position));
    const link = see && h("button", { type: "button", class: "text-button", onclick: see }, t("See the place"));
    return h("p", { class: "field-error" }, icon("circle-alert", "small"), h("span", {}, message, " ", link));
  }
}

/** The tools in their order. @param {Editor} editor */
function toolsOf(editor) {
  const moving = { title: t("Move the whole shape by dragging, or with the arrow keys") };
  return {
    undo: tool(t("Undo (Ctrl+Z)"), "undo-2", editor.undo),
    redo: tool(t("Redo (Ctrl+Shift+Z)"), "redo-2", editor.redo),
    finish: button(t("Finish"), "check", editor.finish),
    hole: button(t("Hole"), "circle-dashed", editor.startHole, { title: t("Draw a hole in the area") }),
    part: button(t("Part"), "plus", editor.startPart, { title: t("Draw another part of the area") }),
    move: button(t("Move"), "hand", () => editor.moveWhole(!editor.isMoving), moving),
    remove: button(t("Remove point"), "trash-2", editor.removeChosen),
    removeRing: button(t("Remove hole"), "trash-2", editor.removeRing),
  };
}

/** Show the tools that have an effect now. @param {ReturnType<typeof toolsOf>} tools @param {EditorState} state @param {Shape} shape */
function showTools(tools, { isDrawing, isMoving, chosen, canUndo, canRedo }, shape) {
  const isWhole = shape.kind === "point" || shape.kind === "circle"; // drawn with one or two clicks, moved by its handle
  const hasNoParts = shape.kind !== "area" || isDrawing;
  tools.undo.disabled = !canUndo;
  tools.redo.disabled = !canRedo;
  tools.finish.hidden = !isDrawing || isWhole;
  tools.hole.hidden = hasNoParts;
  tools.part.hidden = hasNoParts;
  tools.move.hidden = isDrawing || isWhole;
  tools.move.setAttribute("aria-pressed", String(isMoving));
  tools.remove.hidden = !chosen || isDrawing || removeVertex(shape, chosen) === shape;
  tools.removeRing.hidden = !chosen || isDrawing || removeRing(shape, chosen) === shape;
  const words = chosen && chosen[1] > 0 ? t("Remove hole") : t("Remove part");
  if (tools.removeRing.lastChild) tools.removeRing.lastChild.textContent = words;
}

/** @param {Shape} shape @param {Figures} [exact] */
function figuresOf(shape, exact = {}) {
  const rough = measure(shape);
  const [length_m, area_m2] = [exact.length_m ?? rough.length_m, exact.area_m2 ?? rough.area_m2];
  const circle = circleOf(shape);
  const hasPoints = shape.kind === "line" || shape.kind === "area";
  return [
    circle && t("{radius} radius", { radius: lengthText(circle.radius_m) }),
    length_m && lengthText(length_m),
    area_m2 && areaText(area_m2),
    hasPoints && tn(verticesOf(shape).length, "{count} point", "{count} points"),
  ]
    .filter(Boolean)
    .join(", ");
}
