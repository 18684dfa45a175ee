/** Why no route visits a target: the reason, the figures behind it, and one change or more that would help. */

import { h } from "../../../dom.js";
import { shownWhereTimed } from "../../../map/zone_details.js";
import { t, tn } from "../../../text.js";
import { heightText, lengthText } from "../../../units.js";
import { showLegalTimes } from "../options/legal_times.js";

/** @import { Reach, TargetExplanation, Unassigned } from "../../../api_types.d.ts" */
/** @import { Child } from "../../../dom.js" */
/** @import { MissionActions, MissionStore, PickedTarget, ShownPlan } from "../../types.d.ts" */
/** @import { Explaining } from "./route.js" */

const WALL = /^the \S+ m around a mast(?: or wires|, wires or a bridge) that cannot be flown over$/;

/** A zone's name in the reader's language, where it is no name but a description. @param {string} words */
function zoneOf(words) {
  if (WALL.test(words)) return t("the surroundings of a mast, wires or a bridge that cannot be flown over");
  return /^the \S+ m around a no-fly zone$/.test(words) ? t("the margin round a no-fly zone") : words;
}

/** @param {TargetExplanation} explanation @param {Unassigned} entry @param {Explaining} explaining @returns {Child[]} */
export function targetExplanation(explanation, entry, { plan, store, actions, canPlan }) {
  const target = plan.targets[explanation.target];
  const full = fullUavs(explanation, plan);
  return [
    h(
      "p",
      { class: "why-sentence" },
      isRangeOfPlan(explanation, entry) ? entry.message : reasonWords(explanation, full) || entry.message,
    ),
    facts(explanation),
    canPlan && changes(explanation, { target, full, store, actions }),
  ];
}

/**
 * UAVs of the mission that could fly there but for having as many targets as they may.
 *
 * @param {Pick<TargetExplanation, "uavs">} explanation
 * @param {Pick<ShownPlan, "result">} plan
 */
export function fullUavs(explanation, plan) {
  /** @param {Reach} uav */
  const done = (uav) => new Set(plan.result.routes.find((route) => route.uav === uav.name)?.targets).size;
  return explanation.uavs.filter(
    (uav) =>
      uav.is_in_mission &&
      uav.is_enough &&
      uav.most_targets !== null &&
      uav.most_targets !== undefined &&
      done(uav) >= uav.most_targets,
  );
}

/** @param {TargetExplanation} explanation @param {Reach[]} full */
function sharedWords(explanation, full) {
  const able = (explanation.uavs ?? []).filter((uav) => uav.is_in_mission && uav.is_enough);
  if (!full.length)
    return t("One UAV alone could fly there, but none has range or battery left after its other targets.");
  const names = full.map(({ name }) => name).join(", ");
  const words = tn(
    full.length,
    "{names} could fly there, but has as many targets as it may have.",
    "{names} could fly there, but have as many targets as they may have.",
    { names },
  );
  return full.length === able.length
    ? words
    : `${words} ${t("No other UAV has the range left after its other targets.")}`;
}

/**
 * Whether the plan states whose range is too short, by how much, and what excludes the others.
 * @param {TargetExplanation} explanation @param {Unassigned} entry
 */
const isRangeOfPlan = ({ reason }, entry) => reason === "beyond_range" && entry.reason === reason;

/** @param {TargetExplanation} explanation @param {Reach[]} [full] see fullUavs */
export function reasonWords(explanation, full = []) {
  const zones = explanation.zones.map(({ name }) => zoneOf(name)).join(", ");
  const lengths = { reach: lengthText(explanation.access_limit_m), distance: lengthText(explanation.network_m) };
  /** @type {Partial<Record<TargetExplanation["reason"], () => string>>} */
  const words = {
    asset_gone: () => t("It has been deleted from the data since it was picked."),
    inside_zone: () =>
      explanation.stretches.length
        ? t("It runs through {zones}.", { zones })
        : t("It stands inside {zones}.", { zones: zones || t("the margin round a no-fly zone") }),
    above_height_limit: () =>
      t("It is {height} high. A UAV would have to fly at {needed}; the limit is {limit}.", {
        height: heightText(explanation.height_m ?? 0),
        needed: heightText(explanation.needed_height_m ?? 0),
        limit: heightText(explanation.height_limit_m),
      }),
    too_far_from_network: () =>
      t("The nearest line, railway or bridge is {distance} away; up to {reach} is flown off the network.", lengths),
    no_path: () => explanation.message,
    beyond_range: () => t("It is out of range of every UAV of this mission."),
    beyond_energy: () => explanation.message || t("No battery lasts for the way there and back."),
    wind: () => t("The wind is too strong on every way to it, or back."),
    not_allowed: () => t("No UAV may fly it: none has the sensor, or is the one it is tied to."),
    most_targets: () => t("Every UAV that could fly it has as many targets as it may."),
    not_with_the_others: () => sharedWords(explanation, full),
  };
  return words[explanation.reason]?.() ?? "";
}

/** @param {TargetExplanation} explanation */
function facts(explanation) {
  const needs = explanation.uavs.filter(({ is_in_mission }) => is_in_mission);
  if (!needs.length || ["beyond_energy", "wind"].includes(explanation.reason)) return null; // ranges do not apply to them
  /** @param {Reach} reach */
  const row = ({ name, needed_m, max_range_m, most_targets, is_grounded }) => {
    const limit = most_targets ? tn(most_targets, "at most {count} target", "at most {count} targets") : "";
    const has = [max_range_m === null ? t("not limited") : lengthText(max_range_m), limit].filter(Boolean).join(", ");
    const needed = is_grounded ? t("cannot take off") : needed_m === null ? t("no way") : lengthText(needed_m);
    return h("tr", {}, h("th", { scope: "row" }, name), h("td", {}, needed), h("td", {}, has));
  };
  return h(
    "table",
    { class: "why-table" },
    h(
      "thead",
      {},
      h(
        "tr",
        {},
        [t("UAV"), t("needs"), t("has")].map((words) => h("th", { scope: "col" }, words)),
      ),
    ),
    h("tbody", {}, needs.map(row)),
  );
}

/**
 * What would help.
 *
 * @param {TargetExplanation} explanation
 * @param {{ target: PickedTarget, full: Reach[], store: MissionStore, actions: MissionActions }} context
 */
function changes(explanation, { target, full, store, actions }) {
  const list = [];
  if (explanation.stretches.length)
    list.push(
      act(t("The parts outside can be flown."), t("Take the parts outside"), () =>
        actions.replaceByStretches(target, explanation.stretches),
      ),
    );
  for (const { name, most_targets } of full) {
    const most = most_targets ?? 0;
    const raise = () => {
      const place = store.state.selection.uavs.findIndex((uav) => uav.name === name);
      actions.changeUav(place, { most_targets: most + 1 });
      actions.plan();
    };
    list.push(
      act(
        tn(most, "{name} may do {count} target at most.", "{name} may do {count} targets at most.", { name }),
        t("Let {name} do one more", { name }),
        raise,
      ),
    );
  }
  if (!["beyond_energy", "wind"].includes(explanation.reason)) list.push(...changesOfRange(explanation.uavs, actions));
  if (explanation.reason === "not_with_the_others")
    list.push(h("li", {}, t("Add a UAV, or plan it as a flight of its own.")));
  if (["inside_zone", "no_path"].includes(explanation.reason))
    list.push(
      ...explanation.zones.flatMap(({ id }) =>
        id === null ? [] : [changeOfTime(id, () => showLegalTimes(store, actions))],
      ),
    );
  const remove = () => {
    store.update({ why: null });
    actions.removeTargets([target.key]);
  };
  list.push(act(t("The plan goes without it."), t("Remove it"), remove));
  return h("div", {}, h("h3", {}, t("What would help")), h("ul", { class: "why-changes" }, list));
}

/** Another departure. @param {number} id of the zone @param {() => unknown} run */
const changeOfTime = (id, run) =>
  shownWhereTimed(act(t("The zone is not always in force."), t("Look for a better departure"), run), id);

/** What helps a target that is out of range. @param {Reach[]} uavs @param {MissionActions} actions */
function changesOfRange(uavs, actions) {
  const list = [];
  const spare = uavs.find((uav) => !uav.is_in_mission && uav.is_enough);
  const id = spare?.uav_id ?? null;
  if (spare && id !== null) {
    const takeAlong = () => {
      actions.addUavOfFleet(id);
      actions.plan();
    };
    list.push(
      act(
        t("{name} could fly there: it needs {needed}.", { name: spare.name, needed: lengthText(spare.needed_m) }),
        t("Take {name} along", { name: spare.name }),
        takeAlong,
      ),
    );
  }
  const [nearest] = uavs
    .filter(
      ({ is_in_mission, is_allowed, needed_m, max_range_m, is_enough }) =>
        is_in_mission && is_allowed && needed_m !== null && max_range_m !== null && !is_enough,
    )
    .map(({ name, needed_m, max_range_m }) => ({ name, missing_m: (needed_m ?? 0) - (max_range_m ?? 0) }))
    .sort((a, b) => a.missing_m - b.missing_m);
  if (nearest)
    list.push(
      h(
        "li",
        {},
        t("{name} would need {missing} more range, or a start that is nearer: drag its square on the map.", {
          name: nearest.name,
          missing: lengthText(nearest.missing_m),
        }),
      ),
    );
  return list;
}

/** @param {string} words @param {string} label @param {() => unknown} run */
const act = (words, label, run) =>
  h("li", {}, h("span", {}, words), " ", h("button", { type: "button", class: "text-button", onclick: run }, label));
