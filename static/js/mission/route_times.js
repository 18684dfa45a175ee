/** When routes reach their targets, what is left of their batteries, and how they are kept apart: in words. Values in, values out. */

import { t, tn } from "../text.js";
import { durationText, energyText, heightText, lengthText, numberText, percentText } from "../units.js";
import { timeAt } from "./flight_options.js";

/** index of a target → { arrival_s, battery_percent } where a route first reaches it; null is not known. */
export function visitsOf({ waypoints, arrival_s, battery_left_percent }) {
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

/** key of a target → when it is reached, in words; empty for plans without times. */
export function arrivalsOf(plan) {
  const arrivals = new Map();
  for (const route of plan?.result.routes ?? []) {
    for (const [target, { arrival_s }] of visitsOf(route)) {
      const key = plan.targets[target]?.key;
      if (key !== undefined && arrival_s !== null && !arrivals.has(key))
        arrivals.set(key, timeAt(plan.result.departs_at, arrival_s));
    }
  }
  return arrivals;
}

/** "lands 14:32" is the last of these; null in plans without times. */
export const landing_s = ({ arrival_s, departs_s, duration_s }) =>
  arrival_s?.length > 0 && arrival_s.at(-1) !== null ? departs_s + duration_s : null;

/** Where a route waits on the way: at a base between two flights, on a tower to charge. [{ index, kind: "base" | "charging", stay_s, charged_wh }] */
export function staysOf({ waypoints, charging }) {
  const bases = waypoints.flatMap(({ kind, task }, index) =>
    kind === "base" ? [{ index, kind: "base", stay_s: task?.hold_s ?? 0, charged_wh: null }] : [],
  );
  const chargings = (charging ?? []).map(({ waypoint, stopped_s, charged_wh }) => ({
    index: waypoint,
    kind: "charging",
    stay_s: stopped_s,
    charged_wh,
  }));
  return [...bases, ...chargings].sort((a, b) => a.index - b.index);
}

/** How long it stands on the way with its rotors off. */
export function standing_s(route) {
  const charging_s = (route.charging ?? []).reduce((sum, stop) => sum + stop.charging_s, 0);
  return staysOf(route)
    .filter(({ kind }) => kind === "base")
    .reduce((sum, { stay_s }) => sum + stay_s, charging_s);
}

/** "in 2 flights", "charges 3 times"; empty for one flight without. */
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

/** What one of them is: "Charges 8 min, +60 Wh", "At the base 10 min". */
export function stayText({ kind, stay_s, charged_wh }) {
  const time = durationText(stay_s);
  return kind === "base"
    ? t("at the base {time}", { time })
    : t("charges {time}, +{energy}", { time, energy: energyText(charged_wh) });
}

/** "takes off 3 min later"; empty where it starts with the mission. */
export const delayText = ({ departs_s }) =>
  departs_s > 0 ? t("takes off {time} later", { time: durationText(departs_s) }) : "";

/** "34 %" and "61 Wh used"; null without a battery. */
export function batteryOf({ battery_percent, energy_wh }) {
  if (battery_percent === null || battery_percent === undefined) return null;
  return { left: percentText(battery_percent), used: energyText(energy_wh) };
}

/**
 * How the UAVs are kept apart: { isFault, words }; null where the plan does not say or one flies alone.
 *
 * separation: see SeparationSerializer; layers are those of the routes that are flown.
 */
export function separationOf({ separation, routes }) {
  const flown = routes.filter(({ geometry }) => geometry);
  if (!separation?.unresolved || flown.length < 2) return null;
  if (separation.unresolved.length) return { isFault: true, words: separation.unresolved.map(conflictWords).join(" ") };
  const changes = flown.flatMap(({ uav, departs_s }, index) =>
    [
      departs_s > 0 && t("{name} takes off {time} later", { name: uav, time: durationText(departs_s) }),
      separation.layers[index] > 0 &&
        t("{name} flies {height} higher", { name: uav, height: heightText(separation.layers[index]) }),
    ].filter(Boolean),
  );
  const kept = changes.length
    ? t("Kept apart: {changes}.", { changes: changes.join(", ") })
    : t("The UAVs keep apart.");
  return { isFault: false, words: [kept, nearestWords(separation.closest)].filter(Boolean).join(" ") };
}

function nearestWords(closest) {
  if (!closest) return "";
  const [one, other] = closest.uavs;
  const values = {
    one,
    other,
    distance: lengthText(closest.metres),
    time: `${numberText(closest.seconds)}\u00a0s`,
    height: heightText(closest.vertical_m ?? 0),
  };
  return closest.vertical_m === null || closest.vertical_m === undefined
    ? t("Nearest: {one} and {other}, {distance} apart, {time} one after the other.", values)
    : t(
        "Nearest: {one} and {other}, {distance} apart, {height} one above the other, {time} one after the other.",
        values,
      );
}

function conflictWords({ code, uavs, metres }) {
  const values = { one: uavs[0], other: uavs[1], distance: lengthText(metres) };
  return code === "hovers_in_the_way"
    ? t("{one} and {other}: one hovers in the way of the other.", values)
    : t("{one} and {other} come within {distance} of each other.", values);
}
