/** The vertices of a drawing as a table, for keys and screen readers. */

import { find, h } from "../dom.js";
import { t, tn } from "../text.js";
import { positionAt, verticesOf } from "./shape.js";

/** @import { ShowPlace } from "./draw_panel.js" */
/** @import { Editor } from "./editor.js" */
/** @import { EditorState, Shape, VertexPath } from "./types.d.ts" */

const MAX_ROWS = 200;

/** @param {Editor} editor @param {ShowPlace} show */
export const createVertexTable = (editor, show) => new VertexTable(editor, show);

class VertexTable {
  #editor;
  #show;
  #rows = h("tbody", {});
  #rest = h("p", { class: "caption", hidden: true });
  #addPoint = h(
    "button",
    { type: "button", class: "text-button add-point" },
    t("Add a point in the middle of the map"),
  );
  /** @type {Shape | null} */
  #shape = null;
  /** @type {VertexPath | null} */
  #chosen = null;

  /** @param {Editor} editor @param {ShowPlace} show */
  constructor(editor, show) {
    this.#editor = editor;
    this.#show = show;
    this.#addPoint.addEventListener("click", editor.addInMiddle);
    const columns = [t("Point"), t("Longitude"), t("Latitude")].map((words) => h("th", { scope: "col" }, words));
    this.element = h(
      "details",
      { class: "draw-vertices", ontoggle: () => this.#fill() },
      h("summary", {}, t("Points")),
      h("p", { class: "caption" }, t("Choose a point by its number; the arrow keys then move it, Del removes it.")),
      h(
        "table",
        {},
        h("caption", { class: "unseen" }, t("Points with longitude and latitude in degrees")),
        h("thead", {}, h("tr", {}, columns)),
        this.#rows,
      ),
      this.#rest,
      this.#addPoint,
    );
  }

  /** @param {EditorState} state */
  update({ shape, chosen, isDrawing }) {
    this.#shape = shape;
    this.#chosen = chosen;
    this.#addPoint.hidden = !isDrawing;
    this.#fill();
  }

  /** Rows stay while there are as many: focus stays where it is. */
  #fill() {
    if (!this.#shape || !this.element.open) return;
    const vertices = verticesOf(this.#shape);
    const listed = vertices.slice(0, MAX_ROWS);
    while (this.#rows.rows.length > listed.length) this.#rows.lastElementChild?.remove();
    while (this.#rows.rows.length < listed.length) this.#rows.append(this.#rowOf(this.#rows.rows.length));
    for (const [index, { at, position }] of listed.entries()) {
      const row = this.#rows.rows[index];
      const isChosen = this.#chosen?.join() === at.join();
      row.classList.toggle("chosen", isChosen);
      find(row, "button").setAttribute("aria-pressed", String(isChosen));
      for (const [axis, input] of row.querySelectorAll("input").entries()) input.value = String(position[axis]);
    }
    const more = vertices.length - MAX_ROWS;
    this.#rest.hidden = more <= 0;
    this.#rest.textContent = tn(more, "{count} more is on the map.", "{count} more are on the map.");
  }

  /** @param {number} index */
  #rowOf(index) {
    const number = index + 1;
    const choose = () => {
      const { at, position } = this.#vertex(index);
      this.#editor.choose(at);
      this.#show(position);
    };
    return h(
      "tr",
      {},
      h(
        "th",
        { scope: "row" },
        h(
          "button",
          { type: "button", class: "text-button", onclick: choose, "aria-label": t("Point {number}", { number }) },
          String(number),
        ),
      ),
      this.#degrees(index, 0, t("Longitude of point {number}", { number })),
      this.#degrees(index, 1, t("Latitude of point {number}", { number })),
    );
  }

  /** @param {number} index @param {0 | 1} axis longitude, latitude @param {string} label */
  #degrees(index, axis, label) {
    const input = h("input", { class: "input", type: "number", step: "any", "aria-label": label });
    input.addEventListener("change", () => {
      const { at, position } = this.#vertex(index);
      const value = Number(input.value);
      if (input.value === "" || !(Math.abs(value) <= (axis ? 90 : 180))) input.value = String(position[axis]);
      else this.#editor.put(at, axis ? [position[0], value] : [value, position[1]]);
    });
    return h("td", {}, input);
  }

  /** @param {number} index */
  #vertex(index) {
    const shape = /** @type {Shape} */ (this.#shape);
    const { at } = verticesOf(shape)[index];
    return { at, position: positionAt(shape, at) ?? [] };
  }
}
