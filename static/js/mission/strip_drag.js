/** Dragging pills of the strips to another place or to another UAV, by mouse and by touch. */

import { h } from "../dom.js";

const LEAST_PX = 5; // less is a click

/** rows: the list of routes. strips: Map of sequence → what spanStrip gives. drop(keys, { sequence, index }).
 *
 * Returns grab(event, keys, label) for a pill that is pressed. Escape, or letting go beside the routes, changes nothing.
 */
export function createPillDrag(rows, { strips, drop }) {
  let drag = null; // { keys, label, x, y, ghost, place }

  function placeUnder(x, y) {
    const row = document.elementFromPoint(x, y)?.closest(".route");
    if (!row || !rows.contains(row)) return null;
    const sequence = Number(row.dataset.sequence);
    return { row, sequence, index: strips.get(sequence)?.indexAt(x, drag.keys) ?? 0 };
  }

  function show(place) {
    for (const row of rows.children) row.classList.toggle("takes", row === place?.row);
    for (const [sequence, strip] of strips) strip.showGap(sequence === place?.sequence ? place.index : null, drag.keys);
  }

  function move(event) {
    if (event.pointerId !== drag.pointerId) return;
    if (!drag.ghost) {
      if (Math.hypot(event.clientX - drag.x, event.clientY - drag.y) < LEAST_PX) return;
      drag.ghost = h("div", { class: `pill strip-ghost ${drag.colour}`, "aria-hidden": "true" }, drag.label);
      document.body.append(drag.ghost);
      rows.classList.add("dragging");
    }
    drag.ghost.style.translate = `${event.clientX}px ${event.clientY}px`;
    drag.place = placeUnder(event.clientX, event.clientY);
    show(drag.place);
  }

  function end() {
    show(null);
    drag.ghost?.remove();
    rows.classList.remove("dragging");
    for (const [type, listener] of LISTENERS) removeEventListener(type, listener, true);
    drag = null;
  }

  function release(event) {
    if (event.pointerId !== drag.pointerId) return;
    const { keys, place, ghost } = drag;
    end();
    if (ghost && place) drop(keys, { sequence: place.sequence, index: place.index });
  }

  function escape(event) {
    if (event.key !== "Escape") return;
    event.preventDefault();
    event.stopPropagation();
    end();
  }

  const LISTENERS = [
    ["pointermove", move],
    ["pointerup", release],
    ["pointercancel", end],
    ["keydown", escape],
  ];

  return function grab(event, keys, label) {
    if (drag || event.button !== 0) return;
    const colour = [...event.currentTarget.closest(".route").classList].find((name) => /^route-\d/.test(name)) ?? "";
    if (event.currentTarget.hasPointerCapture?.(event.pointerId))
      event.currentTarget.releasePointerCapture(event.pointerId); // the row may be drawn anew meanwhile
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
    for (const [type, listener] of LISTENERS) addEventListener(type, listener, true);
  };
}
