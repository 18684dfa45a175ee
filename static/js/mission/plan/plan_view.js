/** Texts and numbers of a plan for the page: letters, numbers, sentences. Values in, values out. */

import { routeLetter } from "../../domain/palette.js";
import { positionAt, profileOf } from "../../domain/route_profile.js";
import { t, tn } from "../../text.js";
import { durationText, energyText, lengthText } from "../../units.js";
import { changesOf } from "../hand/hand_route.js";
import { basisOf, storedBasisOf, withoutWishes } from "../selection.js";
import { ordersOf, wishedOrders } from "../targets/locks.js";

/** @import { Plan, Route } from "../../api_types.d.ts" */
/** @import { HandEdit, Lock, MissionPageState, MissionSelection, PickedTarget, ShownPlan, ShownRoute } from "../types.d.ts" */

/** @typedef {{ sequence: number, letter: string, number: number }} Place of a target in the plan */

/** Warnings of a plan that keep a UAV from flying. @type {string[]} */
export const GROUNDING = ["uav_inside_zone", "uav_out_of_service", "uav_incomplete"];

/** @type {{ value: Plan["objective"], words: string, meaning: string }[]} */
export const OBJECTIVES = [
  { value: "makespan", words: t("Finish soonest"), meaning: t("The last UAV is done as early as possible") },
  { value: "total", words: t("Shortest distance"), meaning: t("All routes together as short as possible") },
  {
    value: "time",
    words: t("Least flying time"),
    meaning: t("All UAVs together as few minutes in the air as possible"),
  },
  {
    value: "energy",
    words: t("Least energy"),
    meaning: t("All UAVs together with as little of their batteries as possible"),
  },
];

/**
 * The objective to compare with: for the earliest end the fewest metres, else the earliest end.
 *
 * @param {Plan["objective"]} objective
 * @returns {Plan["objective"]}
 */
export const otherObjective = (objective) => (objective === "makespan" ? "total" : "makespan");

/**
 * A plan that counts no energy of the routes flown is of UAVs whose battery's capacity is not stated: least energy means nothing for them.
 *
 * @param {ShownPlan | null} plan
 */
export const isWithoutCapacity = (plan) =>
  Boolean(plan?.result.routes.some(({ geometry }) => geometry)) && (plan?.result.total_energy_wh ?? null) === null;

/**
 * Routes with their place in the mission: [{ sequence, letter, name, route, targets }].
 *
 * @param {Pick<ShownPlan, "result"> | null} plan
 * @returns {ShownRoute[]}
 */
export function routesOf(plan) {
  if (!plan) return [];
  return plan.result.routes.map((route, sequence) => ({
    ...route,
    sequence,
    letter: routeLetter(sequence),
    name: route.uav,
  }));
}

/** Where planned photos are taken on routes, and where the camera looks. @param {readonly Pick<Route, "waypoints">[]} routes */
export const photosOf = (routes) =>
  routes.flatMap(({ waypoints }) =>
    waypoints.flatMap(({ position, task }) => (task?.view ? [{ position, yaw_deg: task.view.yaw_deg }] : [])),
  );

/**
 * The place of each target in the plan, or with the locks: key → { sequence, letter, number }.
 *
 * @param {ShownPlan | null} plan
 * @param {Lock[]} [locks]
 */
export function placesOf(plan, locks = []) {
  /** @type {Map<string, Place>} */
  const places = new Map();
  const wished = wishedOrders(ordersOf(plan), locks);
  for (const { sequence, letter } of routesOf(plan)) {
    wished[sequence].targets.forEach((key, index) => {
      places.set(key, { sequence, letter, number: index + 1 });
    });
  }
  return places;
}

/**
 * Targets in the order of the plan, those without a place last, in the order they were picked.
 *
 * @param {PickedTarget[]} targets
 * @param {Map<string, Place>} places
 */
export function inPlanOrder(targets, places) {
  /** @param {PickedTarget} target */
  const rank = (target) => {
    const place = places.get(target.key);
    return place ? place.sequence * 100_000 + place.number : Number.MAX_SAFE_INTEGER;
  };
  return targets
    .map((target, index) => ({ target, index }))
    .sort((a, b) => rank(a.target) - rank(b.target) || a.index - b.index)
    .map(({ target }) => target);
}

/** [{ target, sentence, reason, why }] for the targets that no route visits. @param {ShownPlan | null} plan */
export function unassignedOf(plan) {
  if (!plan) return [];
  return plan.result.unassigned.map((entry) => ({
    target: plan.targets[entry.target],
    reason: entry.reason,
    why: entry.why ?? [], // of old plans
    sentence: entry.message || t("No route visits it."),
  }));
}

/** From the mission's departure until the last UAV is done. @param {Pick<Plan, "routes">} result */
export function longestDuration_s(result) {
  return Math.max(0, ...result.routes.map((route) => route.duration_s + (route.departs_s ?? 0)));
}

/** "56 min, 79.5 km": the figures of an objective, where it has been planned. @param {Plan} result */
export function figuresOf(result) {
  return `${durationText(longestDuration_s(result))}, ${lengthText(result.total_length_m)}`;
}

/** The sentence first, then the figures. @param {Pick<ShownPlan, "result" | "targets">} plan */
export function sentenceOf(plan) {
  const { routes, unassigned, total_length_m } = plan.result;
  const flying = routes.filter((route) => route.geometry).length;
  const visited = plan.targets.length - unassigned.length;
  if (!flying)
    return {
      sentence: t("No target can be reached"),
      facts: tn(plan.targets.length, "{count} target", "{count} targets"),
    };
  const reached = unassigned.length
    ? tn(plan.targets.length, "{visited} of {count} target", "{visited} of {count} targets", { visited })
    : tn(visited, "all {count} target", "all {count} targets");
  const time = durationText(longestDuration_s(plan.result));
  const endsAfield = routes.some(
    (route) => route.geometry && route.end_action !== "return" && !plan.result.return_to_start,
  );
  const sentence = endsAfield ? t("Done in {time}", { time }) : t("All back in {time}", { time });
  return {
    sentence,
    facts: [
      reached,
      tn(flying, "{count} UAV", "{count} UAVs"),
      lengthText(total_length_m),
      ...energyFacts(plan.result),
    ].join(" · "),
  };
}

/** @param {Pick<Plan, "total_energy_wh">} result */
const energyFacts = ({ total_energy_wh }) =>
  total_energy_wh === null || total_energy_wh === undefined ? [] : [energyText(total_energy_wh)];

/**
 * How a route's flight ends: "ends hovering at A2".
 *
 * @param {Pick<ShownRoute, "end_action" | "base" | "letter" | "targets">} route
 */
export function endingOf({ end_action, base, letter, targets }) {
  if (end_action === "return") return t("returns to start");
  if (end_action === "base")
    return base ? t("lands at the base {name}", { name: base }) : t("lands at the nearest base");
  const last = `${letter}${targets.length}`;
  return end_action === "land"
    ? t("lands at {target}", { target: last })
    : t("ends hovering at {target}", { target: last });
}

/**
 * The same for the selection, before it is planned.
 *
 * @param {Pick<MissionSelection, "return_to_start" | "uavs">} selection
 */
export function endingsOf({ return_to_start, uavs }) {
  if (return_to_start) return t("Each UAV flies back to where it took off");
  const actions = new Set(uavs.map((uav) => uav.end_action));
  if (actions.size === 1 && actions.has("hover")) return t("Each UAV ends hovering at its last target");
  if (actions.size === 1 && actions.has("land")) return t("Each UAV lands at its last target");
  if (actions.size === 1 && actions.has("base")) return t("Each UAV lands at the nearest base");
  if (actions.size === 1 && actions.has("return")) return t("Each UAV of this mission is set to fly back all the same");
  return actions.size ? t("Each UAV ends as set for it, see its row") : t("Each UAV ends at its last target");
}

/**
 * targets: in the order flown: [{ label, isLocked? }].
 *
 * @param {ShownRoute} route
 * @param {{ label?: string, isLocked?: boolean }[]} targets
 */
export function stripLabel(route, targets) {
  const names = targets
    .map(({ label, isLocked }, index) => `${index + 1} ${label ?? t("Target")}${isLocked ? ` ${t("(locked)")}` : ""}`)
    .join(", ");
  const values = {
    name: route.name,
    length: lengthText(route.length_m),
    time: durationText(route.duration_s),
    ending: endingOf(route),
    targets: names || t("no targets"),
  };
  return t("{name} flies {length} in {time} and {ending}: {targets}.", values);
}

/**
 * The plan to compare the present one with: the previous one on the page, else the one stored with the mission.
 *
 * @param {Pick<MissionPageState, "lastPlan" | "mission">} state
 */
export function lastPlanOf({ lastPlan, mission }) {
  return lastPlan ?? mission?.last_plan ?? null;
}

/**
 * The manually edited route as it would be flown: with the waypoints of the server's last check.
 *
 * @param {ShownRoute} route
 * @param {Pick<HandEdit, "look" | "points" | "original">} hand
 * @returns {ShownRoute}
 */
function wishedRoute(route, { look, points, original }) {
  if (!look?.flown || !changesOf(points, original)) return route;
  const [length_m, duration_s] = [look.length_m ?? route.length_m, look.duration_s ?? route.duration_s]; // known where it can be flown
  return { ...route, ...look.flown, length_m, duration_s, isWished: true };
}

/**
 * The route whose profile and reasons are shown: the manually edited one; else the chosen one; else the longest. Null without routes.
 *
 * @param {Pick<MissionPageState, "plan" | "lookedAt" | "chosenRoute" | "hand">} state
 */
export function shownRoute({ plan, lookedAt, chosenRoute, hand }) {
  const flown = routesOf(plan).filter((route) => route.geometry);
  const changed = hand && flown.find((route) => route.sequence === hand.sequence);
  if (changed) return wishedRoute(changed, hand);
  return (
    [lookedAt, chosenRoute].map((sequence) => flown.find((route) => route.sequence === sequence)).find(Boolean) ??
    flown.sort((a, b) => b.length_m - a.length_m)[0] ??
    null
  );
}

/**
 * Position on the map [lon, lat] of the pointer on a strip or a profile. along: { sequence, at_m, isWished }: isWished on the profile of
 * a manually edited route. Null where that is no longer shown.
 *
 * @param {Pick<MissionPageState, "along" | "plan" | "lookedAt" | "chosenRoute" | "hand">} state
 */
export function pointAlong(state) {
  const { along, plan } = state;
  if (!along || !plan) return null;
  const stored = routesOf(plan).find(({ sequence, geometry }) => sequence === along.sequence && geometry);
  const shown = along.isWished ? shownRoute(state) : null;
  const route = !along.isWished ? stored : shown?.isWished && shown.sequence === along.sequence ? shown : null;
  return route ? positionAt(route.waypoints, profileOf(route.waypoints, route.length_m).places, along.at_m) : null;
}

/**
 * Whether the plan on the page belongs to the current selection.
 *
 * @param {Pick<MissionPageState, "plan" | "selection">} state
 */
export function isPlanCurrent(state) {
  return state.plan !== null && state.plan.basis === basisOf(state.selection);
}

/**
 * Whether the plan on the page belongs to the selection, except for newer locks and wishes: they can be shown in it.
 *
 * @param {Pick<MissionPageState, "plan" | "selection">} state
 */
export function isPlanInSight(state) {
  return (
    isPlanCurrent(state) || (state.plan !== null && state.plan.freeBasis === basisOf(withoutWishes(state.selection)))
  );
}

/**
 * Places of the current selection, none where the plan belongs to another one; and the keys that no route visits.
 *
 * @param {Pick<MissionPageState, "plan" | "selection">} state
 */
export function shownPlaces(state) {
  if (!isPlanInSight(state)) return { places: placesOf(null), missed: new Set() };
  const places = placesOf(state.plan, state.selection.locks);
  const unreached = unassignedOf(state.plan).map(({ target }) => target?.key);
  return { places, missed: new Set(unreached.filter((key) => !places.has(key))) };
}

/**
 * Whether leaving the page would lose changes.
 *
 * @param {Pick<MissionPageState, "mission" | "selection" | "name" | "plan" | "planIsStored" | "savedBasis">} state
 */
export function isUnsaved(state) {
  if (!state.mission) return state.selection.targets.length > 0 || state.name.trim() !== "";
  const planUnsaved = isPlanCurrent(state) && !state.planIsStored;
  return (
    planUnsaved ||
    storedBasisOf(state.selection) !== state.savedBasis ||
    (state.name.trim() || state.mission.name) !== state.mission.name
  );
}
