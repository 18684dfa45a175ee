/** Position of a UAV at any moment, interpolated between samples. Values in, values out. */

import { turn_deg } from "../cameras/vectors.js";

/** @import { Bound, FlightSample, Moment, Piece } from "../types.d.ts" */

export const MEASURED = "measured";
export const ESTIMATED = "estimated";
export const PLANNED = "planned";
export const LOST = "lost"; // the position by now is unknown: use the last one

/** @type {("altitude_amsl_m" | "altitude_relative_m" | "speed_mps" | "climb_mps" | "battery_percent" | "roll_deg" | "pitch_deg")[]} */
const NUMBERS = [
  "altitude_amsl_m",
  "altitude_relative_m",
  "speed_mps",
  "climb_mps",
  "battery_percent",
  "roll_deg",
  "pitch_deg",
];
const NO_BOUND = { along_m: 0, across_m: 0, bearing_deg: 0, height_m: 0 }; // at a report

/** @param {Piece} piece */
export const firstOf = ({ samples }) => samples[0];
/** @param {Piece} piece */
export const lastOf = ({ samples }) => samples[samples.length - 1];

/**
 * The state of a UAV at a moment: numbers interpolated, headings the short way; null before the first sample. In a silence, and after the
 * last sample, it is LOST at its last place; after a landing it stays there.
 *
 * @param {readonly Piece[]} pieces by time
 * @param {number} at_ms
 * @returns {Moment | null}
 */
export function momentOf(pieces, at_ms) {
  /** @type {Piece | null} */
  let last = null;
  for (const piece of pieces) {
    if (firstOf(piece).at_ms > at_ms) break;
    last = piece;
    if (at_ms <= lastOf(piece).at_ms) return at(piece, at_ms);
  }
  if (!last) return null;
  const sample = lastOf(last);
  return {
    ...sample,
    kind: sample.isInAir === false || last.kind === PLANNED ? last.kind : LOST,
    since_ms: sample.at_ms,
    speed_mps: 0,
    climb_mps: 0,
    isOver: true,
  };
}

/** @param {Piece} piece @param {number} at_ms @returns {Moment} */
function at({ kind, samples }, at_ms) {
  const after = samples[indexAfter(samples, at_ms)];
  const before = samples[Math.max(0, samples.indexOf(after) - 1)];
  if (after === before || after.at_ms === before.at_ms) return { ...after, kind, since_ms: after.at_ms };
  const share = (at_ms - before.at_ms) / (after.at_ms - before.at_ms);
  /** @type {Moment} */
  const mixed = {
    ...before,
    kind,
    at_ms,
    since_ms: before.at_ms,
    position: [0, 1].map((axis) => before.position[axis] + (after.position[axis] - before.position[axis]) * share),
  };
  for (const name of NUMBERS) {
    const [from, to] = [before[name], after[name]];
    mixed[name] = isKnown(from) && isKnown(to) ? from + (to - from) * share : (from ?? null);
  }
  if (isKnown(before.heading_deg) && isKnown(after.heading_deg))
    mixed.heading_deg = (before.heading_deg + turn_deg(before.heading_deg, after.heading_deg) * share + 360) % 360;
  mixed.bound = kind === ESTIMATED ? boundBetween(before.bound ?? NO_BOUND, after.bound ?? NO_BOUND, share) : null;
  return mixed;
}

/** @param {Bound} before @param {Bound} after @param {number} share */
function boundBetween(before, after, share) {
  /** @param {"along_m" | "across_m" | "height_m"} name */
  const part = (name) => (before[name] ?? 0) + ((after[name] ?? 0) - (before[name] ?? 0)) * share;
  return {
    along_m: part("along_m"),
    across_m: part("across_m"),
    height_m: part("height_m"),
    bearing_deg: share < 0.5 ? before.bearing_deg : after.bearing_deg,
  };
}

/** @param {number | null | undefined} value @returns {value is number} */
const isKnown = (value) => typeof value === "number" && Number.isFinite(value);

/** Number of the first sample at or after a moment. @param {readonly FlightSample[]} samples @param {number} at_ms */
function indexAfter(samples, at_ms) {
  let [low, high] = [0, samples.length - 1];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (samples[middle].at_ms < at_ms) low = middle + 1;
    else high = middle;
  }
  return low;
}

const METRES_PER_DEGREE = 111_195; // of latitude, on a sphere: only for courses and speeds between neighbours

/**
 * From one place to another: { metres, bearing_deg }, over a second's flight exact enough for a nose.
 *
 * @param {readonly number[]} from
 * @param {readonly number[]} to
 */
export function stepOf([lon, lat], [toLon, toLat]) {
  const east_m = (toLon - lon) * METRES_PER_DEGREE * Math.cos(((lat + toLat) / 2) * (Math.PI / 180));
  const north_m = (toLat - lat) * METRES_PER_DEGREE;
  return {
    metres: Math.hypot(east_m, north_m),
    bearing_deg: ((Math.atan2(east_m, north_m) * 180) / Math.PI + 360) % 360,
  };
}

/**
 * Complete samples without a heading, a speed or a climb by those of the leg to the next; one that stands keeps its heading.
 *
 * @param {readonly FlightSample[]} samples
 * @returns {FlightSample[]}
 */
export function completed(samples) {
  /** @type {number | null} */
  let heading_deg = null;
  const found = samples.map((sample, index) => {
    const next = samples[index + 1];
    const seconds = next ? (next.at_ms - sample.at_ms) / 1_000 : 0;
    const step = next && seconds > 0 ? stepOf(sample.position, next.position) : null;
    heading_deg = isKnown(sample.heading_deg)
      ? sample.heading_deg
      : step && step.metres > 0.3
        ? step.bearing_deg
        : heading_deg;
    const climb =
      step && isKnown(sample.altitude_relative_m) && isKnown(next.altitude_relative_m)
        ? (next.altitude_relative_m - sample.altitude_relative_m) / seconds
        : null;
    return {
      ...sample,
      heading_deg,
      speed_mps: isKnown(sample.speed_mps) ? sample.speed_mps : step ? step.metres / seconds : 0,
      climb_mps: isKnown(sample.climb_mps) ? sample.climb_mps : climb,
    };
  });
  const first = found.find((sample) => sample.heading_deg !== null)?.heading_deg ?? 0;
  return found.map((sample) => (sample.heading_deg === null ? { ...sample, heading_deg: first } : sample));
}
