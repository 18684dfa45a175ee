/** Plans kept on the page, by the selection that they were made for. Values in, values out. */

import * as picks from "../selection.js";

/** @import { MissionPageState, MissionSelection, PlanResult, ShownPlan } from "../types.d.ts" */

const MAX_KEPT = 16; // plans that undo, redo and the choice of an objective show at once

/**
 * The plan of a result, with the selection that it was made for: its indices point into that.
 *
 * @param {PlanResult} result
 * @param {MissionSelection} selection
 * @returns {ShownPlan}
 */
export function planOf(result, selection) {
  const { targets, uavs, charging_w = null } = selection;
  return {
    result,
    basis: picks.basisOf(selection),
    freeBasis: picks.basisOf(picks.withoutWishes(selection)),
    targets,
    uavs,
    charging_w,
  };
}

/**
 * Results by their input; the oldest are dropped, and those of other map data: a zone may have been added since.
 *
 * @param {MissionPageState["figures"]} figures
 * @param {string} basis
 * @param {PlanResult} result
 * @returns {MissionPageState["figures"]}
 */
export function withResult(figures, basis, result) {
  const rest = Object.entries(figures).filter(
    ([known, other]) => known !== basis && other.ground_revision === result.ground_revision,
  );
  return Object.fromEntries([...rest.slice(-MAX_KEPT + 1), [basis, result]]);
}
