/** The time that a replay goes through: its span, its axis, and what happened in it. Values in, values out. */

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
const TICK_PX = 84;
const SAME_MS = 500; // an event that the cursor stands on

/** From the first take-off to the last landing; of all that was heard where nothing says that it flew. null where nothing was. */
export function spanOf(tracks) {
  const flown = tracks.flatMap(({ flights }) => flights.flatMap(({ from_ms, to_ms }) => [from_ms, to_ms]));
  const heard = tracks.flatMap(({ samples }) => (samples.length ? [samples[0].at_ms, samples.at(-1).at_ms] : []));
  const estimated = tracks.flatMap(({ estimated: runs }) => runs.map((run) => run.at(-1).at_ms));
  const moments = flown.length ? [...flown, ...estimated] : heard;
  if (!moments.length) return null;
  const from_ms = Math.min(...moments);
  return { from_ms, to_ms: Math.max(...moments, from_ms + SECOND) };
}

/** x(at_ms) in pixels, and back. */
export function scaleOf({ from_ms, to_ms }, width_px) {
  const length_ms = to_ms - from_ms;
  return {
    x: (at_ms) => ((at_ms - from_ms) / length_ms) * width_px,
    at_ms: (x) => from_ms + (Math.min(width_px, Math.max(0, x)) / Math.max(1, width_px)) * length_ms,
  };
}

/** Round moments by the reader's clock: { step_ms, moments }. ahead_min: of UTC. */
export function ticksOf({ from_ms, to_ms }, width_px, ahead_min) {
  const most = Math.max(1, Math.floor(width_px / TICK_PX));
  const step_ms =
    STEPS_MS.find((step) => (to_ms - from_ms) / step <= most) ??
    STEPS_MS.at(-1) * Math.ceil((to_ms - from_ms) / STEPS_MS.at(-1) / most);
  const ahead_ms = ahead_min * MINUTE;
  const moments = [];
  for (let at = Math.ceil((from_ms + ahead_ms) / step_ms) * step_ms - ahead_ms; at <= to_ms; at += step_ms)
    moments.push(at);
  return { step_ms, moments };
}

/** Rules of a scale from 0: round figures, three at most, the last at or below the highest. */
export function rulesOf(highest) {
  if (!(highest > 0)) return [];
  const power = 10 ** Math.floor(Math.log10(highest));
  const step = [0.2, 0.5, 1, 2, 5].map((factor) => factor * power).find((candidate) => highest / candidate < 3.999);
  return Array.from({ length: Math.floor(highest / step + 1e-9) }, (_, index) => (index + 1) * step);
}

/** Whether a UAV's flight of this index has ended, as far as anybody heard. */
export const hasLanded = (track, index, isOver) =>
  isOver || index < track.flights.length - 1 || track.samples.at(-1).isInAir === false;

/**
 * What happened, in the order of time: [{ at_ms, kind, place?, target?, alert? }], kind one of take-off, target, alert, landing.
 * routes: [{ place, uav, track }]; targets and alerts as the API has them. isOver: the mission has ended.
 */
export function eventsOf({ routes, targets, alerts, isOver }) {
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

/** The next event in a direction (1 or -1) from a moment; null where there is none. */
export function eventFrom(events, at_ms, direction) {
  if (direction > 0) return events.find((event) => event.at_ms > at_ms + SAME_MS) ?? null;
  return events.findLast((event) => event.at_ms < at_ms - SAME_MS) ?? null;
}

/** Heights of the plan by time, begun when the UAV took off: [{ at_ms, value }]; none where the plan has no times. */
export function plannedHeights({ waypoints, flown }) {
  const [first] = waypoints;
  if (!flown.began_at || !first || waypoints.some(({ arrival_s }) => arrival_s === null)) return [];
  const began_ms = Date.parse(flown.began_at);
  return waypoints.map(({ arrival_s, altitude_relative_m }) => ({
    at_ms: began_ms + (arrival_s - first.arrival_s) * SECOND,
    value: altitude_relative_m,
  }));
}
