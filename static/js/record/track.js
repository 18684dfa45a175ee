/** Reports of the UAVs in a mission by time, and the gaps between them. Values in, values out. */

/** @import { EstimateFeature, RecordFeature, RecordProperties } from "../api_types.d.ts" */
/** @import { TimeSpan } from "./player.js" */

/** @typedef {ReturnType<typeof sampleOf>} Sample what a UAV reported */
/** @typedef {ReturnType<typeof estimateOf>} Estimate where it was estimated to be */
/** @typedef {ReturnType<typeof trackOf>} Track */
/** @typedef {ReturnType<typeof momentOf>} Moment */
/** @typedef {{ at_ms: number, value: number }} TimedValue */

const SILENT_MS = 12_000; // a UAV reports at least every ten seconds
const SPACINGS = 2.5; // of thinned records: neighbours may be up to two spacings apart

/**
 * The shortest interval between two records that counts as silence. every_s: spacing that the server chose, null: it returned all
 * records.
 *
 * @param {number | null} every_s
 */
export const silenceOf_ms = (every_s) => Math.max(SILENT_MS, (every_s ?? 0) * SPACINGS * 1_000);

/** @param {Partial<RecordProperties>} properties */
function speedOf({ velocity_north_mps: north, velocity_east_mps: east }) {
  return typeof north === "number" && typeof east === "number" ? Math.hypot(north, east) : null;
}

/** The direction from which the wind comes; the log stores where the air moves to. @param {Partial<RecordProperties>} properties */
function windOf({ wind_north_mps: north, wind_east_mps: east }) {
  if (typeof north !== "number" || typeof east !== "number") return null;
  return { speed_mps: Math.hypot(north, east), from_deg: ((Math.atan2(-east, -north) * 180) / Math.PI + 360) % 360 };
}

/** @param {RecordFeature} feature */
const sampleOf = ({ geometry, properties }) => ({
  at_ms: Date.parse(properties.measured_at),
  position: geometry?.coordinates ?? null,
  height_m: properties.altitude_relative_m ?? null,
  speed_mps: speedOf(properties),
  battery_percent: properties.battery_percent ?? null,
  heading_deg: properties.heading_deg ?? null,
  roll_deg: properties.roll_deg ?? null,
  pitch_deg: properties.pitch_deg ?? null,
  climb_mps: typeof properties.velocity_down_mps === "number" ? -properties.velocity_down_mps : null,
  altitude_amsl_m: properties.altitude_amsl_m ?? null,
  mode: properties.mode ?? "",
  isInAir: properties.is_in_air ?? null,
  waypoint: properties.waypoint_sequence ?? null,
  wind: windOf(properties),
});

/** @param {EstimateFeature} feature */
const estimateOf = ({ geometry, properties }) => ({
  at_ms: Date.parse(properties.estimated_for),
  position: geometry.coordinates,
  height_m: properties.altitude_relative_m ?? null,
  speed_mps: properties.speed_mps ?? null,
  heading_deg: properties.heading_deg ?? null,
  bound_m: Math.max(properties.bound_along_m, properties.bound_across_m),
  bound: {
    along_m: properties.bound_along_m,
    across_m: properties.bound_across_m,
    bearing_deg: properties.bound_bearing_deg ?? 0,
    height_m: properties.bound_height_m ?? null,
  },
  isLost: properties.is_lost,
});

/**
 * Features of the log → samples of each UAV by time; none from the future.
 *
 * @param {readonly RecordFeature[]} features
 */
export function tracksOf(features) {
  return byUav(
    features.filter(({ properties }) => !properties.is_from_future),
    sampleOf,
  );
}

/** Features of the estimates → those of each UAV by time. @param {readonly EstimateFeature[]} features */
export const estimatesOf = (features) => byUav(features, estimateOf);

/**
 * @template {{ properties: { uav: number } }} Feature
 * @template {{ at_ms: number }} Value
 * @param {readonly Feature[]} features
 * @param {(feature: Feature) => Value} toValue
 */
function byUav(features, toValue) {
  /** @type {Map<number, Value[]>} */
  const found = new Map();
  for (const feature of features) {
    const { uav } = feature.properties;
    const own = found.get(uav) ?? [];
    own.push(toValue(feature));
    found.set(uav, own);
  }
  for (const own of found.values()) own.sort((a, b) => a.at_ms - b.at_ms);
  return found;
}

/**
 * Divided where two neighbours are farther apart than silence_ms.
 *
 * @template {{ at_ms: number }} Timed
 * @param {readonly Timed[]} samples
 * @param {number} silence_ms
 */
export function runsOf(samples, silence_ms) {
  /** @type {[Timed, ...Timed[]][]} */
  const runs = [];
  samples.forEach((sample, index) => {
    if (index === 0 || sample.at_ms - samples[index - 1].at_ms > silence_ms) runs.push([sample]);
    else runs[runs.length - 1].push(sample);
  });
  return runs;
}

/** The last one. @template Item @param {readonly [Item, ...Item[]]} run */
export const lastOf = (run) => run[run.length - 1];

/**
 * Number of the sample that is nearest in time; -1 where there is none.
 *
 * @param {readonly { at_ms: number }[]} samples
 * @param {number} at_ms
 */
export function nearestTo(samples, at_ms) {
  let [low, high] = [0, samples.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (samples[middle].at_ms < at_ms) low = middle + 1;
    else high = middle;
  }
  if (low > 0 && (low === samples.length || at_ms - samples[low - 1].at_ms <= samples[low].at_ms - at_ms))
    return low - 1;
  return low < samples.length ? low : -1;
}

/**
 * Stretches in the air. Silence does not end a flight, a report from the ground does. Where some reports state whether the UAV was in the
 * air, those that do not begin no flight.
 *
 * @param {readonly Pick<Sample, "at_ms" | "isInAir">[]} samples
 */
export function flightsOf(samples) {
  /** @type {TimeSpan[]} */
  const flights = [];
  /** @type {TimeSpan | null} */
  let flight = null;
  const isOrdered = samples.some(({ isInAir }) => isInAir !== null);
  for (const { at_ms, isInAir } of samples) {
    if (isInAir === false) flight = null;
    else if (flight) flight.to_ms = at_ms;
    else if (isInAir || !isOrdered) {
      flight = { from_ms: at_ms, to_ms: at_ms };
      flights.push(flight);
    }
  }
  return flights;
}

/**
 * A UAV's record as drawn: measured runs, and estimates in the silence between and after them. A stretch of estimates begins and ends
 * with the reports around it.
 *
 * @param {Sample[]} samples
 * @param {Estimate[]} estimates
 * @param {number} silence_ms
 */
export function trackOf(samples, estimates, silence_ms) {
  const measured = runsOf(samples, silence_ms);
  const silences = measured.map((run, index) => ({ before: lastOf(run), after: measured[index + 1]?.[0] ?? null }));
  const estimated = silences.flatMap(({ before, after }) => {
    const within = estimates.filter(({ at_ms }) => at_ms > before.at_ms && (!after || at_ms < after.at_ms));
    return runsOf([before, ...within, ...(after ? [after] : [])], silence_ms).filter((run) => run.length > 1);
  });
  return { samples, estimates, measured, estimated, flights: flightsOf(samples), silence_ms };
}

export const MEASURED = "measured";
export const ESTIMATED = "estimated";
export const SILENT = "silent"; // no report, and no estimate either

/**
 * The state at a moment; null before the first report and after the last record.
 *
 * @param {Pick<Track, "samples" | "estimates" | "measured" | "silence_ms">} track
 * @param {number} at_ms
 * @returns {{ kind: typeof MEASURED | typeof SILENT, sample: Sample } | { kind: typeof ESTIMATED, sample: Estimate } | null}
 */
export function momentOf(track, at_ms) {
  const { samples, estimates, silence_ms } = track;
  const before = samples.findLast((one) => one.at_ms <= at_ms);
  if (!before) return null;
  const sample = samples[nearestTo(samples, at_ms)];
  const estimate = estimates[nearestTo(estimates, at_ms)];
  const isReceived = track.measured.some((run) => run[0].at_ms <= at_ms && at_ms <= lastOf(run).at_ms);
  if (isReceived) return { kind: MEASURED, sample };
  if (estimate && Math.abs(estimate.at_ms - at_ms) <= silence_ms / 2) return { kind: ESTIMATED, sample: estimate };
  if (at_ms > samples[samples.length - 1].at_ms) return null;
  return { kind: SILENT, sample: before };
}

/**
 * Lines of one value from each take-off to its landing, broken at silences.
 *
 * @param {Pick<Track, "samples" | "flights" | "silence_ms">} track
 * @param {"height_m" | "speed_mps" | "battery_percent"} name
 */
export const flownLinesOf = ({ samples, flights, silence_ms }, name) =>
  flights.flatMap(({ from_ms, to_ms }) =>
    linesOf(
      samples.filter(({ at_ms }) => from_ms <= at_ms && at_ms <= to_ms),
      name,
      silence_ms,
    ),
  );

/**
 * Lines of one value over time, each broken at silences.
 *
 * @param {readonly Sample[]} samples
 * @param {"height_m" | "speed_mps" | "battery_percent"} name
 * @param {number} silence_ms
 */
export function linesOf(samples, name, silence_ms) {
  const known = samples.flatMap(({ at_ms, [name]: value }) => (value === null ? [] : [{ at_ms, value }]));
  return runsOf(known, silence_ms);
}
