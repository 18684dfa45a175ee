/** A rehearsal as text and lines for the panel, the charts and the map. */

import { t, tn } from "../../text.js";
import { durationText, energyText, heightText, percentText } from "../../units.js";

/** @import { Rehearsal, RehearsalConditions, RehearsalDetail, RehearsalLimit, RehearsedRoute, RouteTrack, Assessment, AssessmentLevel } from "../../api_types.d.ts" */

/** @type {RehearsalConditions["code"][]} */
export const CONDITIONS = ["calm", "as-planned", "strong-wind", "weak-battery"];
/** @param {string} code */
export const conditionWords = (code) =>
  ({
    calm: t("Calm"),
    "as-planned": t("As planned"),
    "strong-wind": t("Strong wind"),
    "weak-battery": t("Weak battery"),
  })[code];
/** @type {Record<AssessmentLevel, string>} */
export const LEVELS = { pass: "circle-check", warnings: "triangle-alert", fail: "circle-x" };
/** @param {AssessmentLevel | "" | null | undefined} level */
export const levelWords = (level) =>
  level ? { pass: t("Pass"), warnings: t("Pass with warnings"), fail: t("Fail") }[level] : t("Not flown");

/** @param {Pick<Rehearsal, "state"> | null | undefined} rehearsal */
export const isRunning = (rehearsal) => rehearsal?.state === "queued" || rehearsal?.state === "running";

/** @param {{ words: string }[]} runs */
const namesOf = (runs) => runs.map(({ words }) => words).join(", ");

/**
 * "2 of 13 targets fail: Strong wind." The worst first; detail: as GET /missions/{id}/rehearsals/{id}.
 *
 * @param {RehearsalDetail} detail
 */
export function sentenceOf(detail) {
  if (detail.state === "cancelled") return t("Stopped before it was done.");
  if (detail.state === "failed") return detail.error?.message ?? t("It could not be flown.");
  if (!detail.level) return t("It has not been flown yet.");
  /** @param {AssessmentLevel} level */
  const of = (level) => detail.runs.filter((run) => run.level === level);
  if (detail.level === "pass") return t("It passes: {conditions}.", { conditions: namesOf(of("pass")) });
  if (detail.level === "warnings")
    return t("It passes with warnings: {conditions}.", { conditions: namesOf(of("warnings")) });
  const failing = of("fail");
  const targets = failing.flatMap(({ assessment }) => (assessment?.routes ?? []).flatMap((route) => route.targets));
  const failed = new Set(targets.filter(({ level }) => level === "fail").map(({ target }) => target));
  const all = new Set(targets.map(({ target }) => target)).size;
  const conditions = namesOf(failing);
  return failed.size
    ? tn(failed.size, "{count} of {all} targets fails: {conditions}.", "{count} of {all} targets fail: {conditions}.", {
        all,
        conditions,
      })
    : t("It fails: {conditions}.", { conditions });
}

/** @param {number | null | undefined} metres */
const apart = (metres) => (metres === null || metres === undefined ? "–" : heightText(metres));

/**
 * Figures of a route beside the planned or permitted ones: [{ words, flown, beside }].
 *
 * @param {RehearsedRoute} route
 * @param {RehearsalLimit[]} limits
 */
export function figuresOf(route, limits) {
  /** @param {string} name */
  const limit = (name) => limits.find((one) => one.name === name)?.value ?? null;
  const left = Math.min(...route.energy.map(({ left_percent }) => left_percent));
  const zone = route.zones[0];
  return [
    {
      words: t("Time"),
      flown: durationText(route.flown_s),
      beside: route.planned_s === null ? "" : t("{time} planned", { time: durationText(route.planned_s) }),
    },
    {
      words: t("Energy"),
      flown: energyText(route.used_wh),
      beside: route.planned_wh === null ? "" : t("{energy} planned", { energy: energyText(route.planned_wh) }),
    },
    {
      words: t("Battery at landing"),
      flown: Number.isFinite(left) ? percentText(left) : "–",
      beside: t("limit {limit}", { limit: percentText(route.reserve_percent) }),
    },
    {
      words: t("Off the line, most"),
      flown: apart(route.across.max_m),
      beside: t("limit {limit}", { limit: apart(limit("across_fail_m")) }),
    },
    {
      words: t("Off the height, most"),
      flown: apart(route.height.max_m),
      beside: t("limit {limit}", { limit: apart(limit("height_fail_m")) }),
    },
    {
      words: t("Lowest above ground"),
      flown: apart(route.lowest?.away_m),
      beside: t("limit {limit}", { limit: apart(limit("ground_fail_m")) }),
    },
    {
      words: t("From towers and wires"),
      flown: route.obstacle ? apart(route.obstacle.away_m) : t("none near"),
      beside: t("limit {limit}", { limit: apart(limit("obstacle_fail_m")) }),
    },
    {
      words: t("From zones in force"),
      flown: zone ? apart(Math.hypot(zone.beside_m, zone.height_m)) : t("none near"),
      beside: zone?.name ?? "",
    },
  ];
}

/**
 * The closest approach of the route's UAV to another one in the air: { away_m, other } or null.
 *
 * @param {Assessment} assessment
 * @param {number} uav
 */
export function nearestOther(assessment, uav) {
  const met = assessment.meetings
    .filter(({ uavs }) => uavs.includes(uav))
    .map(({ uavs, beside_m, height_m }) => ({
      away_m: Math.hypot(beside_m, height_m),
      other: uavs.find((place) => place !== uav),
    }));
  return met.sort((a, b) => a.away_m - b.away_m)[0] ?? null;
}

/**
 * Curves of one route of a track, by seconds after departure: { flown: { height, battery }, planned: { height, battery } }, lists of
 * lines of { at_s, value }. Heights are above the first take-off, as the plan's are.
 *
 * @param {RouteTrack} route
 */
export function curvesOf(route) {
  const [first] = route.flights;
  const ground_m = first ? first.altitude_amsl_m[0] - first.altitude_relative_m[0] : 0;
  /** @param {(flight: RouteTrack["flights"][number], row: number) => number} value */
  const lines = (value) =>
    route.flights.map((flight) => flight.t_s.map((at_s, row) => ({ at_s, value: value(flight, row) })));
  /** @param {"altitude_relative_m" | "battery_percent"} name */
  const planned = (name) => {
    const line = route.planned.flatMap(({ at_s, [name]: value }) =>
      at_s === null || value === null ? [] : [{ at_s, value }],
    );
    return line.length > 1 ? [line] : [];
  };
  return {
    flown: {
      height: lines((flight, row) => flight.altitude_amsl_m[row] - ground_m),
      battery: lines((flight, row) => flight.battery_percent[row]),
    },
    planned: { height: planned("altitude_relative_m"), battery: planned("battery_percent") },
  };
}

/** Round figures for the rules of a scale up to `top`: two to four of them. @param {number} top */
export function rulesUpTo(top) {
  if (!(top > 0)) return [];
  const power = 10 ** Math.floor(Math.log10(top));
  const step = [0.2, 0.5, 1, 2, 5].map((share) => share * power).find((one) => top / one <= 4) ?? top;
  return Array.from({ length: Math.floor(top / step) }, (_, index) => (index + 1) * step);
}

/**
 * The form's own conditions for the request; empty fields are as planned.
 *
 * @param {{ wind_mps: number, from_deg: number, gusts_mps: number, battery_percent: number }} typed
 */
export function ownConditions({ wind_mps, from_deg, gusts_mps, battery_percent }) {
  /** @type {Partial<Pick<RehearsalConditions, "wind" | "gusts_mps" | "battery_percent">>} */
  const own = {};
  if (Number.isFinite(wind_mps))
    own.wind = [
      { altitude_agl_m: 10, speed_mps: wind_mps, from_deg: (Number.isFinite(from_deg) ? from_deg : 270) % 360 },
    ];
  if (Number.isFinite(gusts_mps)) own.gusts_mps = gusts_mps;
  if (Number.isFinite(battery_percent)) own.battery_percent = battery_percent;
  return own;
}
