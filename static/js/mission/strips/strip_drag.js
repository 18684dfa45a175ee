/** Dragging pills of the strips to another place or to another UAV, by mouse and by touch. */

import { h } from "../../dom.js";

/** @import { Grab, Strip } from "./span_strip.js" */

/** @typedef {{ row: HTMLElement, sequence: number, index: number }} Place among the targets of a route */
/**
 * @typedef {object} Drag
 * @property {number} pointerId
 * @property {string[]} keys
 * @property {string} label
 * @property {string} colour
 * @property {number} x where it began [px]
 * @property {number} y
 * @property {HTMLElement | null} ghost
 * @property {Place | null} place
 */

const MIN_PX = 5; // less is a click

/**
 * rows: the list of routes. strips: Map of sequence → result of spanStrip. drop(keys, { sequence, index }).
 *
 * Returns grab(event, keys, label) for a pill that is pressed. Escape, or a drop beside the routes, changes nothing.
 *
 * @param {HTMLElement} rows
 * @param {{ strips: Map<number, Strip>, drop: (keys: string[], place: { sequence: number, index: number }) => void }} options
 */
export function createPillDrag(rows, { strips, drop }) {
  /** @type {Drag | null} */
  let drag = null;

  /** @param {number} x @param {number} y @param {string[]} keys */
  function placeUnder(x, y, keys) {
    const row = /** @type {HTMLElement | null | undefined} */ (document.elementFromPoint(x, y)?.closest(".route"));
    if (!row || !rows.contains(row)) return null;
    const sequence = Number(row.dataset.sequence);
    return { row, sequence, index: strips.get(sequence)?.indexAt(x, keys) ?? 0 };
  }

  /** @param {Place | null} place @param {string[]} keys */
  function show(place, keys) {
    for (const row of rows.children) row.classList.toggle("takes", row === place?.row);
    for (const [sequence, strip] of strips) strip.showGap(sequence === place?.sequence ? place.index : null, keys);
  }

  /** @param {PointerEvent} event */
  function move(event) {
    if (event.pointerId !== drag?.pointerId) return;
    if (!drag.ghost) {
      if (Math.hypot(event.clientX - drag.x, event.clientY - drag.y) < MIN_PX) return;
      drag.ghost = h("div", { class: `pill strip-ghost ${drag.colour}`, "aria-hidden": "true" }, drag.label);
      document.body.append(drag.ghost);
      rows.classList.add("dragging");
    }
    drag.ghost.style.translate = `${event.clientX}px ${event.clientY}px`;
    drag.place = placeUnder(event.clientX, event.clientY, drag.keys);
    show(drag.place, drag.keys);
  }

  function end() {
    if (drag) show(null, drag.keys);
    drag?.ghost?.remove();
    rows.classList.remove("dragging");
    removeEventListener("pointermove", move, true);
    removeEventListener("pointerup", release, true);
    removeEventListener("pointercancel", end, true);
    removeEventListener("keydown", escapeDrag, true);
    drag = null;
  }

  /** @param {PointerEvent} event */
  function release(event) {
    if (event.pointerId !== drag?.pointerId) return;
    const { keys, place, ghost } = drag;
    end();
    if (ghost && place) drop(keys, { sequence: place.sequence, index: place.index });
  }

  /** @param {KeyboardEvent} event */
  function escapeDrag(event) {
    if (event.key !== "Escape") return;
    event.preventDefault();
    event.stopPropagation();
    end();
  }

  /** @type {Grab} */
  return function grab(event, keys, label) {
    if (drag || event.button !== 0) return;
    const pill = /** @type {Element} */ (event.currentTarget);
    const colour = [...(pill.closest(".route")?.classList ?? [])].find((name) => /^route-\d/.test(name)) ?? "";
    if (pill.hasPointerCapture?.(event.pointerId)) pill.releasePointerCapture(event.pointerId); // the row may be redrawn meanwhile
    event.preventDefault();
    drag = {
      pointerId: event.pointerId,
      keys,
      label,
      colour,
      x: event.clientX,
      y: event.clientY,
      ghost: null,
      place: null,
    };
    addEventListener("pointermove", move, true);
    addEventListener("pointerup", release, true);
    addEventListener("pointercancel", end, true);
    addEventListener("keydown", escapeDrag, true);
  };
}
