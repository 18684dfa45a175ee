/** Small changes of a planned mission are planned again at once, and the difference is told with a way back. */

import { toast } from "../../page/toast.js";
import { t } from "../../text.js";
import { differenceWords } from "../compare.js";
import { isPlanCurrent } from "../plan_view.js";
import { basisOf, withoutWishes } from "../selection.js";
import { MAX_PLANNED_AT_ONCE } from "./plan_beside.js";

/** @import { MissionContext, MissionSelection, PlanResult } from "../types.d.ts" */

const QUICK_MS = 2000; // a plan that took longer is planned again on request
const REST_MS = 400; // after the last change

/**
 * Whether nothing differs but UAVs that were added or removed, targets that were removed, and who flies targets in which order.
 *
 * @param {MissionSelection} before
 * @param {MissionSelection} after
 */
export function isSmallChange(before, after) {
  const [then, now] = [withoutWishes(before), withoutWishes(after)];
  const keys = new Set(now.targets.map(({ key }) => key));
  const stays = new Set(now.uavs.map(({ name }) => name));
  const were = new Set(then.uavs.map(({ name }) => name));
  /** @param {MissionSelection} selection */
  const common = (selection) =>
    basisOf({
      ...selection,
      targets: selection.targets.filter(({ key }) => keys.has(key)),
      uavs: selection.uavs.filter(({ name }) => stays.has(name) && were.has(name)),
    });
  return after.targets.length > 0 && after.uavs.length > 0 && common(then) === common(now);
}

/** @param {MissionContext} context @param {() => Promise<void>} plan */
export function replanSmallChanges({ store, history, page, selection }, plan) {
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let rest;
  /** @type {{ selection: MissionSelection, result: PlanResult } | null} the last plan that was of the selection */
  let planned = null;
  /** @type {{ result: PlanResult, basis: string } | null} what is being planned again, against which plan */
  let asked = null;
  let began_ms = 0;
  let took_ms = 0;

  store.listen(["planning"], ({ planning }) => {
    const now_ms = performance.now();
    if (planning && !began_ms) began_ms = now_ms;
    if (planning || !began_ms) return;
    took_ms = now_ms - began_ms;
    began_ms = 0;
  });

  store.listen(["plan", "selection", "hand", "planning"], (state) => {
    clearTimeout(rest);
    if (state.plan && isPlanCurrent(state)) {
      if (asked?.basis === state.plan.basis && asked.result !== state.plan.result)
        toast(t("Planned again: {difference}.", { difference: differenceWords(asked.result, state.plan.result) }), {
          label: t("Undo"),
          act: () => history.undo(),
        });
      asked = null;
      planned = { selection: state.selection, result: state.plan.result };
      return;
    }
    const isWanted =
      page.canPlan && planned && state.plan && !state.hand && !state.planning && !state.isAway && took_ms < QUICK_MS;
    const basis = basisOf(state.selection);
    if (!isWanted || asked?.basis === basis || state.restoredBasis === basis) return; // refused or brought back: planned on request
    const isQuick = took_ms > 0 || state.selection.targets.length <= MAX_PLANNED_AT_ONCE;
    if (!isQuick || !planned) return;
    if (!isSmallChange(planned.selection, state.selection)) return;
    const { result } = planned;
    rest = setTimeout(() => {
      asked = { result, basis: basisOf(selection()) };
      void plan();
    }, REST_MS);
  });
}
