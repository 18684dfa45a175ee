/** One value of all UAVs over the time of a replay: flown, planned, and a dot at the cursor. */

import { svg } from "../dom.js";
import { colourClass } from "../domain/palette.js";
import { rulesOf } from "../record/timeline.js";

/** @import { TimedValue } from "../record/track.js" */

/** @typedef {(value: number) => number} ToPixels */
/** @typedef {{ place: number, colour: number, lines: readonly [TimedValue, ...TimedValue[]][], planned: TimedValue[] }} Series of one UAV */

const TOP_PX = 6;
const BOTTOM_PX = 3;

/** @param {TimedValue[]} line @param {ToPixels} x @param {ToPixels} y */
const points = (line, x, y) =>
  line.map(({ at_ms, value }) => `${x(at_ms).toFixed(1)},${y(value).toFixed(1)}`).join(" ");

/**
 * @param {object} options
 * @param {Series[]} options.series
 * @param {ToPixels} options.x of a moment
 * @param {number} options.width_px
 * @param {number} options.height_px
 * @param {number} options.unit size of one of the reader's units in the stored unit
 * @param {number | null} [options.highest] of the scale, or null for the greatest value
 * @param {(value: number) => string} options.ruleText
 * @param {string} options.label
 */
export function drawChart({ series, x, width_px, height_px, unit, highest = null, ruleText, label }) {
  const values = series.flatMap(({ lines, planned }) =>
    [...lines, planned].flatMap((line) => line.map(({ value }) => value)),
  );
  const top = highest ?? Math.max(unit, ...values);
  const bottom = Math.min(0, ...values);
  /** @type {ToPixels} */
  const y = (value) => TOP_PX + ((top - value) / (top - bottom)) * (height_px - TOP_PX - BOTTOM_PX);
  const rules = rulesOf(top / unit).map((rule) => rule * unit);
  const dots = new Map(
    series.map(({ place, colour }) => [
      place,
      svg("circle", { class: `replay-dot ${colourClass(colour)}`, r: 3.5, visibility: "hidden" }),
    ]),
  );
  const element = svg(
    "svg",
    {
      class: "replay-chart",
      role: "img",
      "aria-label": label,
      width: width_px,
      height: height_px,
      viewBox: `0 0 ${width_px} ${height_px}`,
    },
    [0, ...rules].map((rule) => svg("line", { class: "replay-rule", x1: 0, x2: width_px, y1: y(rule), y2: y(rule) })),
    series.map(
      ({ place, planned }) =>
        planned.length > 1 &&
        svg("polyline", { class: "replay-planned", "data-place": place, points: points(planned, x, y) }),
    ),
    series.map(({ place, colour, lines }) =>
      svg(
        "g",
        { class: `replay-flown ${colourClass(colour)}`, "data-place": place },
        lines.map((line) => svg("polyline", { points: points(line.length > 1 ? line : [line[0], line[0]], x, y) })),
      ),
    ),
    rules.map((rule) => svg("text", { class: "replay-tick", x: 0, y: y(rule) - 2 }, ruleText(rule))),
    [...dots.values()],
  );
  return {
    element,
    /** @param {Map<number, TimedValue>} at by the UAV's place */
    point(at) {
      for (const [place, dot] of dots) {
        const known = at.get(place);
        dot.setAttribute("visibility", known ? "visible" : "hidden");
        if (!known) continue;
        dot.setAttribute("cx", `${x(known.at_ms)}`);
        dot.setAttribute("cy", `${y(known.value)}`);
      }
    },
  };
}
