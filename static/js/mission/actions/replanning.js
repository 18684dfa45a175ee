/** Small changes of a planned mission are planned again at once, and the difference is told with a way back. */

import { toast } from "../../page/toast.js";
import { t } from "../../text.js";
import { differenceWords } from "../plan/compare.js";
import { isPlanCurrent } from "../plan/plan_view.js";
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
export function replanSmallChanges({ store, history, page, selection, change }, plan) {
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let rest;
  /** @type {{ selection: MissionSelection, result: PlanResult } | null} the last plan that was of the selection */
  let planned = null;
  /** @type {{ result: PlanResult, before: MissionSelection, basis: string } | null} what is being planned again, against which plan */
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

  /** The selection of the plan before; later changes are taken back one by one. @param {MissionSelection} before @param {string} basis */
  const takeBack = (before, basis) => (basisOf(selection()) === basis ? change(before) : history.undo());

  store.listen(["plan", "selection", "hand", "planning", "isAway", "conflict"], (state) => {
    clearTimeout(rest);
    if (state.plan && isPlanCurrent(state)) {
      if (asked?.basis === state.plan.basis && asked.result !== state.plan.result) {
        const { result, before, basis } = asked;
        toast(t("Planned again: {difference}.", { difference: differenceWords(result, state.plan.result) }), {
          label: t("Undo"),
          act: () => takeBack(before, basis),
        });
      }
      asked = null;
      planned = { selection: state.selection, result: state.plan.result };
      return;
    }
    const isFree = !state.hand && !state.planning && !state.isAway && !state.conflict;
    const isWanted = page.canPlan && planned && state.plan && isFree && took_ms < QUICK_MS;
    const basis = basisOf(state.selection);
    if (!isWanted || asked?.basis === basis || state.restoredBasis === basis) return; // refused, brought back or merged: planned on request
    const isQuick = took_ms > 0 || state.selection.targets.length <= MAX_PLANNED_AT_ONCE;
    if (!isQuick || !planned) return;
    if (!isSmallChange(planned.selection, state.selection)) return;
    const { result, selection: before } = planned;
    rest = setTimeout(() => {
      asked = { result, before, basis: basisOf(selection()) };
      void plan();
    }, REST_MS);
  });
}
