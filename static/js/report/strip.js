/** A UAV's flight pulled straight over time: measured solid, estimated dotted, silence empty, targets where it was at them, alerts above. */

import { svg } from "../dom.js";
import { colourClass } from "../domain/palette.js";
import { lastOf } from "../record/track.js";

/** @import { Estimate, Sample, Track } from "../record/track.js" */
/** @import { ReachedTarget, StripAlert } from "./types.d.ts" */

const HEIGHT_PX = 34;
const MIDDLE_PX = 20;
const APART_PX = 19; // of two targets
const MARKS = {
  critical: "M-3 -5H3L5 -3V3L3 5H-3L-5 3V-3Z",
  warning: "M0 -5L5.5 4.5H-5.5Z",
  advisory: "M0 -4A4 4 0 1 1 0 4A4 4 0 1 1 0 -4Z",
};

/**
 * Pushes places apart to the right, then back from the right edge: as near to where they belong as there is room.
 *
 * @param {readonly number[]} places
 * @param {number} width_px
 * @param {number} [apart_px]
 */
export function spread(places, width_px, apart_px = APART_PX) {
  const least = Math.min(apart_px, width_px / Math.max(1, places.length));
  const put = [...places];
  for (let at = 1; at < put.length; at += 1) put[at] = Math.max(put[at], put[at - 1] + least);
  for (let at = put.length - 1, right = width_px; at >= 0; at -= 1, right -= least) put[at] = Math.min(put[at], right);
  return put;
}

/**
 * @param {object} flown
 * @param {number} flown.colour number of it
 * @param {Track} flown.track
 * @param {readonly ReachedTarget[]} flown.targets by time
 * @param {readonly StripAlert[]} flown.alerts
 * @param {(at_ms: number) => number} flown.x
 * @param {number} flown.width_px
 * @param {string} flown.label
 */
export function drawStrip({ colour, track, targets, alerts, x, width_px, label }) {
  /** @param {number} at_ms */
  const isAirborne = (at_ms) => track.flights.some(({ from_ms, to_ms }) => from_ms <= at_ms && at_ms <= to_ms);
  /** @param {[Sample | Estimate, ...(Sample | Estimate)[]]} run @param {string} name */
  const line = (run, name) => {
    const [from, to] = [x(run[0].at_ms), x(lastOf(run).at_ms)];
    return svg("line", { class: name, x1: from, x2: Math.max(to, from + 1), y1: MIDDLE_PX, y2: MIDDLE_PX });
  };
  const flown = track.measured.flatMap((run) => piecesOf(run, isAirborne));
  const places = spread(
    targets.map(({ at_ms }) => x(at_ms)),
    width_px,
  );
  return svg(
    "svg",
    {
      class: `replay-strip ${colourClass(colour)}`,
      role: "img",
      "aria-label": label,
      width: width_px,
      height: HEIGHT_PX,
      viewBox: `0 0 ${width_px} ${HEIGHT_PX}`,
    },
    flown.map(({ run, isUp }) => line(run, isUp ? "flown" : "grounded")),
    track.estimated.map((run) => line(run, "estimated")),
    track.flights
      .flatMap(({ from_ms, to_ms }) => [from_ms, to_ms])
      .map((at) => svg("rect", { class: "replay-base", x: x(at) - 4, y: MIDDLE_PX - 4, width: 8, height: 8 })),
    targets.map(({ number, state, title }, index) =>
      svg(
        "g",
        { class: `replay-target ${state}`, transform: `translate(${places[index]} ${MIDDLE_PX})` },
        svg("title", {}, title),
        svg("circle", { r: 9 }),
        svg("text", { y: 4 }, number),
      ),
    ),
    alerts.map(({ at_ms, level, title }) =>
      svg(
        "g",
        { class: `replay-alert ${level}`, transform: `translate(${x(at_ms)} 6)` },
        svg("title", {}, title),
        svg("path", { d: MARKS[level] }),
      ),
    ),
  );
}

/**
 * A run divided where the UAV takes off or lands.
 *
 * @param {Sample[]} run
 * @param {(at_ms: number) => boolean} isAirborne
 */
function piecesOf(run, isAirborne) {
  /** @type {{ isUp: boolean, run: [Sample, ...Sample[]] }[]} */
  const pieces = [];
  for (const sample of run) {
    const isUp = isAirborne(sample.at_ms);
    const last = pieces.at(-1);
    if (last) last.run.push(sample);
    if (!last || last.isUp !== isUp) pieces.push({ isUp, run: [sample] });
  }
  return pieces;
}
