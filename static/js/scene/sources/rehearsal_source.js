/** A run of a rehearsal as the view shows it: flown in simulation, at the mission's departure. */

import { completed, MEASURED } from "./pieces.js";
import { NO_DATE_MS, targetsOf, windAtHeight } from "./plan_source.js";

const ON_GROUND_M = 0.3; // above take-off: lower, it stands

/** Samples of one simulated flight: columns → rows. Tracks of before have no attitude: it hangs level, its nose along its way. */
export function samplesOf(flight, departs_ms) {
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

/** detail: of the rehearsal; track: of one of its runs; mission: GET /missions/{id}. → a source, see sources/read.js. */
export function rehearsalSource({ detail, track, mission }) {
  const departs_ms = mission.departs_at ? Date.parse(mission.departs_at) : NO_DATE_MS;
  const run = detail.runs[track.run];
  const routes = track.routes.map(({ uav: place, name, flights, planned }) => ({
    place,
    name,
    uav: mission.plan?.routes?.[place]?.uav_id ?? null,
    planned: planned.map(({ waypoint, ...point }) => ({ ...point, sequence: waypoint })),
    pieces: flights.map((flight) => ({ kind: MEASURED, samples: samplesOf(flight, departs_ms) })),
  }));
  const moments = routes.flatMap(({ pieces }) =>
    pieces.flatMap(({ samples }) => [samples[0].at_ms, samples.at(-1).at_ms]),
  );
  return {
    kind: "rehearsal",
    rehearsal: detail.id,
    run: track.run,
    isSimulated: true,
    conditions: run.words,
    departs_ms,
    hasDate: Boolean(mission.departs_at),
    routes,
    span: moments.length ? { from_ms: Math.min(...moments), to_ms: Math.max(...moments) } : null,
    targets: targetsOf(routes, mission.targets),
    events: eventsOfRun(run.verdict, routes, departs_ms),
    windAt: (_at_ms, height_m) => windAtHeight(run.conditions.wind ?? [], height_m),
  };
}

/** Take-offs, targets and landings of a run, as the record page has them: [{ at_ms, kind, place, target? }]. */
export function eventsOfRun(verdict, routes, departs_ms) {
  const flights = routes.flatMap(({ place, pieces }) =>
    pieces.flatMap(({ samples }) => [
      { at_ms: samples[0].at_ms, kind: "take-off", place },
      { at_ms: samples.at(-1).at_ms, kind: "landing", place },
    ]),
  );
  const targets = (verdict?.routes ?? []).flatMap(({ uav, targets: flown }) =>
    flown
      .filter(({ at_s }) => at_s !== null)
      .map(({ at_s, target }) => ({ at_ms: departs_ms + at_s * 1_000, kind: "target", place: uav, target })),
  );
  return [...flights, ...targets].sort((a, b) => a.at_ms - b.at_ms);
}
