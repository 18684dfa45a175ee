/** What stands beside a drawing: tools, how long or large it is, what is wrong, and its vertices as a table for keys and screen readers. */

import { h, icon } from "../dom.js";
import { areaText, lengthText } from "../units.js";
import { measure } from "./measure.js";
import { circleOf, verticesOf } from "./shape.js";

const MOST_ROWS = 200;
const ASK = {
  point: "Click where it stands.",
  line: "Click along the line; Enter or a click on the last point ends it.",
  area: "Click round the area; Enter or a click on the first point closes it.",
  circle: "Click the centre, then how far it reaches.",
};

const button = (words, name, act, rest = {}) => h("button", { type: "button", class: "button", onclick: act, ...rest }, icon(name, "small"), words);
const tool = (words, name, act) => h("button", { type: "button", class: "icon-button", "aria-label": words, title: words, onclick: act }, icon(name));

/** Returns { element, update(state), serverFault(fault or null) }; show(position) moves the map. */
export function createDrawPanel(editor, { show }) {
  const undo = tool("Undo (Ctrl+Z)", "undo-2", () => editor.undo());
  const redo = tool("Redo (Ctrl+Shift+Z)", "redo-2", () => editor.redo());
  const finish = button("Finish", "check", () => editor.finish());
  const hole = button("Hole", "circle-dashed", () => editor.startHole(), { title: "Draw a hole in the area" });
  const part = button("Part", "plus", () => editor.startPart(), { title: "Draw another part of the area" });
  const remove = button("Remove point", "trash-2", () => editor.removeChosen());
  const ask = h("p", { class: "caption" });
  const figures = h("p", { class: "draw-figures", role: "status" });
  const faults = h("div", { class: "draw-faults" });
  const rows = h("tbody", {});
  const radius = h("input", { class: "input", id: "draw-radius", type: "number", min: 1, max: 500_000, step: 1, onchange: (event) => editor.setRadius(Number(event.target.value)) });
  const radiusField = h("div", { class: "field" }, h("label", { for: "draw-radius" }, "Radius"), h("div", { class: "with-unit" }, radius, h("span", { class: "unit" }, "m")));
  const table = h(
    "details",
    { class: "draw-vertices" },
    h("summary", {}, "Points"),
    h("table", {}, h("caption", { class: "unseen" }, "Points with longitude and latitude in degrees"), h("thead", {}, h("tr", {}, h("th", { scope: "col" }, "Point"), h("th", { scope: "col" }, "Longitude"), h("th", { scope: "col" }, "Latitude"))), rows),
  );
  table.addEventListener("toggle", () => table.open && fill());
  let now = null;
  let told = null; // what the server says

  function fill() {
    const vertices = now?.shape ? verticesOf(now.shape) : [];
    rows.replaceChildren(
      ...vertices.slice(0, MOST_ROWS).map(({ at, position }, index) =>
        h(
          "tr",
          { class: now.chosen?.join() === at.join() ? "chosen" : "" },
          h("th", { scope: "row" }, h("button", { type: "button", class: "text-button", onclick: () => (editor.choose(at), show(position)) }, String(index + 1))),
          ...position.map((degrees, axis) =>
            h("td", {}, h("input", {
              class: "input", type: "number", step: "0.00001", value: String(degrees), "aria-label": `${axis ? "Latitude" : "Longitude"} of point ${index + 1}`,
              onchange: (event) => {
                const value = Number(event.target.value);
                if (Number.isFinite(value) && Math.abs(value) <= (axis ? 90 : 180)) editor.put(at, axis ? [position[0], value] : [value, position[1]]);
                else event.target.value = String(degrees);
              },
            })),
          ),
        ),
      ),
      ...(vertices.length > MOST_ROWS ? [h("tr", {}, h("td", { colspan: 3 }, `${vertices.length - MOST_ROWS} more are on the map.`))] : []),
    );
  }

  function draw() {
    const { shape, isDrawing, chosen } = now;
    if (!shape) return;
    const isArea = shape.kind === "area";
    undo.disabled = !now.canUndo;
    redo.disabled = !now.canRedo;
    finish.hidden = !isDrawing || shape.kind === "point" || shape.kind === "circle";
    hole.hidden = part.hidden = !isArea || isDrawing;
    remove.hidden = !chosen || isDrawing;
    ask.hidden = !isDrawing;
    ask.textContent = ASK[shape.kind];
    const { length_m, area_m2 } = measure(shape);
    const number = verticesOf(shape).length;
    figures.textContent = [
      shape.kind === "circle" && circleOf(shape) && `${lengthText(shape.radius_m)} radius`, length_m && lengthText(length_m), area_m2 && areaText(area_m2),
      ["line", "area"].includes(shape.kind) && `${number} ${number === 1 ? "point" : "points"}`,
    ].filter(Boolean).join(", ");
    radiusField.hidden = !circleOf(shape);
    if (document.activeElement !== radius) radius.value = String(shape.radius_m ?? "");
    const wrong = isDrawing ? now.faults.filter((fault) => fault.sides.length) : now.faults.length ? now.faults : told ? [told] : [];
    faults.replaceChildren(
      ...wrong.slice(0, 5).map((fault) =>
        h("p", { class: "field-error" }, icon("circle-alert", "small"), h("span", {}, fault.message, " ", fault.position && h("button", { type: "button", class: "text-button", onclick: () => show(fault.position) }, "See the place"))),
      ),
    );
    if (table.open && !table.contains(document.activeElement)) fill();
  }

  return {
    element: h("div", { class: "draw-panel" }, h("div", { class: "draw-tools", role: "toolbar", "aria-label": "Drawing" }, undo, redo, finish, hole, part, remove), ask, figures, radiusField, faults, table),
    update(state) {
      now = state;
      told = null;
      if (state.shape) draw();
    },
    serverFault(fault) {
      told = fault && { ...fault, sides: [] };
      draw();
    },
  };
}
