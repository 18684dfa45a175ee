/** Why no route visits a target: the reason, the figures behind it, and one change or more that would help. */

import { h } from "../../dom.js";
import { t } from "../../text.js";
import { heightText, lengthText } from "../../units.js";
import { inWords } from "../plan_words.js";

/** said: see TargetExplanationSerializer; entry: of the plan's unassigned. */
export function targetExplanation(said, { plan, entry, store, actions, canPlan }) {
  const target = plan.targets[said.target];
  return [h("p", { class: "why-sentence" }, reasonWords(said) || inWords(entry.message)), facts(said), canPlan && changes(said, { target, store, actions })].filter(Boolean);
}

export function reasonWords(said) {
  const zones = said.zones.map(({ name }) => name).join(", ");
  const lengths = { reach: lengthText(said.access_limit_m), distance: lengthText(said.network_m) };
  const words = {
    asset_gone: () => t("It has been deleted from the data since it was picked."),
    inside_zone: () => (said.stretches.length ? t("It runs through {zones}.", { zones }) : t("It stands inside {zones}.", { zones: zones || t("the margin round a no-fly zone") })),
    above_height_limit: () => t("It is {height} high. A UAV would have to fly at {needed}; the limit is {limit}.", { height: heightText(said.height_m), needed: heightText(said.needed_height_m), limit: heightText(said.height_limit_m) }),
    too_far_from_network: () => t("The nearest line, railway or bridge is {distance} away; up to {reach} is flown off the network.", lengths),
    no_path: () => (zones ? t("Every way to it leads through {zones}.", { zones }) : t("No way leads there that keeps clear of every zone.")),
    beyond_range: () => t("It is out of range of every UAV of this mission."),
    not_allowed: () => t("No UAV may fly it: none has the sensor, or is the one it is tied to."),
    most_targets: () => t("Every UAV that could fly it has as many targets as it may."),
    not_with_the_others: () => t("One UAV alone could fly there, but none has the range left after its other targets."),
  };
  return words[said.reason]?.() ?? "";
}

function facts(said) {
  const needs = said.uavs.filter(({ is_in_mission }) => is_in_mission);
  if (!needs.length) return null;
  const row = ({ name, needed_m, max_range_m, is_grounded }) => {
    const has = max_range_m === null ? t("not limited") : lengthText(max_range_m);
    const needed = is_grounded ? t("cannot take off") : needed_m === null ? t("no way") : lengthText(needed_m);
    return h("tr", {}, h("th", { scope: "row" }, name), h("td", {}, needed), h("td", {}, has));
  };
  return h("table", { class: "why-table" }, h("thead", {}, h("tr", {}, [t("UAV"), t("needs"), t("has")].map((words) => h("th", { scope: "col" }, words)))), h("tbody", {}, needs.map(row)));
}

function changes(said, { target, store, actions }) {
  const act = (words, label, run) => h("li", {}, h("span", {}, words), " ", h("button", { type: "button", class: "text-button", onclick: run }, label));
  const list = [];
  if (said.stretches.length) list.push(act(t("The parts outside can be flown."), t("Take the parts outside"), () => actions.replaceByStretches(target, said.stretches)));
  const spare = said.uavs.find((uav) => !uav.is_in_mission && uav.is_enough);
  if (spare) list.push(act(t("{name} could fly there: it needs {needed}.", { name: spare.name, needed: lengthText(spare.needed_m) }), t("Take {name} along", { name: spare.name }), () => (actions.addUavOfFleet(spare.uav_id), actions.plan())));
  const nearest = said.uavs.filter((uav) => uav.is_in_mission && uav.needed_m !== null && !uav.is_enough).sort((a, b) => a.needed_m - a.max_range_m - (b.needed_m - b.max_range_m))[0];
  if (nearest) list.push(h("li", {}, t("{name} would need {missing} more range, or a start that is nearer: drag its square on the map.", { name: nearest.name, missing: lengthText(nearest.needed_m - nearest.max_range_m) })));
  if (said.reason === "not_with_the_others") list.push(h("li", {}, t("Add a UAV, or plan it as a flight of its own.")));
  list.push(act(t("The plan goes without it."), t("Remove it"), () => (store.update({ why: null }), actions.removeTargets([target.key]))));
  return h("div", {}, h("h3", {}, t("What would help")), h("ul", { class: "why-changes" }, list));
}
