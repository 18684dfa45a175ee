/** A run of a rehearsal as the view shows it: flown in simulation, at the mission's departure. */

import { completed, firstOf, lastOf, MEASURED } from "./pieces.js";
import { NO_DATE_MS, spanOf, targetsOf, windAtHeight } from "./plan_source.js";

/** @import { Mission, RehearsalDetail, RehearsalTrack, TrackFlight, Assessment } from "../../api_types.d.ts" */
/** @import { ReplayEvent } from "../../record/timeline.js" */
/** @import { FlightRoute, FlightSource } from "../types.d.ts" */

const ON_GROUND_M = 0.3; // above take-off: lower, it is on the ground

/**
 * Samples of one simulated flight: columns → rows. Older tracks have no attitude: it is level, its nose along its path.
 *
 * @param {TrackFlight} flight
 * @param {number} departs_ms
 */
export function samplesOf(flight, departs_ms) {
  /** @param {"roll_deg" | "pitch_deg" | "heading_deg"} name @param {number} row */
  const value = (name, row) => flight[name]?.[row] ?? null;
  return completed(
    flight.t_s.map((at_s, row) => ({
      at_ms: departs_ms + at_s * 1_000,
      position: flight.position[row],
      altitude_amsl_m: flight.altitude_amsl_m[row],
      altitude_relative_m: flight.altitude_relative_m[row],
      battery_percent: flight.battery_percent[row],
      roll_deg: value("roll_deg", row),
      pitch_deg: value("pitch_deg", row),
      heading_deg: value("heading_deg", row),
      waypoint: flight.waypoint[row],
      isInAir: flight.altitude_relative_m[row] > ON_GROUND_M,
    })),
  );
}

/**
 * @param {{ detail: RehearsalDetail, track: RehearsalTrack, mission: Mission }} rehearsal track: track of one of its runs
 * @returns {FlightSource}
 */
export function rehearsalSource({ detail, track, mission }) {
  const departs_ms = mission.departs_at ? Date.parse(mission.departs_at) : NO_DATE_MS;
  const run = detail.runs[track.run];
  /** @type {FlightRoute[]} */
  const routes = track.routes.map(({ uav: place, name, flights, planned }) => ({
    place,
    name,
    uav: mission.plan?.routes?.[place]?.uav_id ?? null,
    planned: planned.map(({ waypoint, ...point }) => ({ ...point, sequence: waypoint })),
    pieces: flights.map((flight) => ({ kind: MEASURED, samples: samplesOf(flight, departs_ms) })),
  }));
  return {
    kind: "rehearsal",
    rehearsal: detail.id,
    run: track.run,
    isSimulated: true,
    departs_ms,
    hasDate: Boolean(mission.departs_at),
    routes,
    colours: mission.colours,
    span: spanOf(routes),
    targets: targetsOf(routes, mission.targets),
    events: eventsOfRun(run.assessment, routes, departs_ms),
    windAt: (_at_ms, height_m) => windAtHeight(run.conditions.wind ?? [], height_m),
  };
}

/**
 * Take-offs, targets and landings of a run, in the form of the record page.
 *
 * @param {Assessment | null | undefined} assessment
 * @param {readonly FlightRoute[]} routes
 * @param {number} departs_ms
 */
export function eventsOfRun(assessment, routes, departs_ms) {
  /** @type {ReplayEvent[]} */
  const events = routes.flatMap(({ place, pieces }) =>
    pieces.flatMap((piece) => [
      { at_ms: firstOf(piece).at_ms, kind: "take-off", place },
      { at_ms: lastOf(piece).at_ms, kind: "landing", place },
    ]),
  );
  for (const { uav: place, targets } of assessment?.routes ?? [])
    for (const { at_s, target } of targets)
      if (at_s !== null) events.push({ at_ms: departs_ms + at_s * 1_000, kind: "target", place, target });
  return events.sort((a, b) => a.at_ms - b.at_ms);
}
