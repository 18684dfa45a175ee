/** Opening a stored mission, and the draft that outlives the page. */

import { get, remove } from "../../api.js";
import { toast } from "../../page/toast.js";
import { t } from "../../text.js";
import { isUnsaved } from "../plan/plan_view.js";
import * as picks from "../selection.js";
import { draftDecision, isStarted } from "./draft.js";
import { merged } from "./merge.js";
import { createStoredMission } from "./stored_mission.js";

/** @import { Answer } from "../../api.js" */
/** @import { Mission } from "../../api_types.d.ts" */
/** @import { MissionContext, Version } from "../types.d.ts" */

/**
 * Keep unsaved changes in a draft, and drop this page's draft where there are none. Returns whether they could be kept.
 *
 * @param {Pick<MissionContext, "store" | "selection" | "drafts">} context
 * @returns {boolean}
 */
export function settleDraft({ store, selection, drafts }) {
  const { mission, name, conflict, stored, shownPlan, lastPlan } = store.state;
  const isWorthKeeping = mission ? isUnsaved(store.state) : isStarted(store.state);
  if (isWorthKeeping) {
    const since = conflict
      ? { revision: conflict.base, base: conflict.before }
      : { revision: mission?.revision ?? 0, base: stored };
    const plans = mission ? undefined : { shown: shownPlan, last: lastPlan }; // a stored one has the server's
    return drafts.keep(mission?.id ?? null, { name, selection: selection(), ...since, plans });
  }
  drafts.dropOwn(mission?.id ?? null);
  return true;
}

/**
 * @param {MissionContext} context
 * @param {{ conflictWith: (theirs: Mission, base: number, before: Version | null) => Promise<void> }} conflicts
 */
export function createOpening(context, { conflictWith }) {
  const { store, history, selection, change, failed, page, drafts } = context;
  const { storedOf, shownAs, openStored } = createStoredMission(context);

  /** @param {string} id */
  async function open(id) {
    const { data } = /** @type {Answer<Mission>} */ (await get(`/missions/${id}`));
    openStored(data);
    const draft = page.canPlan ? drafts.read(id) : null;
    if (!draft) return;
    const decision = draftDecision(draft, data, store.state.savedBasis);
    if (decision === "none") {
      drafts.drop(id);
      return;
    }
    const mine = { name: draft.name || data.name, selection: draft.selection };
    const { stored } = store.state;
    const both = decision === "behind" && draft.base && stored ? merged(draft.base, mine, stored) : null;
    const shown = both?.clashes.length === 0 ? both : mine;
    store.update({ restoredBasis: picks.basisOf(shown.selection) });
    change(shown.selection);
    store.update({ name: shown.name });
    if (decision === "behind" && shown === mine) await conflictWith(data, draft.revision, draft.base ?? null);
    else toast(t("Your unsaved changes are back."), { label: t("Drop them"), act: () => dropChanges(data) });
    settleDraft(context); // from now on it is this page's
  }

  /** @param {Mission} mission */
  function dropChanges(mission) {
    const { name } = store.state;
    const mine = selection();
    const { stored, plan } = storedOf(mission);
    change(stored);
    store.update({ name: mission.name });
    if (store.state.mission?.revision === mission.revision) shownAs(mission, stored, plan);
    const undo = () => {
      change(mine);
      store.update({ name });
    };
    toast(t("Your changes are dropped."), { label: t("Undo"), act: undo });
  }

  function openDraft() {
    const draft = drafts.read(null);
    if (!draft || !isStarted({ name: draft.name ?? "", selection: draft.selection })) return;
    history.startFrom(draft.selection);
    store.update({
      name: draft.name ?? "",
      shownPlan: draft.plans?.shown ?? null,
      lastPlan: draft.plans?.last ?? null,
    });
    settleDraft(context);
    if (draft.selection.targets.length || draft.name)
      toast(t("Your unsaved mission is back."), { label: t("Start empty"), act: startEmpty });
  }

  function startEmpty() {
    const { name, plan } = store.state;
    const mine = selection();
    if (!change({ ...picks.EMPTY }) && !name) return;
    store.update({ name: "", plan: null, shownPlan: null, problem: null, chosenTarget: null, litTarget: null });
    const undo = () => {
      change(mine);
      store.update({ name, plan });
    };
    toast(t("Everything is cleared."), { label: t("Undo"), act: undo });
  }

  async function deleteMission() {
    const { mission } = store.state;
    if (!mission) return;
    try {
      await remove(`/missions/${mission.id}`, { headers: { "If-Match": `"${mission.revision}"` } });
      drafts.drop(mission.id);
      location.href = `/?gone=${mission.id}&was=${encodeURIComponent(mission.name)}`;
    } catch (error) {
      failed(t("Not deleted."), error);
    }
  }

  return { open, openDraft, startEmpty, deleteMission, settleDraft: () => settleDraft(context) };
}
