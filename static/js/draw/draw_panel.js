/** What stands beside a drawing: tools, how long or large it is, what is wrong, and its vertices as a table for keys and screen readers. */

import { h, icon } from "../dom.js";
import { measure } from "../domain/geodesy.js";
import { t, tn } from "../text.js";
import { areaText, lengthText } from "../units.js";
import { circleOf, positionAt, removeRing as removeRingOf, removeVertex, verticesOf } from "./shape.js";

const MOST_ROWS = 200;
const ASK = {
  point: t("Click where it stands."),
  line: t("Click along the line; Enter or a click on the last point ends it."),
  area: t("Click round the area; Enter or a click on the first point closes it."),
  circle: t("Click the centre, then how far it reaches."),
};

const HINTS = {
  point: t("Drag it to its place, or write where it stands under Points."),
  line: t("Drag a point; drag the small one between two to add another."),
  area: t("Drag a point; drag the small one between two to add another."),
  circle: t("Drag the centre, or the point on the rim."),
};
const HOLD = matchMedia("(pointer: coarse)").matches
  ? ` ${t("Hold a point to remove it.")}`
  : ` ${t("Alt-click removes one; with Ctrl or Alt nothing snaps.")}`;
const MOVING = t("Drag the whole shape, or move it with the arrow keys.");

const button = (words, name, act, rest = {}) =>
  h("button", { type: "button", class: "button", onclick: act, ...rest }, icon(name, "small"), words);
const tool = (words, name, act) =>
  h("button", { type: "button", class: "icon-button", "aria-label": words, title: words, onclick: act }, icon(name));

/** Returns { element, update(state), preview(shape), verdict(of the server) }; show(position) moves the map. */
export function createDrawPanel(editor, { show }) {
  const undo = tool(t("Undo (Ctrl+Z)"), "undo-2", () => editor.undo());
  const redo = tool(t("Redo (Ctrl+Shift+Z)"), "redo-2", () => editor.redo());
  const finish = button(t("Finish"), "check", () => editor.finish());
  const hole = button(t("Hole"), "circle-dashed", () => editor.startHole(), { title: t("Draw a hole in the area") });
  const part = button(t("Part"), "plus", () => editor.startPart(), { title: t("Draw another part of the area") });
  const move = button(t("Move"), "hand", () => editor.moveWhole(!now.isMoving), {
    title: t("Move the whole shape by dragging, or with the arrow keys"),
  });
  const remove = button(t("Remove point"), "trash-2", () => editor.removeChosen());
  const removeRing = button(t("Remove hole"), "trash-2", () => editor.removeRing());
  const ask = h("p", { class: "caption" });
  const figures = h("p", { class: "draw-figures", role: "status" });
  const coming = h("p", { class: "draw-figures", "aria-hidden": "true", hidden: true }); // follows the pointer: not read out
  const faults = h("div", { class: "draw-faults" });
  const rows = h("tbody", {});
  const rest = h("p", { class: "caption", hidden: true });
  const radius = h("input", {
    class: "input",
    id: "draw-radius",
    type: "number",
    min: 1,
    max: 500_000,
    step: 1,
    onchange: (event) => editor.setRadius(Number(event.target.value)),
  });
  const radiusField = h(
    "div",
    { class: "field" },
    h("label", { for: "draw-radius" }, t("Radius")),
    h("div", { class: "with-unit" }, radius, h("span", { class: "unit" }, "m")),
  );
  const table = h(
    "details",
    { class: "draw-vertices" },
    h("summary", {}, t("Points")),
    h("p", { class: "caption" }, t("Choose a point by its number; the arrow keys then move it, Del removes it.")),
    h(
      "table",
      {},
      h("caption", { class: "unseen" }, t("Points with longitude and latitude in degrees")),
      h(
        "thead",
        {},
        h(
          "tr",
          {},
          h("th", { scope: "col" }, t("Point")),
          h("th", { scope: "col" }, t("Longitude")),
          h("th", { scope: "col" }, t("Latitude")),
        ),
      ),
      rows,
    ),
    rest,
    h(
      "button",
      { type: "button", class: "text-button add-point", onclick: () => editor.addInMiddle() },
      t("Add a point in the middle of the map"),
    ),
  );
  const addPoint = table.querySelector(".add-point");
  table.addEventListener("toggle", () => table.open && now?.shape && fill());
  let now = null;
  let told = null; // what the server says

  function rowOf(index) {
    const at = () => verticesOf(now.shape)[index].at;
    const degrees = (axis) =>
      h(
        "td",
        {},
        h("input", {
          class: "input",
          type: "number",
          step: "any",
          "aria-label": axis
            ? t("Latitude of point {number}", { number: index + 1 })
            : t("Longitude of point {number}", { number: index + 1 }),
          onchange: (event) => {
            const position = [...positionAt(now.shape, at())];
            const value = Number(event.target.value);
            if (event.target.value === "" || !(Math.abs(value) <= (axis ? 90 : 180)))
              event.target.value = String(position[axis]);
            else editor.put(at(), axis ? [position[0], value] : [value, position[1]]);
          },
        }),
      );
    const choose = () => {
      editor.choose(at());
      show(positionAt(now.shape, at()));
    };
    return h(
      "tr",
      {},
      h(
        "th",
        { scope: "row" },
        h(
          "button",
          {
            type: "button",
            class: "text-button",
            onclick: choose,
            "aria-label": t("Point {number}", { number: index + 1 }),
          },
          String(index + 1),
        ),
      ),
      degrees(0),
      degrees(1),
    );
  }

  /** Rows stay while there are as many: focus stays where it is. */
  function fill() {
    const vertices = verticesOf(now.shape);
    const listed = vertices.slice(0, MOST_ROWS);
    while (rows.rows.length > listed.length) rows.lastElementChild.remove();
    while (rows.rows.length < listed.length) rows.append(rowOf(rows.rows.length));
    listed.forEach(({ at, position }, index) => {
      const row = rows.rows[index];
      const isChosen = now.chosen?.join() === at.join();
      row.classList.toggle("chosen", isChosen);
      row.querySelector("button").setAttribute("aria-pressed", String(isChosen));
      row.querySelectorAll("input").forEach((input, axis) => (input.value = String(position[axis])));
    });
    rest.hidden = vertices.length <= MOST_ROWS;
    rest.textContent = tn(vertices.length - MOST_ROWS, "{count} more is on the map.", "{count} more are on the map.");
  }

  function draw() {
    const { shape, isDrawing, chosen } = now;
    if (!shape) return;
    const isArea = shape.kind === "area";
    undo.disabled = !now.canUndo;
    redo.disabled = !now.canRedo;
    finish.hidden = !isDrawing || shape.kind === "point" || shape.kind === "circle";
    hole.hidden = part.hidden = !isArea || isDrawing;
    move.hidden = isDrawing || shape.kind === "point" || shape.kind === "circle";
    move.setAttribute("aria-pressed", String(now.isMoving));
    remove.hidden = !chosen || isDrawing || removeVertex(shape, chosen) === shape;
    removeRing.hidden = !chosen || isDrawing || removeRingOf(shape, chosen) === shape;
    removeRing.lastChild.textContent = chosen?.[1] > 0 ? t("Remove hole") : t("Remove part");
    addPoint.hidden = !isDrawing;
    ask.textContent = isDrawing
      ? ASK[shape.kind]
      : now.isMoving
        ? MOVING
        : HINTS[shape.kind] + (["line", "area"].includes(shape.kind) ? HOLD : "");
    figures.textContent = figuresOf(shape);
    coming.hidden = true;
    figures.hidden = false;
    radiusField.hidden = !circleOf(shape);
    if (document.activeElement !== radius) radius.value = String(shape.radius_m ?? "");
    const wrong = isDrawing
      ? now.faults.filter((fault) => fault.sides.length)
      : now.faults.length
        ? now.faults
        : told
          ? [told]
          : [];
    faults.replaceChildren(
      ...wrong
        .slice(0, 5)
        .map((fault) =>
          h(
            "p",
            { class: "field-error" },
            icon("circle-alert", "small"),
            h(
              "span",
              {},
              fault.message,
              " ",
              fault.position &&
                h(
                  "button",
                  { type: "button", class: "text-button", onclick: () => show(fault.position) },
                  t("See the place"),
                ),
            ),
          ),
        ),
    );
    if (table.open) fill();
  }

  const figuresOf = (shape, exact = {}) => {
    const rough = measure(shape);
    const [length_m, area_m2] = [exact.length_m ?? rough.length_m, exact.area_m2 ?? rough.area_m2];
    const number = verticesOf(shape).length;
    return [
      circleOf(shape) && t("{radius} radius", { radius: lengthText(shape.radius_m) }),
      length_m && lengthText(length_m),
      area_m2 && areaText(area_m2),
      ["line", "area"].includes(shape.kind) && `${number} ${number === 1 ? "point" : "points"}`,
    ]
      .filter(Boolean)
      .join(", ");
  };

  return {
    element: h(
      "div",
      { class: "draw-panel" },
      h(
        "div",
        { class: "draw-tools", role: "toolbar", "aria-label": t("Drawing") },
        undo,
        redo,
        finish,
        hole,
        part,
        move,
        remove,
        removeRing,
      ),
      ask,
      figures,
      coming,
      radiusField,
      faults,
      table,
    ),
    update(state) {
      now = state;
      told = null;
      if (state.shape) draw();
    },
    /** Figures of what the shape would be with the pointer where it is. */
    preview(shape) {
      coming.textContent = figuresOf(shape);
      coming.hidden = false;
      figures.hidden = true;
    },
    /** { fault, length_m, area_m2 } as the server found them, on the ellipsoid. */
    verdict({ fault, length_m, area_m2 }) {
      told = fault && {
        message: `${fault.message[0].toUpperCase()}${fault.message.slice(1)}.`,
        position: fault.position,
        sides: [],
      };
      draw();
      figures.textContent = figuresOf(now.shape, { length_m, area_m2 });
    },
  };
}
