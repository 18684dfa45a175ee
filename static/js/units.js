/** SI and ISO times become text here and nowhere else, in the reader's units, time zone and language.
 *
 * A no-break space stands before each unit, minus is −. Stored and sent values stay metric and UTC.
 */

import { locale, t } from "./text.js";

const SPACE = "\u00a0";
const FOOT_M = 0.3048; // international foot
const MILE_M = 1609.344; // international mile
const MPH_MPS = 0.44704;
const ACRE_M2 = 4046.8564224;

const preferences = globalThis.document?.documentElement.dataset ?? {};
export const isImperial = preferences.units === "imperial";
const zone = preferences.timeZone ? { timeZone: preferences.timeZone } : {};

/** @param {number} value @param {number} [digits] after the decimal sign */
function grouped(value, digits = 0) {
  return value
    .toLocaleString(locale, { minimumFractionDigits: digits, maximumFractionDigits: digits })
    .replace("-", "−");
}

/** A bare figure, grouped as the reader is used to. */
export const numberText = grouped;

/** @param {string} figure @param {string} unit */
const withUnit = (figure, unit) => `${figure}${SPACE}${unit}`;

/** @param {number | null | undefined} length_m */
export function lengthText(length_m) {
  if (length_m === null || length_m === undefined) return "—";
  if (isImperial) {
    const length_ft = length_m / FOOT_M;
    if (length_ft < 1000) return withUnit(grouped(Math.round(length_ft)), "ft");
    const length_mi = length_m / MILE_M;
    return withUnit(grouped(length_mi, length_mi < 999.95 ? 1 : 0), "mi");
  }
  if (length_m < 999.5) return withUnit(grouped(Math.round(length_m)), "m");
  const length_km = length_m / 1000;
  return withUnit(grouped(length_km, length_km < 999.95 ? 1 : 0), "km");
}

/** What long distances are typed in: { unit, metres } of one. */
export const LONG_UNIT = isImperial ? { unit: "mi", metres: MILE_M } : { unit: "km", metres: 1000 };
/** What heights and short distances are typed in. */
export const SHORT_UNIT = isImperial ? { unit: "ft", metres: FOOT_M } : { unit: "m", metres: 1 };
/** @param {number} celsius */
const fahrenheit = (celsius) => (celsius * 9) / 5 + 32;
/** @param {number} typed */
const fromFahrenheit = (typed) => ((typed - 32) * 5) / 9;
/** @param {number} figure */
const same = (figure) => figure;
/** What temperatures are typed in: `typed` from degrees Celsius, `celsius` back. */
export const TEMPERATURE_UNIT = isImperial
  ? { unit: "°F", typed: fahrenheit, celsius: fromFahrenheit }
  : { unit: "°C", typed: same, celsius: same };
/** What speeds are typed in. */
export const SPEED_UNIT = isImperial ? { unit: "mph", mps: MPH_MPS } : { unit: "m/s", mps: 1 };

/** @param {number} area_m2 */
export function areaText(area_m2) {
  if (isImperial) {
    const area_mi2 = area_m2 / MILE_M ** 2;
    return area_mi2 < 0.1
      ? withUnit(grouped(area_m2 / ACRE_M2, 1), "ac")
      : withUnit(grouped(area_mi2, area_mi2 < 10 ? 2 : 1), "mi²");
  }
  if (area_m2 < 100_000) return withUnit(grouped(Math.round(area_m2)), "m²");
  const area_km2 = area_m2 / 1e6;
  return withUnit(grouped(area_km2, area_km2 < 10 ? 2 : area_km2 < 999.95 ? 1 : 0), "km²");
}

/** @param {number | null | undefined} duration_s */
export function durationText(duration_s) {
  if (duration_s === null || duration_s === undefined) return "—";
  const minutes = Math.round(duration_s / 60);
  if (duration_s > 0 && minutes === 0) return withUnit("1", "min");
  if (minutes < 100) return withUnit(`${minutes}`, "min");
  const rest = minutes % 60;
  return `${withUnit(grouped(Math.floor(minutes / 60)), "h")}${rest ? ` ${withUnit(`${rest}`, "min")}` : ""}`;
}

/** The remaining time: "0:07". @param {number} ms */
export function countdownText(ms) {
  const seconds = Math.max(0, Math.ceil(ms / 1000));
  return `${Math.floor(seconds / 60)}:${`${seconds % 60}`.padStart(2, "0")}`;
}

/** @param {number} height_m */
export function heightText(height_m) {
  return isImperial
    ? withUnit(grouped(Math.round(height_m / FOOT_M)), "ft")
    : withUnit(grouped(Math.round(height_m)), "m");
}

/** To a tenth where there is one: for measured or typed values. @param {number} height_m */
export function exactHeightText(height_m) {
  const figure = Math.round((height_m / SHORT_UNIT.metres) * 10) / 10;
  return withUnit(grouped(figure, Number.isInteger(figure) ? 0 : 1), SHORT_UNIT.unit);
}

/** @param {number} speed_mps */
export function speedText(speed_mps) {
  if (isImperial) return withUnit(grouped(Math.round(speed_mps / MPH_MPS)), "mph");
  return withUnit(grouped(speed_mps, Number.isInteger(speed_mps) ? 0 : 1), "m/s");
}

/** @param {number} temperature_c */
export function temperatureText(temperature_c) {
  return withUnit(grouped(Math.round(TEMPERATURE_UNIT.typed(temperature_c))), TEMPERATURE_UNIT.unit);
}

/** @param {number | null | undefined} energy_wh */
export function energyText(energy_wh) {
  if (energy_wh === null || energy_wh === undefined) return "—";
  return withUnit(grouped(Math.round(energy_wh)), "Wh");
}

/** To a tenth where there is one: of a battery, as it was typed. @param {number} energy_wh */
export function exactEnergyText(energy_wh) {
  const figure = Math.round(energy_wh * 10) / 10;
  return withUnit(grouped(figure, Number.isInteger(figure) ? 0 : 1), "Wh");
}

/** @param {number} power_w */
export function powerText(power_w) {
  return withUnit(grouped(Math.round(power_w)), "W");
}

/** @param {number} percent */
export function percentText(percent) {
  return withUnit(grouped(Math.round(percent)), "%");
}

/** @param {number} voltage_kv */
export function voltageText(voltage_kv) {
  return withUnit(grouped(voltage_kv, Number.isInteger(voltage_kv) ? 0 : 1), "kV");
}

const COMPASS = [
  t("north"),
  t("north-east"),
  t("east"),
  t("south-east"),
  t("south"),
  t("south-west"),
  t("west"),
  t("north-west"),
];

/** "west" for 270. @param {number} direction_deg clockwise from north */
export const compassText = (direction_deg) => COMPASS[Math.round((((direction_deg % 360) + 360) % 360) / 45) % 8];

/**
 * Latitude comes first for readers; all code has longitude first. The decimal separator is a point in every language,
 * because the text is typed and copied.
 *
 * @param {readonly number[]} position longitude, latitude
 */
export function coordinateText([longitude, latitude]) {
  return [latitude, longitude].map((degrees) => degrees.toFixed(4).replace("-", "−")).join(", ");
}

/**
 * "56.12345° N, 10.12345° E", to 1 m: to be read over a radio and pasted into a map program. Alerts use the same format
 * (telemetry/alerting/detectors/down.py).
 *
 * @param {readonly number[]} position longitude, latitude
 */
export function positionText([longitude, latitude]) {
  const [north, east] = [latitude < 0 ? "S" : "N", longitude < 0 ? "W" : "E"];
  return `${Math.abs(latitude).toFixed(5)}° ${north}, ${Math.abs(longitude).toFixed(5)}° ${east}`;
}

/** The day in the user's time zone, as 2026-12-01. @param {Date} date */
export const calendarDay = (date) =>
  new Intl.DateTimeFormat("en-CA", { ...zone, year: "numeric", month: "2-digit", day: "2-digit" }).format(date);

/** @param {string | number} iso or milliseconds since 1970 */
export function clockText(iso) {
  return new Date(iso).toLocaleTimeString(locale, { ...zone, hour: "2-digit", minute: "2-digit" });
}

/** With seconds: live pages and logs alone. @param {string | number} iso or milliseconds since 1970 */
export function exactClockText(iso) {
  return new Date(iso).toLocaleTimeString(locale, { ...zone, hour: "2-digit", minute: "2-digit", second: "2-digit" });
}

/** "10 Sep 2026". @param {string | number} iso or milliseconds since 1970 */
export function dateText(iso) {
  return new Date(iso).toLocaleDateString(locale, { ...zone, day: "numeric", month: "short", year: "numeric" });
}

/** "now", "today, 11:40", "yesterday, 09:12", "10 Sep", "10 Sep 2025". @param {string} iso @param {Date} [now] */
export function whenText(iso, now = new Date()) {
  const then = new Date(iso);
  if (now.getTime() - then.getTime() < 60_000 && now >= then) return t("now");
  if (calendarDay(then) === calendarDay(now)) return t("today, {time}", { time: clockText(iso) });
  if (calendarDay(then) === calendarDay(new Date(now.getTime() - 86_400_000)))
    return t("yesterday, {time}", { time: clockText(iso) });
  return dayText(iso, now);
}

/** "10 Sep", with the year if it is not the present one. @param {string} iso @param {Date} [now] */
export function dayText(iso, now = new Date()) {
  const then = new Date(iso);
  /** @type {Intl.DateTimeFormatOptions} */
  const parts = { ...zone, day: "numeric", month: "short" };
  if (calendarDay(then).slice(0, 4) !== calendarDay(now).slice(0, 4)) parts.year = "numeric";
  return then.toLocaleDateString(locale, parts);
}

/** "21 November", with the year if it is not the present one. @param {string} iso @param {Date} [now] */
export function longDayText(iso, now = new Date()) {
  const then = new Date(iso);
  /** @type {Intl.DateTimeFormatOptions} */
  const parts = { ...zone, day: "numeric", month: "long" };
  if (calendarDay(then).slice(0, 4) !== calendarDay(now).slice(0, 4)) parts.year = "numeric";
  return then.toLocaleDateString(locale, parts);
}

/** Day, time and the zone's name in full: for tooltips. @param {string} iso */
export function exactText(iso) {
  return new Date(iso).toLocaleString(locale, { ...zone, dateStyle: "medium", timeStyle: "long" });
}

/** "+12:05", "+1:02:05": time since a departure that has no date. @param {number} seconds */
export function sinceText(seconds) {
  const whole = Math.max(0, Math.round(seconds));
  /** @param {number} figure */
  const two = (figure) => `${figure}`.padStart(2, "0");
  const [hours, minutes] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60];
  return hours ? `+${hours}:${two(minutes)}:${two(whole % 60)}` : `+${two(minutes)}:${two(whole % 60)}`;
}

/** Offset of the reader's clock from UTC at a moment [ms], in minutes. @param {number} moment */
export function minutesAheadOfUtc(moment) {
  const part = new Intl.DateTimeFormat("en-US", { ...zone, timeZoneName: "longOffset" })
    .formatToParts(new Date(moment))
    .find(({ type }) => type === "timeZoneName");
  const [, sign, hours, minutes] = /GMT(?:([+-])(\d\d):(\d\d))?/.exec(part?.value ?? "") ?? [];
  return sign ? (sign === "-" ? -1 : 1) * (Number(hours) * 60 + Number(minutes)) : 0;
}

/** "Europe/Berlin, UTC+1": time zone of the reader at a moment. @param {string} iso */
export function zoneText(iso) {
  const name = preferences.timeZone || new Intl.DateTimeFormat().resolvedOptions().timeZone;
  const ahead = minutesAheadOfUtc(Date.parse(iso));
  const rest = Math.abs(ahead) % 60;
  const figure = `UTC${ahead < 0 ? "−" : "+"}${Math.floor(Math.abs(ahead) / 60)}${rest ? `:${`${rest}`.padStart(2, "0")}` : ""}`;
  return name === "UTC" ? "UTC" : `${name}, ${figure}`;
}

/** "2026-11-21T19:30": a moment by the reader's clock, in the form of a field for date and time. @param {string} iso */
export function typedMoment(iso) {
  const moment = Date.parse(iso);
  return new Date(moment + minutesAheadOfUtc(moment) * 60_000).toISOString().slice(0, 16);
}

/**
 * Returns the moment in a field for date and time, by the reader's clock; null where it is empty. An hour that a change of the clocks
 * skips becomes the one after it.
 *
 * @param {string} typed
 */
export function momentTyped(typed) {
  const asUtc = Date.parse(`${typed}Z`);
  if (!Number.isFinite(asUtc)) return null;
  const guess = asUtc - minutesAheadOfUtc(asUtc) * 60_000;
  const moment = asUtc - minutesAheadOfUtc(guess) * 60_000;
  const isThere = asUtc - minutesAheadOfUtc(moment) * 60_000 === moment;
  return new Date(isThere ? moment : Math.max(guess, moment)).toISOString();
}

/** "12 s ago", "4 min ago", then the time. @param {number} seconds @param {string} iso */
export function agoText(seconds, iso) {
  if (seconds < 60) return t("{count} s ago", { count: Math.max(0, Math.round(seconds)) });
  return seconds < 3_600 ? t("{count} min ago", { count: Math.round(seconds / 60) }) : whenText(iso);
}
