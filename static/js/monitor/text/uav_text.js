/** Texts on one UAV of a live page: its state, the age of its report, the estimate. Values in, text out. */

import { ESTIMATED, hasFix, isLate, LOST, MEASURED, reportAge_s, withinOf_m } from "../../domain/certainty.js";
import { inAir } from "../../domain/in_air.js";
import { t } from "../../text.js";
import { durationText, exactClockText, heightText, lengthText, numberText, speedText } from "../../units.js";

/** @import { LiveUav } from "../../api_types.d.ts" */
/** @import { Certainty } from "../../domain/certainty.js" */

const AMBER = "warning";
/** @type {[RegExp, string, string][]} */
const MODES = [
  [/^(MISSION|AUTO)$/, t("In mission"), "active"],
  [/^(HOLD|LOITER|POSHOLD|BRAKE|PAUSED?)$/, t("Holding"), AMBER],
  [/^(RTL|RETURN|SMART_?RTL|AUTO_?RTL|RETURNING)$/, t("Returning"), AMBER],
  [/^(LAND|LANDING|PRECLAND)$/, t("Landing"), AMBER],
  [/^(TAKEOFF|TAKE-OFF)$/, t("Taking off"), "active"],
];

/**
 * { words, level }: what it does by its own reports.
 *
 * @param {Pick<LiveUav, "measured"> & Partial<Pick<LiveUav, "link">>} uav
 * @returns {{ words: string, level: string | null }}
 */
export function stateOf({ measured, link }) {
  const mode = (measured?.mode || link?.mode || "").trim();
  const isInAir = inAir({ measured, link });
  if (!mode && isInAir === null) return { words: t("Not connected"), level: null };
  if (isInAir === false)
    return { words: measured?.is_armed ? t("Armed, on the ground") : t("On the ground"), level: null };
  const known = MODES.find(([pattern]) => pattern.test(mode.toUpperCase().replace(/^AUTO\./, "")));
  return known ? { words: known[1], level: known[2] } : { words: mode || t("In the air"), level: null };
}

/** @param {Pick<LiveUav, "measured" | "link">} uav */
export const isHeld = (uav) => stateOf(uav).words === t("Holding");
/** @param {Pick<LiveUav, "measured" | "link">} uav */
export const isReturning = (uav) => stateOf(uav).words === t("Returning");
/** @param {Pick<LiveUav, "measured" | "link">} uav */
export const isLanding = (uav) => stateOf(uav).words === t("Landing");

/** { figure, isLate }: the age of its newest report, "0.7 s"; null without one. @param {LiveUav} uav @param {number} now_ms */
export function ageWords(uav, now_ms) {
  const age_s = reportAge_s(uav, now_ms);
  if (age_s === null) return { figure: null, isLate: false };
  return { figure: durationWords(age_s), isLate: isLate(uav, now_ms) };
}

/** "0.7 s", "42 s", "14 h 18 min" @param {number} age_s */
export function durationWords(age_s) {
  const short = age_s < 10 ? numberText(age_s, 1) : `${Math.floor(age_s)}`;
  return age_s < 100 ? `${short}\u00a0s` : durationText(age_s);
}

/** When its next message is expected; a time that has passed is overdue. @param {string} at @param {number} now_ms */
export const contactWords = (at, now_ms) =>
  Date.parse(at) > now_ms
    ? t("Next contact expected {time}.", { time: exactClockText(at) })
    : t("Contact overdue since {time}.", { time: exactClockText(at) });

/**
 * The box under an estimated UAV: { strong, rest }; null for a measured one, and for one whose next report is not due yet.
 *
 * @param {LiveUav} uav
 * @param {Certainty | null} certainty
 * @param {number} now_ms
 * @returns {{ strong: string, rest: string } | null}
 */
export function estimateWords(uav, certainty, now_ms) {
  const { estimated, measured } = uav;
  if (certainty === null || certainty === MEASURED || (certainty === ESTIMATED && !isLate(uav, now_ms))) return null;
  const seen = measured ? t("Last report {time}.", { time: exactClockText(measured.measured_at) }) : "";
  if (certainty === LOST || !estimated) return { strong: t("Lost: position unknown."), rest: seen };
  const contact = estimated.contact_expected_at ? contactWords(estimated.contact_expected_at, now_ms) : seen;
  return {
    strong: t("Estimated position ±{distance} (95 %).", { distance: lengthText(withinOf_m(estimated)) }),
    rest: contact,
  };
}

const MIN_WIND_MPS = 0.5; // below, it comes from nowhere

/** "Wind 5 m/s from 240°, reported by the autopilot 4 s ago"; empty where it reports none. @param {LiveUav} uav @param {number} now_ms */
export function windWords({ measured, link }, now_ms) {
  const speed_mps = measured?.wind_speed_mps;
  if (!measured || typeof speed_mps !== "number") return "";
  const from_deg = measured.wind_from_deg;
  const from =
    typeof from_deg === "number" && speed_mps >= MIN_WIND_MPS
      ? ` ${t("from {degrees}°", { degrees: Math.round(from_deg) })}`
      : "";
  const age_s = Math.max(0, (now_ms - Date.parse(measured.measured_at_of.wind ?? measured.measured_at)) / 1000);
  const by =
    link?.kind === "http"
      ? t("reported by its companion computer {age} ago", { age: durationWords(age_s) })
      : t("reported by its autopilot {age} ago", { age: durationWords(age_s) });
  return `${t("Wind {speed}", { speed: speedText(speed_mps) })}${from}, ${by}`;
}

/** One fact beside its name on the map. @param {LiveUav} uav @param {Certainty | null} certainty */
export function mapFact(uav, certainty) {
  if (certainty === LOST) return t("lost");
  if (certainty === ESTIMATED && !hasFix(uav)) return t("no GPS fix");
  if (certainty === ESTIMATED && uav.estimated)
    return t("estimated, ±{distance}", { distance: lengthText(withinOf_m(uav.estimated)) });
  const state = stateOf(uav);
  if (state.level === AMBER) return state.words.toLocaleLowerCase();
  const { altitude_relative_m: relative_m, altitude_agl_m: agl_m, altitude_amsl_m: amsl_m } = uav.measured ?? {};
  const height_m = relative_m ?? agl_m ?? amsl_m ?? null;
  return height_m === null ? state.words : heightText(height_m);
}
