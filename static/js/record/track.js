/** What UAVs reported in a mission, by time, and where nothing was heard of them. Values in, values out. */

const SILENT_MS = 12_000; // a UAV reports at least every ten seconds
const SPACINGS = 2.5; // of thinned records: neighbours may lie up to two spacings apart

/** From how long on between two records nothing was heard; every_s: how far apart the server chose them, null: it gave all. */
export const silenceOf_ms = (every_s) => Math.max(SILENT_MS, (every_s ?? 0) * SPACINGS * 1_000);

function speedOf({ velocity_north_mps: north, velocity_east_mps: east }) {
  return typeof north === "number" && typeof east === "number" ? Math.hypot(north, east) : null;
}

/** Where the wind comes from; the log has where the air goes. */
function windOf({ wind_north_mps: north, wind_east_mps: east }) {
  if (typeof north !== "number" || typeof east !== "number") return null;
  return { speed_mps: Math.hypot(north, east), from_deg: ((Math.atan2(-east, -north) * 180) / Math.PI + 360) % 360 };
}

/**
 * Features of the log → Map of UAV → [{ at_ms, position, height_m, speed_mps, battery_percent, heading_deg, roll_deg, pitch_deg, climb_mps, mode,
 * isInAir, waypoint, wind, altitude_amsl_m }] by time; none from the future.
 */
export function tracksOf(features) {
  return byUav(
    features.filter(({ properties }) => !properties.is_from_future),
    ({ geometry, properties }) => ({
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
    }),
  );
}

/** Features of the estimates → Map of UAV → [{ at_ms, position, height_m, speed_mps, heading_deg, bound_m, bound, isLost }] by time. */
export function estimatesOf(features) {
  return byUav(features, ({ geometry, properties }) => ({
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
  }));
}

function byUav(features, valueOf) {
  const found = new Map();
  for (const feature of features) {
    const { uav } = feature.properties;
    if (!found.has(uav)) found.set(uav, []);
    found.get(uav).push(valueOf(feature));
  }
  for (const own of found.values()) own.sort((a, b) => a.at_ms - b.at_ms);
  return found;
}

/** Divided where two neighbours are farther apart than silence_ms. */
export function runsOf(samples, silence_ms) {
  const runs = [];
  samples.forEach((sample, index) => {
    if (index === 0 || sample.at_ms - samples[index - 1].at_ms > silence_ms) runs.push([]);
    runs.at(-1).push(sample);
  });
  return runs;
}

/** Number of the sample that is nearest in time; -1 where there is none. */
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

/** Stretches in the air: [{ from_ms, to_ms }]. Silence does not end a flight, a report from the ground does. */
export function flightsOf(samples) {
  const flights = [];
  let isFlying = false;
  for (const { at_ms, isInAir } of samples) {
    if (isInAir === false) isFlying = false;
    else if (isFlying) flights.at(-1).to_ms = at_ms;
    else {
      isFlying = true;
      flights.push({ from_ms: at_ms, to_ms: at_ms });
    }
  }
  return flights;
}

/**
 * A UAV's record as it is drawn: what was measured in runs, and in the silence between and after them what was estimated.
 * → { samples, estimates, measured: [[sample]], estimated: [[sample]], flights, silence_ms }. A stretch of estimates begins and ends with
 * the reports around it.
 */
export function trackOf(samples, estimates, silence_ms) {
  const measured = runsOf(samples, silence_ms);
  const silences = measured.map((run, index) => ({ before: run.at(-1), after: measured[index + 1]?.[0] ?? null }));
  const estimated = silences.flatMap(({ before, after }) => {
    const within = estimates.filter(({ at_ms }) => at_ms > before.at_ms && (!after || at_ms < after.at_ms));
    return runsOf([before, ...within, ...(after ? [after] : [])], silence_ms).filter((run) => run.length > 1);
  });
  return { samples, estimates, measured, estimated, flights: flightsOf(samples), silence_ms };
}

export const MEASURED = "measured";
export const ESTIMATED = "estimated";
export const SILENT = "silent"; // nothing was heard, and nobody has estimated it

/** What is known of a moment: { kind, sample }; null before the first report and after the last word of it. */
export function momentOf(track, at_ms) {
  const { samples, estimates, silence_ms } = track;
  if (!samples.length || at_ms < samples[0].at_ms) return null;
  const sample = samples[nearestTo(samples, at_ms)];
  const estimate = estimates[nearestTo(estimates, at_ms)];
  const isHeard = track.measured.some((run) => run[0].at_ms <= at_ms && at_ms <= run.at(-1).at_ms);
  if (isHeard) return { kind: MEASURED, sample };
  if (estimate && Math.abs(estimate.at_ms - at_ms) <= silence_ms / 2) return { kind: ESTIMATED, sample: estimate };
  if (at_ms > samples.at(-1).at_ms) return null;
  const before = samples.findLast((one) => one.at_ms <= at_ms);
  return { kind: SILENT, sample: before };
}

/** Lines of one value over time, each broken where nothing was heard: [[{ at_ms, value }]]. */
export function linesOf(samples, name, silence_ms) {
  const known = samples
    .filter((sample) => sample[name] !== null)
    .map((sample) => ({ at_ms: sample.at_ms, value: sample[name] }));
  return runsOf(known, silence_ms);
}
