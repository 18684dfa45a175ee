/** What a plan means for the page: letters, numbers, sentences. Values in, values out. */

import { routeLetter } from "../map/palette.js";
import { t, tn } from "../text.js";
import { durationText, lengthText } from "../units.js";
import { inWords } from "./plan_words.js";
import { basisOf } from "./selection.js";

const REASONS = {
  no_path: t("No way along the network leads there."),
  inside_zone: t("It stands inside a no-fly zone."),
  beyond_range: t("It is out of range."),
  too_far_from_network: t("It is too far from the network."),
  above_height_limit: t("It is higher than may be flown."),
  asset_gone: t("It is no longer in the data."),
};

export const OBJECTIVES = [
  { value: "makespan", words: t("Even routes"), meaning: t("The longest route as short as possible") },
  { value: "total", words: t("Fly least"), meaning: t("All routes together as short as possible") },
];

export const otherObjective = (objective) => (objective === "total" ? "makespan" : "total");

/** Routes with their place in the mission: [{ sequence, letter, name, route, targets }]. */
export function routesOf(plan) {
  if (!plan) return [];
  return plan.result.routes.map((route, sequence) => ({ ...route, sequence, letter: routeLetter(sequence), name: route.uav }));
}

/** Where each target stands in the plan: key → { sequence, letter, number }. */
export function placesOf(plan) {
  const places = new Map();
  for (const route of routesOf(plan)) {
    route.targets.forEach((target, index) => {
      const key = plan.targets[target]?.key;
      if (key) places.set(key, { sequence: route.sequence, letter: route.letter, number: index + 1 });
    });
  }
  return places;
}

/** Targets in the order of the plan, those without a place last, in the order they were picked. */
export function inPlanOrder(targets, places) {
  const rank = (target) => {
    const place = places.get(target.key);
    return place ? place.sequence * 100_000 + place.number : Number.MAX_SAFE_INTEGER;
  };
  return targets.map((target, index) => ({ target, index })).sort((a, b) => rank(a.target) - rank(b.target) || a.index - b.index).map(({ target }) => target);
}

/** [{ target, sentence, reason }] for the targets that no route visits. */
export function unreachedOf(plan) {
  if (!plan) return [];
  return plan.result.unassigned.map((entry) => ({
    target: plan.targets[entry.target],
    reason: entry.reason,
    sentence: inWords(entry.message, REASONS[entry.reason]) || t("No route visits it."),
  }));
}

export function longestDuration_s(result) {
  return Math.max(0, ...result.routes.map((route) => route.duration_s));
}

/** "Even routes 56 min, 79.5 km": what an objective gives, where it has been planned. */
export function figuresOf(result) {
  return `${durationText(longestDuration_s(result))}, ${lengthText(result.total_length_m)}`;
}

/** The sentence first, then the figures. */
export function sentenceOf(plan) {
  const { routes, unassigned, total_length_m } = plan.result;
  const flying = routes.filter((route) => route.geometry).length;
  const visited = plan.targets.length - unassigned.length;
  if (!flying) return { sentence: t("No target can be reached"), facts: tn(plan.targets.length, "{count} target", "{count} targets") };
  const reached = unassigned.length
    ? tn(plan.targets.length, "{visited} of {count} target", "{visited} of {count} targets", { visited })
    : tn(visited, "all {count} target", "all {count} targets");
  const time = durationText(longestDuration_s(plan.result));
  const endsAfield = routes.some((route) => route.geometry && route.end_action !== "return" && !plan.result.return_to_start);
  const sentence = endsAfield ? t("Done in {time}", { time }) : t("All back in {time}", { time });
  return { sentence, facts: [reached, tn(flying, "{count} UAV", "{count} UAVs"), lengthText(total_length_m)].join(" · ") };
}

/** How a route's flight ends: "ends hovering at A2". */
export function endingOf({ end_action, letter, targets }) {
  if (end_action === "return") return t("returns to start");
  const last = `${letter}${targets.length}`;
  return end_action === "land" ? t("lands at {target}", { target: last }) : t("ends hovering at {target}", { target: last });
}

/** The same for what is picked, before it is planned. */
export function endingsOf({ return_to_start, uavs }) {
  if (return_to_start) return t("Each UAV flies back to where it took off");
  const actions = new Set(uavs.map((uav) => uav.end_action));
  if (actions.size === 1 && actions.has("hover")) return t("Each UAV ends hovering at its last target");
  if (actions.size === 1 && actions.has("land")) return t("Each UAV lands at its last target");
  if (actions.size === 1 && actions.has("return")) return t("Each UAV of this mission is set to fly back all the same");
  return actions.size ? t("Each UAV ends as set for it, see its row") : t("Each UAV ends at its last target");
}

export function stripLabel(route, targets) {
  const names = route.targets.map((target, index) => `${index + 1} ${targets[target]?.label ?? t("Target")}`).join(", ");
  const values = { name: route.name, length: lengthText(route.length_m), time: durationText(route.duration_s), ending: endingOf(route), targets: names || t("no targets") };
  return t("{name} flies {length} in {time} and {ending}: {targets}.", values);
}

/** The plan to compare the present one with: the one before it on the page, else the one that the mission remembers. */
export function lastPlanOf({ lastPlan, mission }) {
  return lastPlan ?? mission?.last_plan ?? null;
}

/** Whose profile and reasons are shown where nobody has chosen: the longest route's. Null where nobody flies. */
export function shownRoute({ plan, lookedAt, chosenRoute }) {
  const flown = routesOf(plan).filter((route) => route.geometry);
  return [lookedAt, chosenRoute].map((sequence) => flown.find((route) => route.sequence === sequence)).find(Boolean) ?? flown.sort((a, b) => b.length_m - a.length_m)[0] ?? null;
}

/** Whether the plan on the page is the plan of what is picked. */
export function isPlanCurrent(state) {
  return state.plan !== null && state.plan.basis === basisOf(state.selection);
}

/** Whether leaving the page would lose something. */
export function isUnsaved(state) {
  if (!state.mission) return state.selection.targets.length > 0 || state.name.trim() !== "";
  const basis = basisOf(state.selection);
  const planUnsaved = state.plan !== null && state.plan.basis === basis && !state.planIsStored;
  return planUnsaved || basis !== state.savedBasis || (state.name.trim() || state.mission.name) !== state.mission.name;
}
