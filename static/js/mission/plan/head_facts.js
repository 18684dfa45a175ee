/** The line of facts below a mission's name. Values in, values out. */

import { t, tn } from "../../text.js";
import { clockText } from "../../units.js";
import { isPlanCurrent } from "./plan_view.js";

/** @import { MissionPageState } from "../types.d.ts" */

/** @param {number} count */
const targetsText = (count) => tn(count, "{count} target", "{count} targets");

/**
 * Facts of the mission for the header; "no mission is open" only once all data have arrived.
 * @param {MissionPageState} state @param {boolean} canPlan
 */
export function factsOf(state, canPlan) {
  const { plan, mission, arrival } = state;
  if (arrival === "awaited") return [t("Loading …")];
  if (!canPlan && !mission) return arrival === "failed" ? [] : [t("no mission is open")];
  const targets = state.selection.targets.length;
  if (!plan || !isPlanCurrent(state)) {
    const picked = targets ? targetsText(targets) : t("nothing picked yet");
    return plan ? [picked, t("changed since it was planned")] : [picked];
  }
  const missed = plan.result.unassigned.length;
  const facts = [
    missed
      ? tn(targets, "{reached} of {count} target", "{reached} of {count} targets", { reached: targets - missed })
      : targetsText(targets),
  ];
  if (state.planIsStored && mission?.planned_at)
    facts.push(t("planned {time}", { time: clockText(mission.planned_at) }));
  if (plan.result.flat_ground_assumed) facts.push(t("flat ground assumed"));
  return facts;
}
