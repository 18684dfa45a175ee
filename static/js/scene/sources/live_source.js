/** A mission as it flies: the feed's word of each UAV, and between two words a glide. */

import { certaintyOf, MEASURED as HEARD, LOST as UNHEARD } from "../../domain/certainty.js";
import { inAir } from "../../domain/in_air.js";
import { tracksOf } from "../../record/track.js";
import { completed, ESTIMATED, LOST, MEASURED, momentOf } from "./pieces.js";
import { plannedOf, targetsOf } from "./plan_source.js";

const GLIDE_MS = 300; // as the marker on the map
const SILENT_MS = 45_000; // no ribbon over a longer silence
const MOST_SAMPLES = 4_000; // of a UAV's ribbon; the oldest half is thinned out then

/** What is known of a UAV at the server's time: a sample with its kind; null while it was never seen. */
export function liveSample(uav, now_ms) {
  const certainty = certaintyOf(uav, now_ms);
  if (certainty === null) return null;
  const { measured, estimated } = uav;
  const isHeard = certainty === HEARD && measured?.position;
  const from = isHeard ? measured : (estimated ?? measured);
  if (!from?.position) return null;
  return {
    kind: certainty === UNHEARD ? LOST : isHeard ? MEASURED : ESTIMATED,
    at_ms: now_ms,
    since_ms: measured ? Date.parse(measured.measured_at) : null,
    position: from.position,
    altitude_relative_m: from.altitude_relative_m ?? measured?.altitude_relative_m ?? null,
    altitude_amsl_m: from.altitude_amsl_m ?? measured?.altitude_amsl_m ?? null,
    heading_deg: from.heading_deg ?? measured?.heading_deg ?? 0,
    speed_mps: from.speed_mps ?? null,
    climb_mps: isHeard ? measured.climb_mps : null,
    roll_deg: isHeard ? measured.roll_deg : 0,
    pitch_deg: isHeard ? measured.pitch_deg : 0,
    battery_percent: measured?.battery_percent ?? null,
    waypoint:
      (isHeard ? measured.waypoint_sequence : estimated?.waypoint_sequence) ?? measured?.waypoint_sequence ?? null,
    mode: measured?.mode ?? "",
    isInAir: inAir(uav) !== false,
    bound: isHeard || !estimated ? null : estimated.bound,
  };
}

/** Puts a report behind a UAV's pieces; an older one, or the same, changes nothing. Returns whether it was put there. */
export function addSample(pieces, sample) {
  const last = pieces.at(-1)?.samples.at(-1);
  if (last && sample.at_ms <= last.at_ms) return false;
  if (!last || sample.at_ms - last.at_ms > SILENT_MS) pieces.push({ kind: MEASURED, samples: [sample] });
  else pieces.at(-1).samples.push(sample);
  thinOut(pieces);
  return true;
}

function thinOut(pieces) {
  const longest = pieces.at(-1);
  if (longest.samples.length <= MOST_SAMPLES) return;
  const half = MOST_SAMPLES / 2;
  longest.samples = [
    ...longest.samples.slice(0, half).filter((_, index) => index % 2 === 0),
    ...longest.samples.slice(half),
  ];
}

/**
 * A source that grows: take({ uavs, now_ms }) with each word of the feed; momentAt(route, now_ms) is where its UAV is shown.
 * detail: GET /missions/{id}; features: of the log until now.
 */
export function liveSource({ detail, features = [] }) {
  const flown = tracksOf(features);
  const latest = new Map(); // place → { from, to }: the last two words, and what is between
  const routes = (detail.plan?.routes ?? []).map((route, place) => {
    const samples = completed(
      (flown.get(route.uav_id) ?? [])
        .filter(({ position }) => position)
        .map((sample) => ({ ...sample, altitude_relative_m: sample.height_m })),
    );
    const pieces = [];
    for (const sample of samples) addSample(pieces, sample);
    return {
      place,
      uav: route.uav_id,
      name: route.uav,
      isSimulated: detail.uavs?.find(({ id }) => id === route.uav_id)?.is_simulated ?? false,
      planned: plannedOf(route),
      pieces,
    };
  });
  const uavOfRoute = (route, uavs) =>
    uavs.find(({ id, mission, place }) => id === route.uav || (mission === detail.id && place === route.place));

  const source = {
    kind: "live",
    isSimulated: routes.length > 0 && routes.every(({ isSimulated }) => isSimulated),
    departs_ms: null,
    hasDate: true,
    span: null,
    routes,
    targets: targetsOf(routes, detail.targets),
    events: [],
    revision: 0, // of what was flown: a ribbon that has grown
    wind: null,
    windAt: () => source.wind,
    /** Returns whether anything is another than before. */
    take({ uavs, now_ms }) {
      let isNew = false;
      for (const route of routes) {
        const uav = uavOfRoute(route, uavs);
        if (!uav) continue;
        route.uavNow = uav;
        const sample = liveSample(uav, now_ms);
        if (!sample) continue;
        const known = latest.get(route.place);
        const was = known ? momentAt(route, now_ms) : null;
        if (!known || isOther(known.to, sample)) {
          latest.set(route.place, { from: was ?? sample, to: sample, at_ms: now_ms });
          isNew = true;
        }
        const { measured } = uav;
        if (
          sample.kind === MEASURED &&
          sample.isInAir &&
          addSample(route.pieces, { ...sample, at_ms: Date.parse(measured.measured_at), bound: null })
        )
          source.revision += 1;
        if (typeof measured?.wind_speed_mps === "number")
          source.wind = { speed_mps: measured.wind_speed_mps, from_deg: measured.wind_from_deg ?? 0 };
      }
      return isNew;
    },
    momentAt,
    isGliding: (now_ms) => [...latest.values()].some(({ at_ms }) => now_ms - at_ms < GLIDE_MS),
  };

  function momentAt(route, now_ms) {
    const known = latest.get(route.place);
    if (!known) return null;
    const { from, to, at_ms } = known;
    if (from === to || now_ms >= at_ms + GLIDE_MS) return to;
    const between = momentOf(
      [
        {
          kind: to.kind,
          samples: [
            { ...from, at_ms },
            { ...to, at_ms: at_ms + GLIDE_MS },
          ],
        },
      ],
      Math.max(at_ms, now_ms),
    );
    return { ...to, ...between, bound: to.bound, since_ms: to.since_ms, waypoint: to.waypoint };
  }

  return source;
}

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
const isOther = (a, b) =>
  SEEN.some((name) => a[name] !== b[name]) ||
  a.position[0] !== b.position[0] ||
  a.position[1] !== b.position[1] ||
  a.bound?.along_m !== b.bound?.along_m;
