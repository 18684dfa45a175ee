/** A mission's record as a source of the view: measurements, and estimates in silences. */

import { isOver, isUnderWay } from "../../record/sentence.js";
import { eventsOf, spanOf } from "../../record/timeline.js";
import { estimatesOf, silenceOf_ms, trackOf, tracksOf } from "../../record/track.js";
import { completed, ESTIMATED, firstOf, lastOf, MEASURED } from "./pieces.js";
import { targetsOf } from "./plan_source.js";

/** @import { LoadedMission } from "../../record/load.js" */
/** @import { Estimate, Sample, Track } from "../../record/track.js" */
/** @import { FlightRoute, FlightSample, FlightSource, Piece } from "../types.d.ts" */

/** @typedef {FlightRoute & { track: Track }} RecordedRoute */
/** @typedef {Omit<FlightSource, "routes"> & { routes: RecordedRoute[], renew: (loaded: LoadedMission) => void }} RecordSource */

/** Those that have a place. @param {readonly (Sample | Estimate)[]} samples @returns {FlightSample[]} */
export const placedSamples = (samples) =>
  samples.flatMap(({ position, ...sample }) =>
    position === null ? [] : [{ ...sample, position, altitude_relative_m: sample.height_m }],
  );

/**
 * Pieces of a record's track, by time; a stretch of estimates extends from the report before it to the one after it.
 *
 * @param {Track} track
 */
export function piecesOf(track) {
  /** @type {Piece[]} */
  const measured = track.measured.map((run) => ({ kind: MEASURED, samples: completed(placedSamples(run)) }));
  /** @type {Piece[]} */
  const estimated = track.estimated.map((run) => {
    const flownTo = "waypoint" in run[0] ? run[0].waypoint : null;
    const samples = completed(placedSamples(run));
    return { kind: ESTIMATED, samples: samples.map((sample) => ({ ...sample, waypoint: sample.waypoint ?? flownTo })) };
  });
  return [...measured, ...estimated]
    .filter(({ samples }) => samples.length > 0)
    .sort((a, b) => firstOf(a).at_ms - firstOf(b).at_ms || lastOf(a).at_ms - lastOf(b).at_ms);
}

/** @param {LoadedMission} loaded */
export function recordSource(loaded) {
  const { record } = loaded;
  /** @type {RecordSource} */
  const source = {
    kind: "record",
    isSimulated: record.routes.every(({ is_simulated }) => is_simulated),
    departs_ms: Date.parse(record.mission.departs_at ?? record.mission.started_at ?? "") || 0,
    hasDate: true,
    span: null,
    routes: record.routes.map(({ place, uav, name, waypoints, is_simulated }) => ({
      place,
      uav,
      name,
      isSimulated: is_simulated,
      planned: waypoints.map(({ arrival_s, ...point }) => ({ ...point, altitude_amsl_m: null, at_s: arrival_s })),
      pieces: [],
      track: trackOf([], [], 0),
    })),
    colours: record.mission.colours,
    targets: [],
    events: [],
    windAt: (at_ms) => windMeasured(source.routes, at_ms),
    renew({ record: newest, records, estimates, alerts }) {
      const silence_ms = silenceOf_ms(Math.max(records.every_s ?? 0, estimates.every_s ?? 0));
      const [measured, estimated] = [tracksOf(records.features), estimatesOf(estimates.features)];
      for (const route of source.routes) {
        const uav = route.uav ?? NaN;
        route.track = trackOf(measured.get(uav) ?? [], estimated.get(uav) ?? [], silence_ms);
        route.pieces = piecesOf(route.track);
      }
      source.span = spanOf(source.routes.map(({ track }) => track));
      source.events = eventsOf({ routes: source.routes, targets: newest.targets, alerts, isOver: isOver(newest) });
      source.isGrowing = isUnderWay(newest);
    },
  };
  source.targets = targetsOf(source.routes, record.targets);
  source.renew(loaded);
  return source;
}

/**
 * The newest wind that a UAV reported before a moment; null without one.
 *
 * @param {readonly Pick<RecordedRoute, "track">[]} routes
 * @param {number} at_ms
 */
export function windMeasured(routes, at_ms) {
  const reported = routes
    .map(({ track }) => track.samples.findLast((sample) => sample.at_ms <= at_ms && sample.wind))
    .filter((sample) => sample !== undefined);
  return reported.sort((a, b) => b.at_ms - a.at_ms)[0]?.wind ?? null;
}
