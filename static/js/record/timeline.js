/** The time of a replay: its span, its axis, and its events. Values in, values out. */

import { lastOf } from "./track.js";

/** @import { Alert, RecordRoute, RecordTarget } from "../api_types.d.ts" */
/** @import { TimeSpan } from "./player.js" */
/** @import { TimedValue, Track } from "./track.js" */

/** @typedef {ReturnType<typeof scaleOf>} Scale */
/**
 * What happened in a replay. place: of the UAV; target: its place.
 *
 * @typedef {{ at_ms: number, place: number | null } & (
 *   { kind: "take-off" | "landing" } | { kind: "target", target: number } | { kind: "alert", alert: Alert }
 * )} ReplayEvent
 */

const SECOND = 1_000;
const MINUTE = 60 * SECOND;
const HOUR = 60 * MINUTE;
const STEPS_MS = [
  SECOND,
  2 * SECOND,
  5 * SECOND,
  10 * SECOND,
  15 * SECOND,
  30 * SECOND,
  MINUTE,
  2 * MINUTE,
  5 * MINUTE,
  10 * MINUTE,
  15 * MINUTE,
  30 * MINUTE,
  HOUR,
  2 * HOUR,
  3 * HOUR,
  6 * HOUR,
  12 * HOUR,
  24 * HOUR,
];
const MAX_MS = STEPS_MS[STEPS_MS.length - 1];
const TICK_PX = 84;
const SAME_MS = 500; // an event at the cursor

/**
 * From the first take-off to the last landing; of all reports where none states that it flew. null without reports.
 *
 * @param {Pick<Track, "flights" | "samples" | "estimated">[]} tracks
 * @returns {TimeSpan | null}
 */
export function spanOf(tracks) {
  const flown = tracks.flatMap(({ flights }) => flights.flatMap(({ from_ms, to_ms }) => [from_ms, to_ms]));
  const received = tracks.flatMap(({ samples }) =>
    [...samples.slice(0, 1), ...samples.slice(-1)].map(({ at_ms }) => at_ms),
  );
  const estimated = tracks.flatMap(({ estimated: runs }) => runs.map((run) => lastOf(run).at_ms));
  const moments = flown.length ? [...flown, ...estimated] : received;
  if (!moments.length) return null;
  const from_ms = Math.min(...moments);
  return { from_ms, to_ms: Math.max(...moments, from_ms + SECOND) };
}

/** x(at_ms) in pixels, and back. @param {TimeSpan} span @param {number} width_px */
export function scaleOf({ from_ms, to_ms }, width_px) {
  const length_ms = to_ms - from_ms;
  return {
    /** @param {number} at_ms */
    x: (at_ms) => ((at_ms - from_ms) / length_ms) * width_px,
    /** @param {number} x */
    at_ms: (x) => from_ms + (Math.min(width_px, Math.max(0, x)) / Math.max(1, width_px)) * length_ms,
  };
}

/**
 * Round moments by the reader's clock.
 *
 * @param {TimeSpan} span
 * @param {number} width_px
 * @param {number} ahead_min of UTC
 */
export function ticksOf({ from_ms, to_ms }, width_px, ahead_min) {
  const most = Math.max(1, Math.floor(width_px / TICK_PX));
  const step_ms =
    STEPS_MS.find((step) => (to_ms - from_ms) / step <= most) ?? MAX_MS * Math.ceil((to_ms - from_ms) / MAX_MS / most);
  const ahead_ms = ahead_min * MINUTE;
  const moments = [];
  for (let at = Math.ceil((from_ms + ahead_ms) / step_ms) * step_ms - ahead_ms; at <= to_ms; at += step_ms)
    moments.push(at);
  return { step_ms, moments };
}

/** Rules of a scale from 0: round figures, three at most, the last at or below the highest. @param {number} highest */
export function rulesOf(highest) {
  if (!(highest > 0)) return [];
  const power = 10 ** Math.floor(Math.log10(highest));
  const steps = [0.2, 0.5, 1, 2].map((factor) => factor * power);
  const step = steps.find((candidate) => highest / candidate < 3.999) ?? 5 * power;
  return Array.from({ length: Math.floor(highest / step + 1e-9) }, (_, index) => (index + 1) * step);
}

/**
 * Whether a UAV's flight of this index has ended, by its reports.
 *
 * @param {Pick<Track, "flights" | "samples">} track
 * @param {number} index
 * @param {boolean} isOver whether the mission has ended
 */
export const hasLanded = (track, index, isOver) =>
  isOver || index < track.flights.length - 1 || track.samples.at(-1)?.isInAir === false;

/**
 * Events in the order of time.
 *
 * @param {object} flown
 * @param {readonly { place: number, uav: number | null, track: Pick<Track, "flights" | "samples"> }[]} flown.routes
 * @param {readonly Pick<RecordTarget, "place" | "uav" | "reached_at">[]} flown.targets
 * @param {readonly Alert[]} flown.alerts
 * @param {boolean} flown.isOver whether the mission has ended
 */
export function eventsOf({ routes, targets, alerts, isOver }) {
  /** @type {ReplayEvent[]} */
  const events = [];
  for (const { place, track } of routes) {
    track.flights.forEach(({ from_ms, to_ms }, index) => {
      events.push({ at_ms: from_ms, kind: "take-off", place });
      if (hasLanded(track, index, isOver)) events.push({ at_ms: to_ms, kind: "landing", place });
    });
  }
  for (const target of targets)
    if (target.reached_at)
      events.push({ at_ms: Date.parse(target.reached_at), kind: "target", place: target.uav, target: target.place });
  for (const alert of alerts)
    events.push({
      at_ms: Date.parse(alert.opened_at),
      kind: "alert",
      place: routes.find(({ uav }) => uav === alert.uav)?.place ?? null,
      alert,
    });
  return events.sort((a, b) => a.at_ms - b.at_ms);
}

/**
 * The next event in a direction from a moment; null where there is none.
 *
 * @template {{ at_ms: number }} Timed
 * @param {readonly Timed[]} events
 * @param {number} at_ms
 * @param {number} direction 1 or -1
 */
export function eventFrom(events, at_ms, direction) {
  if (direction > 0) return events.find((event) => event.at_ms > at_ms + SAME_MS) ?? null;
  return events.findLast((event) => event.at_ms < at_ms - SAME_MS) ?? null;
}

/**
 * Heights of the plan by time, from the UAV's take-off, at the rate of its clock; empty where the plan has no times.
 *
 * @param {{ waypoints: readonly Pick<RecordRoute["waypoints"][number], "arrival_s" | "altitude_relative_m">[],
 *   flown: Pick<RecordRoute["flown"], "began_at" | "clock_rate"> }} route
 * @returns {TimedValue[]}
 */
export function plannedHeights({ waypoints, flown }) {
  if (!flown.began_at) return [];
  const began_ms = Date.parse(flown.began_at);
  const timed = waypoints.flatMap(({ arrival_s, altitude_relative_m: value }) =>
    arrival_s === null ? [] : [{ arrival_s, value }],
  );
  if (timed.length < waypoints.length) return [];
  return timed.map(({ arrival_s, value }) => ({
    at_ms: began_ms + ((arrival_s - timed[0].arrival_s) / flown.clock_rate) * SECOND,
    value,
  }));
}
