/**
 * At which departures a mission would meet no zone: places on a bar of time, and the sentence over it. Values in,
 * values out.
 */

import { locale, t, tn } from "../../text.js";
import { clockText, durationText, energyText, lengthText, typedMoment } from "../../units.js";
import { departureText } from "./flight_options.js";
import { marginWords } from "./zones_passed.js";

/** @import { BlockingZone, LaterDeparture, LegalWindows, Plan, TimeSpan } from "../../api_types.d.ts" */
/** @import { ShownRoute } from "../types.d.ts" */

/** @typedef {{ from_ms: number, to_ms: number }} Span of moments, open at its end */
/** @typedef {ReturnType<typeof legalTimesOf>} LegalTimes */

export const STEP_MS = 5 * 60_000;
const HOUR_MS = 3_600_000;
const TICK_HOURS = 6;
const MAX_WAYS = 3; // that a row names for each UAV

/** @param {TimeSpan} span @returns {Span} */
const span = ({ from, to }) => ({ from_ms: Date.parse(from), to_ms: Date.parse(to) });

/**
 * The server's answer with moments as ms; routes: those of the request, with name, letter and waypoints.
 *
 * @param {LegalWindows} answer
 * @param {Pick<ShownRoute, "name" | "letter" | "waypoints">[]} [routes]
 */
export function legalTimesOf({ from, to, windows, zones, margin_s = 0, height_margin_m = 0 }, routes = []) {
  /** @param {BlockingZone["legs"]} legs */
  const named = (legs) =>
    legs
      .filter(({ uav }) => routes[uav])
      .map(({ uav, leg }) => ({ uav: routes[uav].name, way: wayOf(routes[uav], leg) }));
  return {
    ...span({ from, to }),
    margin_s,
    height_margin_m,
    windows: windows.map(span),
    zones: zones.map((zone) => ({ ...zone, blocked: zone.blocked.map(span), legs: named(zone.legs) })),
  };
}

/** Position along the bar, 0 to 1. @param {Span} bar @param {number} moment */
export const shareOf = ({ from_ms, to_ms }, moment) => Math.min(1, Math.max(0, (moment - from_ms) / (to_ms - from_ms)));

/** The moment at a share of the bar, on a full step by the clock, before the bar's end. @param {Span} bar @param {number} share */
export function momentAt({ from_ms, to_ms }, share) {
  const moment = Math.round((from_ms + share * (to_ms - from_ms)) / STEP_MS) * STEP_MS;
  return Math.min((Math.ceil(to_ms / STEP_MS) - 1) * STEP_MS, Math.max(Math.ceil(from_ms / STEP_MS) * STEP_MS, moment));
}

/** The span that holds a moment; spans are open at their end. @param {Span[]} spans @param {number} moment */
export const spanAt = (spans, moment) =>
  spans.find(({ from_ms, to_ms }) => from_ms <= moment && moment < to_ms) ?? null;

/**
 * A step within a span, as near to the moment as there is one; the span's own begin where it is shorter than a step.
 *
 * @param {Span} span
 * @param {number} moment
 */
export function stepWithin({ from_ms, to_ms }, moment) {
  const [first, last] = [Math.ceil(from_ms / STEP_MS) * STEP_MS, (Math.ceil(to_ms / STEP_MS) - 1) * STEP_MS];
  return first > last ? from_ms : Math.min(last, Math.max(first, moment));
}

/**
 * Every sixth hour by the reader's clock: [{ at_ms, words, isDay }]; midnight has the name of the day.
 *
 * @param {Span} bar
 */
export function ticksOf({ from_ms, to_ms }) {
  const ticks = [];
  for (let at_ms = Math.ceil(from_ms / HOUR_MS) * HOUR_MS; at_ms <= to_ms; at_ms += HOUR_MS) {
    const iso = new Date(at_ms).toISOString();
    const typed = typedMoment(iso);
    const hour = Number(typed.slice(11, 13));
    if (hour % TICK_HOURS) continue;
    ticks.push({ at_ms, isDay: hour === 0, words: hour === 0 ? dayName(typed) : clockText(iso) });
  }
  return ticks;
}

/** "Sun 22 Nov" of a moment as it is typed by the reader's clock. @param {string} typed */
const dayName = (typed) =>
  new Date(`${typed}Z`).toLocaleDateString(locale, {
    timeZone: "UTC",
    weekday: "short",
    day: "numeric",
    month: "short",
  });

/** "Sat 21 Nov, 19:30 to 22:00". @param {Span} span */
export function spanText({ from_ms, to_ms }) {
  const [from, to] = [from_ms, to_ms].map((at) => new Date(at).toISOString());
  const isOneDay = typedMoment(from).slice(0, 10) === typedMoment(to).slice(0, 10);
  return t("{from} to {to}", { from: departureText(from), to: isOneDay ? clockText(to) : departureText(to) });
}

/** Why a window ends sooner than a zone begins; empty where that is not so. @param {LegalTimes} times */
export const marginText = ({ zones, margin_s: time_s, height_margin_m: height_m }) =>
  zones.length ? marginWords({ time_s, height_m }) : "";

/**
 * The text of the bar, and whether the chosen departure is a legal one: { sentence, departure }.
 *
 * @param {LegalTimes} times
 * @param {string | null} departs_at
 */
export function wordsOf(times, departs_at) {
  const free_ms = times.windows.reduce((sum, { from_ms, to_ms }) => sum + to_ms - from_ms, 0);
  const hours = Math.round((times.to_ms - times.from_ms) / HOUR_MS);
  const isWhole = free_ms >= times.to_ms - times.from_ms;
  const sentence = isWhole
    ? tn(hours, "Zones open throughout the next hour.", "Zones open throughout the next {count} hours.")
    : free_ms === 0
      ? tn(hours, "Zones closed throughout the next hour.", "Zones closed throughout the next {count} hours.")
      : t("Zones open for {free} of the next {hours} hours.", { free: durationText(free_ms / 1000), hours });
  return {
    sentence,
    departure: departs_at
      ? departureWords(times, Date.parse(departs_at))
      : t("No departure time: all zones count as active."),
  };
}

/** @param {LegalTimes} times @param {number} moment */
function departureWords(times, moment) {
  const when = departureText(new Date(moment).toISOString());
  if (moment < times.from_ms || moment >= times.to_ms)
    return t("The departure {when} is outside these hours.", { when });
  if (spanAt(times.windows, moment)) return t("Departure {when}: zones open.", { when });
  const names = times.zones
    .filter(({ blocked }) => spanAt(blocked, moment))
    .map(({ name }) => name)
    .join(", ");
  const next = times.windows.find(({ from_ms }) => from_ms > moment);
  const words = names
    ? t("Departure {when}: closed by {zones}.", { when, zones: names })
    : t("Departure {when}: zones closed.", { when });
  return next
    ? `${words} ${t("Next open departure: {when}.", { when: departureText(new Date(next.from_ms).toISOString()) })}`
    : words;
}

/**
 * "Heron, A1 to A2, after A4; Kite, start to B1": between which targets routes meet a zone; the climb at the start is the take-off. legs:
 * [{ uav: its name, way: see wayOf }].
 *
 * @param {{ uav: string, way: string }[]} legs
 */
export function legsText(legs) {
  const byUav = new Map();
  for (const { uav, way } of legs) byUav.set(uav, new Set([...(byUav.get(uav) ?? []), way]));
  return [...byUav]
    .map(([uav, ways]) =>
      [uav, ...[...ways].slice(0, MAX_WAYS), ...(ways.size > MAX_WAYS ? [t("and more")] : [])].join(", "),
    )
    .join("; ");
}

/**
 * The targets, by their numbers on the map, between which the leg lies that begins at this waypoint.
 *
 * @param {Pick<ShownRoute, "letter" | "waypoints">} route
 * @param {number} leg
 */
export function wayOf({ letter, waypoints }, leg) {
  if (leg < 0) return t("at take-off");
  /** @param {{ kind: string }} waypoint */
  const isTarget = ({ kind }) => kind === "target";
  const [before, all] = [waypoints.slice(0, leg + 1).filter(isTarget).length, waypoints.filter(isTarget).length];
  const [start, end] = [`${letter}${before}`, `${letter}${before + 1}`];
  if (before === all) return before ? t("after {start}", { start }) : t("on its way");
  return before ? t("{start} to {end}|way", { start, end }) : t("start to {end}|way", { end });
}

const MAX_COMPARED = 12; // targets, of which departures are compared
const MIN_M = 1;

/**
 * Whether a search for a better departure can help: a zone obstructs the plan, for a time or permanently.
 *
 * @param {Pick<Plan, "gap_of" | "unassigned">} plan
 * @param {number} targets
 */
export function mayDepartBetter({ gap_of, unassigned = [] }, targets) {
  return (
    targets <= MAX_COMPARED &&
    (gap_of === "without_timed_zones" ||
      unassigned.some(({ reason }) => reason === "inside_zone" || reason === "no_path"))
  );
}

/** The answer about a better departure as text: { words, departs_at }. @param {LaterDeparture} answer */
export function betterWords({ departs_at, looked_until, before, then }) {
  if (departs_at === null || then === null) {
    const words =
      looked_until === null
        ? t("No zone near ends in the next 48 hours.")
        : t("No departure until {when} does better: one was looked at after each end of a zone near.", {
            when: departureText(looked_until),
          });
    return { words, departs_at: null };
  }
  const when = departureText(departs_at);
  const more = before.left_out - then.left_out;
  if (more > 0)
    return {
      words: tn(
        more,
        "Departing {when} reaches {count} target more.",
        "Departing {when} reaches {count} targets more.",
        { when },
      ),
      departs_at,
    };
  const gains = [
    before.total_length_m - then.total_length_m >= MIN_M &&
      t("{length} less", { length: lengthText(before.total_length_m - then.total_length_m) }),
    before.done_s - then.done_s >= 60 &&
      t("done {time} sooner after it", { time: durationText(before.done_s - then.done_s) }),
    before.total_energy_wh !== null &&
      then.total_energy_wh !== null &&
      before.total_energy_wh - then.total_energy_wh >= 1 &&
      t("{energy} less", { energy: energyText(before.total_energy_wh - then.total_energy_wh) }),
  ].filter(Boolean);
  return {
    words: t("Departing {when} does better: {gains}.", {
      when,
      gains: gains.join(", ") || t("by what the plan is best at"),
    }),
    departs_at,
  };
}
