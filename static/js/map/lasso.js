/** A freehand line round a selection: the ring in lon lat, or nothing where it encloses too little. */

import { svg } from "../dom.js";
import { swallowDrawnClick } from "./drawn_click.js";

/** @import { MapLibreMap, Position } from "./types.d.ts" */

const DRAWS = ["lasso", "zone"]; // tools
const STEP_PX = 4; // between kept points
const MIN_PX = 24; // a smaller drawing was a click

/**
 * on: { tool(), lasso([[lon, lat], …]) }
 *
 * @param {MapLibreMap} map
 * @param {HTMLElement} canvas
 * @param {{ tool: () => string, lasso: (ring: Position[]) => unknown }} on
 */
export function drawLassos(map, canvas, on) {
  /** @type {Position[] | null} */
  let points = null; // on the screen
  const line = svg("polygon", {});
  const drawing = svg("svg", { class: "lasso-frame", "aria-hidden": "true" }, line);
  const click = swallowDrawnClick(canvas);

  /** @param {PointerEvent} event @returns {Position} */
  const placeOf = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };

  /** End the drawing; returns the line, or null. */
  function stop() {
    if (!points) return null;
    const drawn = points;
    points = null;
    drawing.remove();
    map.dragPan.enable();
    return drawn;
  }

  canvas.addEventListener(
    "pointerdown",
    (event) => {
      click.begins();
      if (event.button !== 0 || !DRAWS.includes(on.tool()) || event.shiftKey || !event.isPrimary) return;
      event.stopPropagation();
      event.preventDefault();
      map.dragPan.disable();
      points = [placeOf(event)];
      line.setAttribute("points", "");
      canvas.append(drawing);
      canvas.setPointerCapture(event.pointerId);
    },
    true,
  );
  canvas.addEventListener("pointermove", (event) => {
    if (!points) return;
    const [x, y] = placeOf(event);
    const [lastX, lastY] = points[points.length - 1];
    if (Math.hypot(x - lastX, y - lastY) < STEP_PX) return;
    points.push([x, y]);
    line.setAttribute("points", points.map((point) => point.join(",")).join(" "));
  });
  canvas.addEventListener("pointerup", () => {
    const drawn = stop();
    if (!drawn || !isWide(drawn)) return;
    click.ends();
    on.lasso(drawn.map((point) => map.unproject(point)).map(({ lng, lat }) => [lng, lat]));
  });
  canvas.addEventListener("pointercancel", stop);
  addEventListener(
    "keydown",
    (event) => {
      if (event.key === "Escape" && stop()) click.ends();
    },
    true,
  );
}

/** Whether a drawing is wide enough to enclose an area. @param {readonly (readonly number[])[]} points */
export function isWide(points) {
  /** @param {number[]} values */
  const spanOf = (values) => Math.max(...values) - Math.min(...values);
  return points.length > 2 && spanOf(points.map(([x]) => x)) + spanOf(points.map(([, y]) => y)) > MIN_PX;
}
