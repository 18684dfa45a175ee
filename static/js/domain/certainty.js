/** How sure a live page is of where a UAV is: measured, estimated, or lost. Values in, values out; times in milliseconds since 1970. */

import { inAir } from "./in_air.js";

/** @import { EstimateShape, LiveUav } from "../api_types.d.ts" */

export const FRESH_S = 3; // a newer report is shown as it is: two seconds of delay are normal at one report a second
const RENEWED_S = 10; // an older estimate is from an estimator that has stopped

/** @typedef {"measured" | "estimated" | "lost"} Certainty */

export const MEASURED = "measured";
export const ESTIMATED = "estimated";
export const LOST = "lost";

/**
 * Age of the last report [s]; null where there was none.
 *
 * @param {Pick<LiveUav, "measured">} uav
 * @param {number} now_ms
 */
export function reportAge_s({ measured }, now_ms) {
  return measured ? Math.max(0, (now_ms - Date.parse(measured.measured_at)) / 1000) : null;
}

/**
 * Whether the next report is overdue, by its interval and the limits of alerts; false after landing.
 *
 * @param {LiveUav} uav
 * @param {number} now_ms
 */
export const isLate = (uav, now_ms) =>
  inAir(uav) !== false && (reportAge_s(uav, now_ms) ?? 0) >= uav.rhythm.late_after_s;

/** Whether enough reports are missing that it counts as silent. @param {LiveUav} uav @param {number} now_ms */
export const isSilent = (uav, now_ms) => (reportAge_s(uav, now_ms) ?? Infinity) >= uav.rhythm.silent_after_s;

/** @param {EstimateShape | null} estimated @param {number} now_ms @returns {estimated is EstimateShape} */
const isRenewed = (estimated, now_ms) => estimated !== null && now_ms - Date.parse(estimated.at) < RENEWED_S * 1000;

const FIX_IN_SPACE = 3; // of MAVLink's GPS_FIX_TYPE

/** Whether it has a position fix by its reports. @param {Pick<LiveUav, "measured">} uav */
export const hasFix = ({ measured }) => typeof measured?.gps_fix !== "number" || measured.gps_fix >= FIX_IN_SPACE;

/**
 * MEASURED, ESTIMATED or LOST; null for a UAV that was never seen.
 *
 * @param {LiveUav} uav
 * @param {number} now_ms
 * @returns {Certainty | null}
 */
export function certaintyOf(uav, now_ms) {
  const { measured, estimated } = uav;
  if (!measured?.position && !estimated) return null;
  if (measured?.position && inAir(uav) === false) return MEASURED; // at the place of its last report, possibly switched off
  const age_s = reportAge_s(uav, now_ms);
  const isFresh = !isSilent(uav, now_ms);
  if (!hasFix(uav) && isFresh) return ESTIMATED; // its reported position is dead reckoning
  if (isRenewed(estimated, now_ms)) {
    if (estimated.is_lost) return LOST;
    if (age_s !== null && age_s < FRESH_S && measured?.position) return MEASURED;
    return estimated.is_measured && isFresh ? MEASURED : estimated.is_measured ? LOST : ESTIMATED;
  }
  return isFresh && measured?.position ? MEASURED : LOST;
}

/**
 * Its drawn position [lon, lat] with its heading: { position, heading_deg }; null for a UAV that was never seen.
 *
 * @param {Pick<LiveUav, "measured" | "estimated">} uav
 * @param {Certainty | null} certainty
 * @returns {{ position: number[], heading_deg: number | null } | null}
 */
export function standsAt({ measured, estimated }, certainty) {
  if (certainty === null) return null;
  const estimate = estimated && { position: estimated.position, heading_deg: estimated.heading_deg };
  const report = measured?.position ? { position: measured.position, heading_deg: measured.heading_deg } : null;
  return certainty === MEASURED ? (report ?? estimate) : (estimate ?? report);
}

/** Radius [m] in which it is 95 of 100 times. @param {{ bound: Pick<EstimateShape["bound"], "along_m" | "across_m"> }} estimated */
export const withinOf_m = ({ bound }) => Math.max(bound.along_m, bound.across_m);
