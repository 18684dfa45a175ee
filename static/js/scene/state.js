/** Selection of the view: one UAV, one target, a moment; and its part of a link. Values in, values out. */

/** @import { Task } from "./instruments/task.js" */
/** @import { FlightRoute, FlightSource, Moment, SourceTarget } from "./types.d.ts" */

const NO_DATE_HOUR = 10; // by the sun, of flights that have no departure

/**
 * The place of the next of places after one, in a circle.
 *
 * @param {readonly number[]} places
 * @param {number | null} at
 * @param {number} step
 */
export function nextOf(places, at, step) {
  if (!places.length) return null;
  const index = at === null ? -1 : places.indexOf(at);
  return places[index < 0 ? 0 : (index + step + places.length) % places.length];
}

/**
 * The selected target: the requested one, else that of the UAV's task, else the nearest one of its route.
 *
 * @param {{ targets: readonly SourceTarget[] }} source
 * @param {number | null} wanted
 * @param {Pick<Task, "target"> | null | undefined} task
 * @param {number | null} route
 */
export function targetToSee({ targets }, wanted, task, route) {
  /** @param {number | null | undefined} place */
  const known = (place) => targets.find((target) => target.place === place) ?? null;
  return known(wanted) ?? known(task?.target) ?? targets.find((target) => target.route === route) ?? targets[0] ?? null;
}

/**
 * The day and hour of the sun: those of the flight; without a departure ten in the morning, solar time, of `today`.
 *
 * @param {Pick<FlightSource, "hasDate" | "departs_ms">} source
 * @param {number} at_ms
 * @param {number} longitude_deg
 * @param {number} [today]
 */
export function sunTime(source, at_ms, longitude_deg, today = Date.now()) {
  if (source.hasDate) return new Date(at_ms);
  const day = Math.floor(today / 86_400_000) * 86_400_000;
  return new Date(day + (NO_DATE_HOUR - longitude_deg / 15) * 3_600_000 + (at_ms - (source.departs_ms ?? 0)));
}

/**
 * A UAV's last report before a moment; for an estimated piece the report before it.
 *
 * @param {Pick<FlightRoute, "pieces">} route
 * @param {Pick<Moment, "at_ms">} moment
 */
export function reportBefore(route, moment) {
  const piece = route.pieces.findLast(({ samples }) => samples[0].at_ms <= moment.at_ms);
  return piece?.samples[0] ?? null;
}
