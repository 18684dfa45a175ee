/** What a live page says of one UAV: its state, the age of its report, four figures, the estimate. Values in, words out. */

import { ESTIMATED, hasFix, isLate, isSilent, LOST, MEASURED, reportAge_s, withinOf_m } from "../domain/certainty.js";
import { inAir } from "../domain/in_air.js";
import { MIN_HOLD_S } from "../domain/own_return.js";
import { t } from "../text.js";
import {
  clockText,
  durationText,
  exactClockText,
  heightText,
  lengthText,
  numberText,
  percentText,
  speedText,
} from "../units.js";

/** @import { LiveUav } from "../api_types.d.ts" */
/** @import { Certainty } from "../domain/certainty.js" */

/** @typedef {Partial<Record<"altitude_relative_m" | "altitude_agl_m" | "altitude_amsl_m", number | null>>} Heights */

const AMBER = "warning";
/** @type {[RegExp, string, string][]} */
const MODES = [
  [/^(MISSION|AUTO)$/, t("Mission|mode"), "active"],
  [/^(HOLD|LOITER|POSHOLD|BRAKE|PAUSED?)$/, t("Holding"), AMBER],
  [/^(RTL|RETURN|SMART_?RTL|AUTO_?RTL|RETURNING)$/, t("Returning"), AMBER],
  [/^(LAND|LANDING|PRECLAND)$/, t("Landing"), AMBER],
  [/^(TAKEOFF|TAKE-OFF)$/, t("Taking off"), "active"],
];

/**
 * { words, level }: what it does, as far as it has told.
 *
 * @param {Pick<LiveUav, "measured"> & Partial<Pick<LiveUav, "link">>} uav
 * @returns {{ words: string, level: string | null }}
 */
export function stateOf({ measured, link }) {
  const mode = (measured?.mode || link?.mode || "").trim();
  const isInAir = inAir({ measured, link });
  if (!mode && isInAir === null) return { words: t("Not heard yet"), level: null };
  if (isInAir === false)
    return { words: measured?.is_armed ? t("Armed, on the ground") : t("On the ground"), level: null };
  const known = MODES.find(([pattern]) => pattern.test(mode.toUpperCase().replace(/^AUTO\./, "")));
  return known ? { words: known[1], level: known[2] } : { words: mode || t("In the air"), level: null };
}

/** @param {Pick<LiveUav, "measured" | "link">} uav */
export const isHeld = (uav) => stateOf(uav).words === t("Holding");

/** { words, isLate }: "0.7 s ago", "no report for 74 s". @param {LiveUav} uav @param {number} now_ms */
export function ageWords(uav, now_ms) {
  const age_s = reportAge_s(uav, now_ms);
  if (age_s === null) return { words: t("no report yet"), isLate: false };
  if (!isSilent(uav, now_ms))
    return { words: t("{age} s ago", { age: numberText(age_s, age_s < 10 ? 1 : 0) }), isLate: isLate(uav, now_ms) };
  const age = age_s < 100 ? `${Math.floor(age_s)}\u00a0s` : durationText(age_s);
  return { words: t("no report for {age}", { age }), isLate: isLate(uav, now_ms) };
}

/** @param {Heights} [heights] @returns {[number | null, string]} */
function heightOf({ altitude_relative_m = null, altitude_agl_m = null, altitude_amsl_m = null } = {}) {
  if (altitude_relative_m !== null) return [altitude_relative_m, t("over take-off")];
  if (altitude_agl_m !== null) return [altitude_agl_m, t("over ground")];
  return [altitude_amsl_m, t("over the sea")];
}

/** Level of the battery's figure, for its colour, and what it means. @param {LiveUav["estimated"]} estimated */
function batteryLevel(estimated) {
  const level = estimated?.battery?.level ?? "";
  const words = { critical: t("Battery critical"), warning: t("Battery low"), "": "" };
  return { level, title: words[level] };
}

/** "12 min to the reserve, 4 min home"; empty where that is not known, and on the ground. @param {LiveUav} uav */
export function batteryWords(uav) {
  const battery = uav.estimated?.battery;
  if (!battery || inAir(uav) === false) return "";
  if (isHeld(uav) && battery.hold_s !== null)
    return battery.hold_s < MIN_HOLD_S
      ? t("Battery: too low to hold longer")
      : t("Battery: can hold for {time}", { time: durationText(battery.hold_s) });
  const reserve = durationText(battery.reserve_in_s);
  return battery.home_s === null
    ? t("Battery: {reserve} to the reserve", { reserve })
    : t("Battery: {reserve} to the reserve, {home} home", { reserve, home: durationText(battery.home_s) });
}

/**
 * Four figures: [{ figure, unit, words }]; "~" before what is not measured, "—" for what nobody knows.
 *
 * @param {LiveUav} uav
 * @param {Certainty | null} certainty
 */
export function figuresOf({ measured, estimated }, certainty) {
  const mark = certainty === MEASURED ? "" : "~\u2009";
  /** @type {Heights & { speed_mps?: number | null }} */
  const told = (certainty === MEASURED ? measured : estimated) ?? measured ?? {};
  const [height_m, above] = heightOf(told);
  /** @template Value @param {Value | null | undefined} value @param {(value: Value) => string} text */
  const said = (value, text) => (value === null || value === undefined ? "—" : `${mark}${text(value)}`);
  /** @param {string} text @param {string} words */
  const split = (text, words) => {
    const [figure, unit = ""] = text.split(/\u00a0(?=[^\u00a0]*$)/);
    return { figure, unit, words, level: "", title: "" };
  };
  const lands = estimated?.ends_at;
  return [
    { ...split(said(measured?.battery_percent, percentText), t("battery")), ...batteryLevel(estimated) },
    split(said(height_m, heightText), above),
    split(said(told.speed_mps, speedText), t("speed")),
    split(lands ? `${mark}${clockText(lands)}` : "—", t("lands|time")),
  ];
}

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
  if (certainty === LOST || !estimated) return { strong: t("Lost: nobody can say where it is now."), rest: seen };
  const contact = estimated.contact_expected_at
    ? t("Contact expected by {time}.", { time: exactClockText(estimated.contact_expected_at) })
    : seen;
  return {
    strong: t("Estimated, within {distance}", { distance: lengthText(withinOf_m(estimated)) }),
    rest: `${t("(95 of 100 times).")} ${contact}`.trim(),
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
      ? t("reported by its companion computer {age} s ago", { age: numberText(age_s) })
      : t("reported by its autopilot {age} s ago", { age: numberText(age_s) });
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
  const [height_m] = heightOf(uav.measured ?? {});
  return height_m === null ? state.words : heightText(height_m);
}

/**
 * { next, at, toGo }: where it flies next, when, and what is left; words or "". labelOf(target) names a target of its mission.
 *
 * @param {Pick<LiveUav, "estimated">} uav
 * @param {(target: number) => string} labelOf
 */
export function nextOf({ estimated }, labelOf) {
  if (!estimated) return { next: "", at: "", toGo: "" };
  const arrival = estimated.arrivals.find(({ target }) => target !== null);
  const target = arrival?.target ?? null;
  return {
    next: target !== null ? labelOf(target) : estimated.ends_at ? t("Landing") : "",
    at: arrival?.at ? exactClockText(arrival.at) : "",
    toGo: estimated.to_go_m === null ? "" : t("{distance} to go", { distance: lengthText(estimated.to_go_m) }),
  };
}
