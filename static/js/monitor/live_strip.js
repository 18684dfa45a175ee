/** The span strip of a flight: the flown part thick, the rest pale, the UAV on it with its 95 % bracket. */

import { svg } from "../dom.js";
import { MEASURED } from "../domain/certainty.js";
import { profileOf } from "../domain/route_profile.js";
import { layOut, scaleOf } from "../mission/strips/span_strip.js";

/** @import { LiveUav, Route, TargetState } from "../api_types.d.ts" */
/** @import { Certainty } from "../domain/certainty.js" */
/** @import { Pill } from "../mission/strips/span_strip.js" */

/** @typedef {{ at_m: number, within_m: number }} Progress */
/**
 * @typedef {object} LiveStripOptions
 * @property {Pick<Route, "waypoints" | "length_m">} route
 * @property {number} width_px
 * @property {string} label for screen readers
 * @property {Map<number, TargetState>} states of each target by its place
 * @property {Progress | null} progress result of progressOf
 * @property {Certainty | null} certainty
 */

const HEIGHT_PX = 34;
const MIDDLE_PX = 18;
const DART_PX = 9;
const MIN_BRACKET_PX = 9;

/**
 * Position of a UAV along its route [m] and its uncertainty [m]: { at_m, within_m }; null where unknown.
 *
 * @param {Pick<LiveUav, "estimated" | "measured"> & { link?: Pick<LiveUav["link"], "waypoint_sequence"> | null }} uav
 * @param {readonly number[]} places of its waypoints along the route [m]
 * @returns {Progress | null}
 */
export function progressOf({ estimated, measured, link }, places) {
  if (estimated && estimated.along_route_m !== null)
    return { at_m: estimated.along_route_m, within_m: estimated.bound.along_m };
  const next = measured?.waypoint_sequence ?? link?.waypoint_sequence ?? null;
  return next === null || !places.length
    ? null
    : { at_m: places[Math.min(Math.max(0, next - 1), places.length - 1)], within_m: 0 };
}

/** @param {LiveStripOptions} options */
export function liveStrip({ route, width_px, label, states, progress, certainty }) {
  const profile = profileOf(route.waypoints, route.length_m);
  const plan = layOut(profile, route.length_m, width_px);
  const { x } = scaleOf(route.length_m, width_px);
  const at = progress ? x(Math.min(route.length_m, Math.max(0, progress.at_m))) : plan.start;
  /** @param {number} x1 @param {number} x2 @param {boolean} off @param {string} kind */
  const leg = (x1, x2, off, kind) =>
    x2 > x1 && svg("line", { x1, x2, y1: MIDDLE_PX, y2: MIDDLE_PX, class: `strip-leg ${kind}${off ? " off" : ""}` });
  /** @param {number} place [px] */
  const base = (place) => svg("rect", { x: place - 4, y: MIDDLE_PX - 4, width: 8, height: 8, class: "strip-base" });
  return svg(
    "svg",
    {
      class: "strip live-strip",
      role: "img",
      "aria-label": label,
      width: width_px,
      height: HEIGHT_PX,
      viewBox: `0 0 ${width_px} ${HEIGHT_PX}`,
    },
    plan.ticks.map((tick) =>
      svg("line", { x1: tick, x2: tick, y1: MIDDLE_PX - 6, y2: MIDDLE_PX - 1, class: "strip-tick" }),
    ),
    plan.legs.map(({ x1, x2, offNetwork }) => [
      leg(x1, Math.min(x2, at), offNetwork, "flown"),
      leg(Math.max(x1, at), x2, offNetwork, "ahead"),
    ]),
    base(plan.start),
    base(plan.end),
    plan.pills.map((pill) => drawPill(pill, states)),
    progress && drawUav(at, Math.max(MIN_BRACKET_PX, x(progress.within_m) - x(0)), certainty),
  );
}

/**
 * Filled once all of its targets are done, red where one failed.
 *
 * @param {Pill<number | null>} pill
 * @param {Map<number, TargetState>} states
 */
function drawPill({ x, width, label, targets }, states) {
  /** @param {number | null} target */
  const stateOf = (target) => (target === null ? undefined : states.get(target));
  /** @param {TargetState} state */
  const of = (state) => targets.some((target) => stateOf(target) === state);
  const look = of("failed")
    ? "failed"
    : targets.every((target) => stateOf(target) === "complete")
      ? "complete"
      : of("skipped")
        ? "skipped"
        : "open";
  return svg(
    "g",
    { class: `strip-target ${look}` },
    svg("rect", { x: x - width / 2, y: MIDDLE_PX - 9, width, height: 18, rx: 9 }),
    svg("text", { x, y: MIDDLE_PX + 4 }, label),
  );
}

/** @param {number} at [px] @param {number} half_px @param {Certainty | null} certainty */
function drawUav(at, half_px, certainty) {
  const dart = svg("path", {
    class: "strip-uav",
    d: `M${at + DART_PX} ${MIDDLE_PX}L${at - DART_PX} ${MIDDLE_PX - 6}L${at - DART_PX / 2} ${MIDDLE_PX}L${at - DART_PX} ${MIDDLE_PX + 6}Z`,
  });
  if (certainty === MEASURED) return svg("g", { class: "strip-flyer measured" }, dart);
  const half = Math.max(half_px, DART_PX + 3);
  const [left, right, top, bottom] = [at - half, at + half, MIDDLE_PX - 11, MIDDLE_PX + 11];
  return svg(
    "g",
    { class: `strip-flyer ${certainty ?? "lost"}` },
    svg("rect", { class: "strip-within", x: left, y: top, width: right - left, height: bottom - top }),
    svg("path", {
      class: "strip-bracket",
      d: `M${left + 4} ${top}H${left}V${bottom}H${left + 4}M${right - 4} ${top}H${right}V${bottom}H${right - 4}`,
    }),
    dart,
  );
}
