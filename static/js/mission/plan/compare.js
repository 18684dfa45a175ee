/** Comparison of two plans of one mission: the difference for each UAV, and targets that moved to another UAV. */

import { distance_m } from "../../domain/geodesy.js";
import { profileOf } from "../../domain/route_profile.js";
import { t, tn } from "../../text.js";
import { durationText, energyText, lengthText } from "../../units.js";
import { keyOf, wishesOf } from "../selection.js";
import { longestDuration_s } from "./plan_view.js";

/** @import { LastTarget, Plan } from "../../api_types.d.ts" */
/** @import { PickedTarget, ShortPlan, ShortRoute, ShownPlan } from "../types.d.ts" */

/**
 * A plan on the page in the short form that the server stores of the previous one: see LastPlanSerializer.
 *
 * @param {Pick<ShownPlan, "result" | "targets">} plan
 * @returns {ShortPlan}
 */
export function summaryOfPlan({ result, targets }) {
  return {
    planned_at: null,
    objective: result.objective,
    return_to_start: result.return_to_start,
    total_length_m: result.total_length_m,
    duration_s: longestDuration_s(result),
    routes: result.routes.map((route) => {
      const profile = profileOf(route.waypoints, route.length_m);
      return {
        uav: route.uav,
        uav_id: route.uav_id,
        start: route.waypoints[0]?.position ?? null,
        end_action: route.end_action,
        base: route.base ?? null,
        length_m: route.length_m,
        duration_s: route.duration_s,
        stops: profile.targets
          .map(({ target, at }) => ({ target: targets[target ?? -1], at_m: at }))
          .filter(({ target }) => target)
          .map(({ target, at_m }) => ({ ...pickOf(target), at_m })),
        off_network: profile.legs.filter((leg) => leg.offNetwork).map(({ from, to }) => [from, to]),
      };
    }),
    unassigned: result.unassigned.filter(({ target }) => targets[target]).map(({ target }) => pickOf(targets[target])),
  };
}

/** @param {PickedTarget} target @returns {LastTarget} */
const pickOf = ({ asset, position, stretch, label }) => ({
  asset,
  position: position ?? null,
  stretch: stretch ?? null,
  label,
});

/** @param {Pick<ShortRoute, "uav" | "uav_id">} a @param {Pick<ShortRoute, "uav" | "uav_id">} b */
const isSameUav = (a, b) => (a.uav_id !== null && b.uav_id !== null ? a.uav_id === b.uav_id : a.uav === b.uav);

/**
 * Whether two plans fly the same: planning an unchanged selection again is not another plan.
 *
 * @param {ShortPlan} a
 * @param {ShortPlan} b
 */
export function isSamePlan(a, b) {
  /** @param {ShortPlan} plan */
  const essence = ({ routes }) =>
    JSON.stringify(routes.map(({ uav, length_m, stops }) => [uav, Math.round(length_m), stopsOf(stops).map(keyOf)]));
  /** @param {ShortRoute} route */
  const beginsAndEndsAlike = (route) => {
    const { moved_m, to } = endsBetween(counterpart(route, a), route);
    return moved_m === 0 && to === null;
  };
  return essence(a) === essence(b) && b.routes.every(beginsAndEndsAlike);
}

const MIN_MOVED_M = 1;
const PRIORITIES = ["high", "normal", "low"];
const AS_GOOD = 0.05; // metres or seconds, as they are rounded in a plan

/**
 * Whether a plan is worse than another of the same selection on the same map data: fewer targets reached, then longer.
 *
 * @param {ShownPlan} plan
 * @param {ShownPlan} than
 */
export function isWorse(plan, than) {
  const [mine, theirs] = [plan, than].map(meritOf);
  const first = mine.findIndex((value, index) => Math.abs(value - theirs[index]) > AS_GOOD);
  return isOnSameGround(plan.result, than.result) && first !== -1 && mine[first] > theirs[first];
}

/** Less is better, in this order; as the planner counts. @param {ShownPlan} plan */
function meritOf({ result, targets }) {
  const missed = PRIORITIES.map(
    (priority) =>
      result.unassigned.filter(({ target }) => wishesOf(targets[target] ?? {}).priority === priority).length,
  );
  const [total, longest] = [result.total_length_m, longestDuration_s(result)];
  const { objective, total_duration_s, total_energy_wh } = result;
  const [time, energy] = [total_duration_s ?? longest, total_energy_wh ?? total];
  const first = { total, time, energy, makespan: longest }[objective];
  return [...missed, first, ...(objective === "total" ? [longest] : [total])];
}

/**
 * Whether only the search can differ between the two: the same network, zones, heights, and available UAVs; bases may have moved.
 *
 * @param {Plan} a
 * @param {Plan} b
 */
function isOnSameGround(a, b) {
  /** @param {Plan} plan */
  const ground = ({ graph_version, ground_revision, warnings }) =>
    JSON.stringify([graph_version, ground_revision, (warnings ?? []).map(({ code, uav }) => [code, uav])]);
  /** @param {Plan} plan */
  const landsAtBase = ({ routes }) => routes.some(({ end_action }) => end_action === "base");
  return ground(a) === ground(b) && !landsAtBase(a) && !landsAtBase(b);
}

/** A stretch has several waypoints of one target: the first of them is the stop. @param {ShortRoute["stops"]} stops */
function stopsOf(stops) {
  return stops.filter((stop, index) => index === 0 || keyOf(stop) !== keyOf(stops[index - 1]));
}

/**
 * Where each target is in a short plan: key → { route, number, label }; without a route: not reached.
 *
 * @param {ShortPlan} plan
 */
function placesIn(plan) {
  /** @type {Map<string, { route: ShortRoute | null, number: number, label: string }>} */
  const places = new Map();
  for (const target of plan.unassigned) places.set(keyOf(target), { route: null, number: 0, label: target.label });
  for (const route of plan.routes)
    stopsOf(route.stops).forEach((stop, index) => {
      places.set(keyOf(stop), { route, number: index + 1, label: stop.label });
    });
  return places;
}

/**
 * before and now are plans in short. [{ key, label, from, to }]: from and to are routes, null where it is not reached;
 * undefined where it is not in that plan.
 *
 * @param {ShortPlan} before
 * @param {ShortPlan} now
 */
export function movesBetween(before, now) {
  const [old, fresh] = [placesIn(before), placesIn(now)];
  /**
   * @type {{ key: string, label: string, from: ShortRoute | null | undefined, to: ShortRoute | null | undefined }[]}
   */
  const moves = [];
  for (const [key, { route, label }] of fresh) {
    const was = old.get(key);
    const isSame = was && (was.route === route || (was.route && route && isSameUav(was.route, route)));
    if (!isSame) moves.push({ key, label, from: was?.route, to: route });
  }
  for (const [key, { route, label }] of old)
    if (!fresh.has(key)) moves.push({ key, label, from: route, to: undefined });
  return moves;
}

/**
 * The route of the same UAV in another plan, or null.
 *
 * @param {Pick<ShortRoute, "uav" | "uav_id">} route
 * @param {ShortPlan | null | undefined} plan
 */
export function counterpart(route, plan) {
  return plan?.routes.find((other) => isSameUav(other, route)) ?? null;
}

/**
 * Differences in the start and end of a route from the same UAV's in another plan: { moved_m, from, to }; from and to are { end_action,
 * base }, null where they are equal. There are none where the stored plan does not contain them.
 *
 * @param {ShortRoute | null | undefined} old
 * @param {ShortRoute} now
 */
export function endsBetween(old, now) {
  const moved_m = old?.start && now.start ? distance_m(old.start, now.start) : 0;
  const isSame = !old?.end_action || (old.end_action === now.end_action && old.base === now.base);
  const [from, to] = isSame ? [null, null] : [old, now].map(({ end_action, base }) => ({ end_action, base }));
  return { moved_m: moved_m < MIN_MOVED_M ? 0 : moved_m, from, to };
}

/** A route in short form for the drawing of a strip. @param {ShortRoute} route */
export function profileOfSummary({ length_m, stops, off_network }) {
  const cuts = [...new Set([0, length_m, ...off_network.flat()])]
    .filter((at) => at >= 0 && at <= length_m)
    .sort((a, b) => a - b);
  /** @param {number} at */
  const isOff = (at) => off_network.some(([from, to]) => at >= from && at < to);
  const legs = cuts.slice(1).map((to, index) => ({ from: cuts[index], to, offNetwork: isOff(cuts[index]) }));
  return {
    places: [0, length_m],
    legs,
    targets: stopsOf(stops).map((stop) => ({ target: keyOf(stop), at: stop.at_m })),
    ticks: [],
  };
}

/**
 * "+1.2 km", "−3 min", "=": more or less than before.
 *
 * @param {number} difference
 * @param {number} least
 * @param {(value: number) => string} textOf
 */
export function moreOrLess(difference, least, textOf) {
  if (Math.abs(difference) < least) return "=";
  return `${difference > 0 ? "+" : "−"}${textOf(Math.abs(difference))}`;
}

/** @typedef {Pick<Plan, "routes" | "total_length_m" | "unassigned">} Compared */
/** @typedef {Compared & Pick<Plan, "objective" | "total_duration_s" | "total_energy_wh">} Valued */

/** @type {Record<Plan["objective"], { least: number, of: (plan: Valued) => number }>} what counts, and less than which is no offer */
const COUNTED = {
  total: { least: 50, of: ({ total_length_m }) => total_length_m },
  makespan: { least: 30, of: longestDuration_s },
  time: { least: 30, of: ({ total_duration_s }) => total_duration_s ?? 0 },
  energy: { least: 1, of: ({ total_energy_wh }) => total_energy_wh ?? 0 },
};

/**
 * What is better in a plan by what it is optimised for, then what else differs; empty where it reaches no more targets and its own figure
 * is better by seconds, metres or parts of a watt-hour alone.
 *
 * @param {Valued} before
 * @param {Valued} after
 */
export function improvementWords(before, after) {
  const { objective } = after;
  const { least, of } = COUNTED[objective];
  const more = of(after) - of(before);
  if (Math.abs(more) < least && after.unassigned.length >= before.unassigned.length) return "";
  const own = {
    energy: () => moreOrLess(more, 0, energyText),
    time: () => t("{time} of flight", { time: moreOrLess(more, 0, durationText) }),
    makespan: () => "", // among the others, as is the length
    total: () => "",
  }[objective]();
  return [Math.abs(more) < least ? "" : own, ...differences(before, after)].filter(Boolean).join(", ");
}

/**
 * "+3 min, −1.1 km, 1 target fewer": a plan against the one before.
 *
 * @param {Compared} before
 * @param {Compared} after
 */
export const differenceWords = (before, after) =>
  differences(before, after).join(", ") || t("as long and as far as before");

/** What differs in more than seconds and metres. @param {Compared} before @param {Compared} after */
export function differences(before, after) {
  const missed = after.unassigned.length - before.unassigned.length;
  const parts = [
    moreOrLess(longestDuration_s(after) - longestDuration_s(before), 30, durationText),
    moreOrLess(after.total_length_m - before.total_length_m, 50, lengthText),
  ].filter((words) => words !== "=");
  if (missed > 0) parts.push(tn(missed, "{count} more target is not reached", "{count} more targets are not reached"));
  if (missed < 0) parts.push(tn(-missed, "{count} more target is reached", "{count} more targets are reached"));
  return parts;
}
