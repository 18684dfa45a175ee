/** When routes reach their targets, the battery left, and their separation, as text. Values in, values out. */

import { t, tn } from "../../text.js";
import { durationText, energyText, heightText, lengthText, numberText, percentText } from "../../units.js";
import { timeAt } from "../options/flight_options.js";

/** @import { Plan, Route, Separation } from "../../api_types.d.ts" */
/** @import { ShownPlan } from "../types.d.ts" */

const SHORT_S = 120; // shorter gaps are shown in seconds

/** @typedef {{ index: number, kind: "base" | "charging", stay_s: number, charged_wh: number | null }} Stay */

/**
 * index of a target → { arrival_s, battery_percent } where a route first reaches it; null is not known.
 *
 * @param {Pick<Route, "waypoints" | "arrival_s" | "battery_left_percent">} route
 */
export function visitsOf({ waypoints, arrival_s, battery_left_percent }) {
  /** @type {Map<number | null, { arrival_s: number | null, battery_percent: number | null }>} */
  const visits = new Map();
  waypoints.forEach(({ kind, target }, index) => {
    if (kind === "target" && !visits.has(target))
      visits.set(target, {
        arrival_s: arrival_s?.[index] ?? null,
        battery_percent: battery_left_percent?.[index] ?? null,
      });
  });
  return visits;
}

/** Map of a target's key → text of its arrival; empty for plans without times. @param {ShownPlan | null} plan */
export function arrivalsOf(plan) {
  /** @type {Map<string, string>} */
  const arrivals = new Map();
  if (!plan) return arrivals;
  for (const route of plan.result.routes) {
    for (const [target, { arrival_s }] of visitsOf(route)) {
      const key = plan.targets[target ?? -1]?.key;
      if (key !== undefined && arrival_s !== null && !arrivals.has(key))
        arrivals.set(key, timeAt(plan.result.departs_at, arrival_s));
    }
  }
  return arrivals;
}

/**
 * "lands 14:32" is the last of these; null in plans without times.
 *
 * @param {Pick<Route, "arrival_s" | "departs_s" | "duration_s">} route
 */
export const landing_s = ({ arrival_s, departs_s, duration_s }) =>
  arrival_s?.length > 0 && arrival_s.at(-1) !== null ? departs_s + duration_s : null;

/**
 * Where a route waits on the way: at a base between two flights, on a tower to charge. [{ index, kind: "base" |
 * "charging", stay_s, charged_wh }]
 *
 * @param {Pick<Route, "waypoints" | "charging">} route
 * @returns {Stay[]}
 */
export function staysOf({ waypoints, charging }) {
  /** @type {Stay[]} */
  const stays = [];
  waypoints.forEach(({ kind, task }, index) => {
    if (kind === "base") stays.push({ index, kind, stay_s: task?.hold_s ?? 0, charged_wh: null });
  });
  for (const { waypoint, stopped_s, charged_wh } of charging ?? [])
    stays.push({ index: waypoint, kind: "charging", stay_s: stopped_s, charged_wh });
  return stays.sort((a, b) => a.index - b.index);
}

/** Time on stops with rotors off [s]. @param {Pick<Route, "waypoints" | "charging">} route */
export function standing_s(route) {
  const charging_s = (route.charging ?? []).reduce((sum, stop) => sum + stop.charging_s, 0);
  return staysOf(route)
    .filter(({ kind }) => kind === "base")
    .reduce((sum, { stay_s }) => sum + stay_s, charging_s);
}

/**
 * "in 2 flights", "charges 3 times"; empty for one flight without.
 *
 * @param {Pick<Route, "waypoints" | "charging">} route
 */
export function staysText(route) {
  const stays = staysOf(route);
  const [bases, chargings] = ["base", "charging"].map((kind) => stays.filter((stay) => stay.kind === kind).length);
  return [
    bases > 0 && tn(bases + 1, "in {count} flight", "in {count} flights"),
    chargings > 0 && tn(chargings, "charges {count} time", "charges {count} times"),
  ]
    .filter(Boolean)
    .join(", ");
}

/**
 * What one of them is: "Charges 8 min, +60 Wh", "At the base 10 min".
 *
 * @param {Pick<Stay, "kind" | "stay_s" | "charged_wh">} stay
 */
export function stayText({ kind, stay_s, charged_wh }) {
  const time = durationText(stay_s);
  return kind === "base"
    ? t("at the base {time}", { time })
    : t("charges {time}, +{energy}", { time, energy: energyText(charged_wh) });
}

/** "takes off 3 min later"; empty where it starts with the mission. @param {Pick<Route, "departs_s">} route */
export const delayText = ({ departs_s }) =>
  departs_s > 0 ? t("takes off {time} later", { time: durationText(departs_s) }) : "";

/** "34 %" and "61 Wh used"; null without a battery. @param {Pick<Route, "battery_percent" | "energy_wh">} route */
export function batteryOf({ battery_percent, energy_wh }) {
  if (battery_percent === null || battery_percent === undefined) return null;
  return { left: percentText(battery_percent), used: energyText(energy_wh) };
}

/**
 * Separation of the UAVs: { isFault, words }; null where the plan does not state it or only one flies. separation: see
 * SeparationSerializer; layers are those of the flown routes.
 *
 * @param {Pick<Plan, "separation" | "routes">} plan
 */
export function separationOf({ separation, routes }) {
  const flown = routes.filter(({ geometry }) => geometry);
  if (!separation?.unresolved || flown.length < 2) return null;
  if (separation.unresolved.length) return { isFault: true, words: separation.unresolved.map(conflictWords).join(" ") };
  const changes = flown.flatMap((route, index) => changeWords(route, separation.layers[index]) || []);
  const kept = changes.length
    ? t("Separation: {changes}.", { changes: changes.join(", ") })
    : t("The UAVs keep apart.");
  return { isFault: false, words: [kept, nearestWords(separation.closest)].filter(Boolean).join(" ") };
}

/** What one UAV does for separation; empty: nothing. @param {Pick<Route, "uav" | "departs_s">} route @param {number} layer_m */
function changeWords({ uav: name, departs_s }, layer_m) {
  const values = { name, time: durationText(departs_s), height: heightText(layer_m) };
  if (departs_s > 0 && layer_m > 0) return t("{name} starts {time} later and flies {height} higher", values);
  if (departs_s > 0) return t("{name} starts {time} later", values);
  return layer_m > 0 ? t("{name} flies {height} higher", values) : "";
}

/** @param {Separation["closest"]} closest */
function nearestWords(closest) {
  if (!closest) return "";
  const [one, other] = closest.uavs;
  const values = {
    one,
    other,
    distance: lengthText(closest.metres),
    time: closest.seconds < SHORT_S ? `${numberText(closest.seconds)}\u00a0s` : durationText(closest.seconds),
    height: heightText(closest.vertical_m ?? 0),
  };
  return closest.vertical_m === null || closest.vertical_m === undefined
    ? t("Closest pair: {one} and {other}, {distance} horizontally, {time} apart.", values)
    : t("Closest pair: {one} and {other}, {distance} horizontally, {height} vertically, {time} apart.", values);
}

/** @param {Separation["unresolved"][number]} conflict */
function conflictWords({ code, uavs, metres }) {
  if (code === "times_not_known")
    return t("{uav} of another mission: its flight times are not known, it may come near.", { uav: uavs[0] });
  const values = { one: uavs[0], other: uavs[1], distance: lengthText(metres) };
  return code === "hovers_in_the_way"
    ? t("{one} and {other}: one hovers in the way of the other.", values)
    : t("{one} and {other} come within {distance} of each other.", values);
}
