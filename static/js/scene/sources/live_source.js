/** A mission as it flies: the feed's word of each UAV, and between two words a glide. */

import { certaintyOf, MEASURED as RECEIVED, LOST as UNREACHABLE } from "../../domain/certainty.js";
import { inAir } from "../../domain/in_air.js";
import { tracksOf } from "../../record/track.js";
import { completed, ESTIMATED, LOST, MEASURED, momentOf } from "./pieces.js";
import { plannedOf, targetsOf } from "./plan_source.js";
import { placedSamples } from "./record_source.js";

/** @import { LiveUav, Mission, RecordFeature } from "../../api_types.d.ts" */
/** @import { FlightRoute, FlightSample, Moment, Piece, Wind } from "../types.d.ts" */

/** @typedef {ReturnType<typeof liveSource>} LiveSource */
/** @typedef {{ from: Moment, to: Moment, at_ms: number }} Glide the last two messages of a UAV, and when the last one arrived */

const GLIDE_MS = 300; // as the marker on the map
const SILENT_MS = 45_000; // no ribbon over a longer silence
const MAX_SAMPLES = 4_000; // of a UAV's ribbon; the oldest half is thinned out then

/**
 * The state of a UAV at the server's time; null before it was first seen.
 *
 * @param {LiveUav} uav
 * @param {number} now_ms
 * @returns {Moment | null}
 */
export function liveSample(uav, now_ms) {
  const certainty = certaintyOf(uav, now_ms);
  if (certainty === null) return null;
  const { measured, estimated } = uav;
  const received = certainty === RECEIVED && measured?.position ? measured : null;
  const from = received ?? estimated ?? measured;
  if (!from?.position) return null;
  return {
    kind: certainty === UNREACHABLE ? LOST : received ? MEASURED : ESTIMATED,
    at_ms: now_ms,
    since_ms: measured ? Date.parse(measured.measured_at) : null,
    position: from.position,
    altitude_relative_m: from.altitude_relative_m ?? measured?.altitude_relative_m ?? null,
    altitude_amsl_m: from.altitude_amsl_m ?? measured?.altitude_amsl_m ?? null,
    heading_deg: from.heading_deg ?? measured?.heading_deg ?? 0,
    speed_mps: from.speed_mps ?? null,
    climb_mps: received ? received.climb_mps : null,
    roll_deg: received ? received.roll_deg : 0,
    pitch_deg: received ? received.pitch_deg : 0,
    battery_percent: measured?.battery_percent ?? null,
    waypoint:
      (received ? received.waypoint_sequence : estimated?.waypoint_sequence) ?? measured?.waypoint_sequence ?? null,
    mode: measured?.mode ?? "",
    isInAir: inAir(uav) !== false,
    bound: received || !estimated ? null : estimated.bound,
  };
}

/**
 * Append a report to a UAV's pieces; an older or equal one changes nothing. Returns whether it was appended.
 *
 * @param {Piece[]} pieces
 * @param {FlightSample} sample
 */
export function addSample(pieces, sample) {
  const piece = pieces.at(-1);
  const last = piece?.samples.at(-1);
  if (last && sample.at_ms <= last.at_ms) return false;
  if (!piece || !last || sample.at_ms - last.at_ms > SILENT_MS) pieces.push({ kind: MEASURED, samples: [sample] });
  else {
    piece.samples.push(sample);
    thinOut(piece);
  }
  return true;
}

/** @param {Piece} piece */
function thinOut(piece) {
  if (piece.samples.length <= MAX_SAMPLES) return;
  const half = MAX_SAMPLES / 2;
  piece.samples = [...piece.samples.slice(0, half).filter((_, index) => index % 2 === 0), ...piece.samples.slice(half)];
}

/** @param {Mission} detail @param {readonly RecordFeature[]} features @returns {FlightRoute[]} */
function routesOf(detail, features) {
  const flown = tracksOf(features);
  return (detail.plan?.routes ?? []).map((route, place) => {
    /** @type {Piece[]} */
    const pieces = [];
    const own = route.uav_id === null ? [] : (flown.get(route.uav_id) ?? []);
    for (const sample of completed(placedSamples(own))) addSample(pieces, sample);
    return {
      place,
      uav: route.uav_id,
      name: route.uav,
      isSimulated: detail.uavs?.find(({ id }) => id === route.uav_id)?.is_simulated ?? false,
      planned: plannedOf(route),
      pieces,
    };
  });
}

/** Where a UAV is shown between two words. @param {Glide} glide @param {number} now_ms @returns {Moment} */
function glidingAt({ from, to, at_ms }, now_ms) {
  const end_ms = at_ms + GLIDE_MS;
  if (from === to || now_ms >= end_ms) return to;
  const samples = [
    { ...from, at_ms },
    { ...to, at_ms: end_ms },
  ];
  const between = momentOf([{ kind: to.kind, samples }], Math.max(at_ms, now_ms));
  return { ...to, ...between, bound: to.bound, since_ms: to.since_ms, waypoint: to.waypoint };
}

/**
 * A source that grows: take() with each message of the feed; momentAt() returns a UAV's position.
 *
 * @param {{ detail: Mission, features?: readonly RecordFeature[] }} flown features: of the log until now
 */
export function liveSource({ detail, features = [] }) {
  const routes = routesOf(detail, features);
  /** @type {Map<number, Glide>} by the place of the UAV */
  const latest = new Map();
  /** @type {Wind | null} */
  let wind = null;

  /** @param {FlightRoute} route @param {readonly LiveUav[]} uavs */
  const uavOfRoute = (route, uavs) =>
    uavs.find(({ id, mission, place }) => id === route.uav || (mission === detail.id && place === route.place));

  /** @param {FlightRoute} route @param {number} now_ms */
  function momentAt(route, now_ms) {
    const known = latest.get(route.place);
    return known ? glidingAt(known, now_ms) : null;
  }

  /**
   * Store the last message of a route's UAV; returns whether it is new.
   *
   * @param {FlightRoute} route
   * @param {Moment} sample
   * @param {number} now_ms
   */
  function receive(route, sample, now_ms) {
    const known = latest.get(route.place);
    if (known && !isOther(known.to, sample)) return false;
    latest.set(route.place, { from: momentAt(route, now_ms) ?? sample, to: sample, at_ms: now_ms });
    return true;
  }

  const source = {
    kind: /** @type {const} */ ("live"),
    isSimulated: routes.length > 0 && routes.every(({ isSimulated }) => isSimulated),
    departs_ms: null,
    hasDate: true,
    span: null,
    routes,
    colours: detail.colours,
    targets: targetsOf(routes, detail.targets),
    events: [],
    /** Revision of the flown path's ribbon; increases when the path grows. */
    revision: 0,
    windAt: () => wind,
    /** Take over a message. Returns whether anything has changed. @param {{ uavs: readonly LiveUav[], now_ms: number }} received */
    take({ uavs, now_ms }) {
      let isNew = false;
      for (const route of routes) {
        const uav = uavOfRoute(route, uavs);
        if (!uav) continue;
        route.uavNow = uav;
        const sample = liveSample(uav, now_ms);
        if (!sample) continue;
        if (receive(route, sample, now_ms)) isNew = true;
        const { measured } = uav;
        if (!measured) continue;
        const at_ms = Date.parse(measured.measured_at);
        if (sample.kind === MEASURED && sample.isInAir && addSample(route.pieces, { ...sample, at_ms, bound: null }))
          source.revision += 1;
        if (typeof measured.wind_speed_mps === "number")
          wind = { speed_mps: measured.wind_speed_mps, from_deg: measured.wind_from_deg ?? 0 };
      }
      return isNew;
    },
    momentAt,
    /** @param {number} now_ms */
    isGliding: (now_ms) => [...latest.values()].some(({ at_ms }) => now_ms - at_ms < GLIDE_MS),
  };
  return source;
}

/** @type {(keyof Moment)[]} */
const SEEN = [
  "kind",
  "altitude_relative_m",
  "heading_deg",
  "roll_deg",
  "pitch_deg",
  "battery_percent",
  "waypoint",
  "isInAir",
  "since_ms",
];
/** @param {Moment} a @param {Moment} b */
const isOther = (a, b) =>
  SEEN.some((name) => a[name] !== b[name]) ||
  a.position[0] !== b.position[0] ||
  a.position[1] !== b.position[1] ||
  a.bound?.along_m !== b.bound?.along_m;
