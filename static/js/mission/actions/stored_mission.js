/** The stored mission on the page: the server's version, below the changes made here since. */

import { planOf, withResult } from "../plan/plan_results.js";
import * as picks from "../selection.js";

/** @import { Mission } from "../../api_types.d.ts" */
/** @import { MissionContext, MissionSelection, Problem, ShownPlan, Version } from "../types.d.ts" */

/**
 * The problem that stays shown after a save: one about a plan, until the selection changes; null for one of saving.
 *
 * @param {Problem | null} standing
 */
export const unlessOfSaving = (standing) => (standing?.about && !standing.isOfSaving ? standing : null);

/** @param {Pick<MissionContext, "store" | "history" | "selection">} context */
export function createStoredMission({ store, history, selection }) {
  /** @param {Mission} mission */
  function storedOf(mission) {
    const stored = picks.selectionOf(mission, store.state.fleet);
    return { stored, plan: mission.plan ? planOf(mission.plan, stored) : null };
  }

  /** @param {Mission} mission @param {MissionSelection} stored @param {ShownPlan | null} plan */
  function shownAs(mission, stored, plan) {
    store.update({
      mission,
      stored: { name: mission.name, selection: stored },
      plan: plan ?? store.state.plan,
      planIsStored: Boolean(plan),
      savedBasis: picks.storedBasisOf(stored),
      figures: plan ? withResult(store.state.figures, plan.basis, plan.result) : store.state.figures,
      problem: unlessOfSaving(store.state.problem),
      conflict: null,
      isAway: false,
    });
  }

  return {
    storedOf,
    shownAs,
    /** @param {Mission} mission */
    openStored(mission) {
      const { stored, plan } = storedOf(mission);
      history.startFrom(stored);
      store.update({ name: mission.name });
      shownAs(mission, stored, plan);
    },
    /**
     * Take over the mission as just stored. The history is kept, and so are changes made during the save.
     *
     * @param {Mission} mission
     * @param {Version} asked
     */
    keepOpen(mission, asked) {
      const { stored, plan } = storedOf(mission);
      const isAsAsked = picks.storedBasisOf(stored) === picks.storedBasisOf(asked.selection);
      if (selection() === asked.selection && !isAsAsked) history.settle(stored);
      if (store.state.name === asked.name && asked.name.trim()) store.update({ name: mission.name });
      shownAs(mission, stored, plan);
    },
  };
}
