/** A mission's record as the view shows it: what was measured, and in the silence what was estimated. */

import { isOver, isUnderWay } from "../../record/sentence.js";
import { eventsOf, spanOf } from "../../record/timeline.js";
import { estimatesOf, silenceOf_ms, trackOf, tracksOf } from "../../record/track.js";
import { completed, ESTIMATED, MEASURED } from "./pieces.js";
import { targetsOf } from "./plan_source.js";

const sampleOf = (sample) => ({ ...sample, altitude_relative_m: sample.height_m });

/** Pieces of a record's track, by time; a stretch of estimates goes from the report before it to the one after it. */
export function piecesOf(track) {
  const known = (samples) => samples.filter(({ position }) => position !== null).map(sampleOf);
  const measured = track.measured.map((run) => ({ kind: MEASURED, samples: completed(known(run)) }));
  const estimated = track.estimated.map((run) => ({
    kind: ESTIMATED,
    samples: completed(known(run)).map((sample) => ({
      ...sample,
      waypoint: sample.waypoint ?? run[0].waypoint ?? null,
    })),
  }));
  return [...measured, ...estimated]
    .filter(({ samples }) => samples.length > 0)
    .sort((a, b) => a.samples[0].at_ms - b.samples[0].at_ms || a.samples.at(-1).at_ms - b.samples.at(-1).at_ms);
}

/** loaded: of report/load.js. → a source, see sources/read.js; renew(loaded) puts in what has come since. */
export function recordSource(loaded) {
  const { record } = loaded;
  const source = {
    kind: "record",
    isSimulated: record.routes.every(({ is_simulated }) => is_simulated),
    departs_ms: Date.parse(record.mission.departs_at ?? record.mission.started_at ?? 0) || 0,
    hasDate: true,
    routes: record.routes.map(({ place, uav, name, waypoints, is_simulated }) => ({
      place,
      uav,
      name,
      isSimulated: is_simulated,
      planned: waypoints.map(({ arrival_s, ...point }) => ({ ...point, altitude_amsl_m: null, at_s: arrival_s })),
    })),
    targets: [],
    windAt: (at_ms) => windMeasured(source.routes, at_ms),
    renew,
  };
  source.targets = targetsOf(source.routes, record.targets);
  renew(loaded);
  return source;

  function renew({ record: newest, records, estimates, alerts }) {
    const silence_ms = silenceOf_ms(Math.max(records.every_s ?? 0, estimates.every_s ?? 0));
    const [measured, estimated] = [tracksOf(records.features), estimatesOf(estimates.features)];
    for (const route of source.routes) {
      route.track = trackOf(measured.get(route.uav) ?? [], estimated.get(route.uav) ?? [], silence_ms);
      route.pieces = piecesOf(route.track);
    }
    source.span = spanOf(source.routes.map(({ track }) => track));
    source.events = eventsOf({ routes: source.routes, targets: newest.targets, alerts, isOver: isOver(newest) });
    source.isGrowing = isUnderWay(newest);
  }
}

/** The newest wind that a UAV told before a moment: { speed_mps, from_deg }; null where none did. */
export function windMeasured(routes, at_ms) {
  const told = routes
    .map(({ track }) => track.samples.findLast((sample) => sample.at_ms <= at_ms && sample.wind))
    .filter(Boolean);
  return told.sort((a, b) => b.at_ms - a.at_ms)[0]?.wind ?? null;
}
