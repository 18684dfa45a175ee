/** Somebody else has saved: what goes together comes together by itself, and where both changed the same the operator decides. */

import { get, post } from "../../api.js";
import { isFrozen } from "../../domain/flying.js";
import { toast } from "../../page/toast.js";
import { t } from "../../text.js";
import { clockText } from "../../units.js";
import { isUnsaved } from "../plan_view.js";
import * as picks from "../selection.js";
import { whoseSave } from "./draft.js";
import { isAlike, merged, wordsOfChange } from "./merge.js";

/** context: see actions.js; saving(): what saving.js gives; showBoth(store, ways): see panels/both.js. */
export function createConflicts({ store, history, selection, change, problem, failed, page }, saving, showBoth) {
  const mineNow = () => ({ name: store.state.name, selection: selection() });

  /** Whose save it was: the newest entry of the history, where that can be read. */
  async function lastSave(mission) {
    const newest = await get(`/missions/${mission.id}/history?limit=1`).then(
      ({ data }) => data.results[0],
      () => null,
    );
    return {
      actor: newest?.actor ?? null,
      whose: whoseSave(newest?.actor, page.userName),
      at: newest?.recorded_at ?? mission.updated_at,
    };
  }

  /** A younger revision than the one on the page. `lost` is what this page had sent when no answer came: then it is this page's own. */
  async function take(theirs, lost = null) {
    const { stored: before, mission } = store.state;
    const { stored, plan } = saving().storedOf(theirs);
    const now = { name: theirs.name, selection: stored };
    const isOwn = lost !== null && isAlike({ ...lost, name: lost.name.trim() || theirs.name }, now);
    const base = isOwn || !before ? now : before;
    const both = merged(base, mineNow(), now);
    if (both.clashes.length) {
      await conflictWith(theirs, mission.revision, base);
      return;
    }
    history.rebase((step) => merged(base, { name: now.name, selection: step }, now).selection);
    store.update({ name: both.name });
    saving().shownAs(theirs, stored, plan);
    const words = wordsOfChange(before ?? now, now);
    if (isOwn || isFrozen(theirs) || (!words.length && !plan)) return; // of one that is approved only the stage can have changed: the page says it
    const { actor } = await lastSave(theirs);
    const who = actor === page.userName ? t("You, in another window") : (actor ?? t("Another operator"));
    toast(t("{who}: {what}.", { who, what: words.join(", ") || t("planned") }));
  }

  /** After a refused save. */
  async function meet(lost = null) {
    try {
      const { data } = await get(`/missions/${store.state.mission.id}`);
      await take(data, lost);
    } catch (error) {
      failed(
        t("Not saved: changed by another operator."),
        error,
        [
          { label: t("Try again"), act: () => saving().save() },
          { label: t("Keep mine as a copy"), act: () => saving().keepMineAsCopy() },
        ],
        { isOfSaving: true },
      );
    }
  }

  /** base: the revision that mine was made from; before: that as values, where it is known. */
  async function conflictWith(theirs, base, before) {
    const { stored } = saving().storedOf(theirs);
    const mine = mineNow();
    const now = { name: theirs.name, selection: stored };
    if (isAlike(mine, now)) {
      saving().keepOpen(theirs, mine);
      toast(t("The same is saved already."));
      return;
    }
    const between = await lastSave(theirs);
    const clashes = before ? merged(before, mineNow(), now).clashes : ["targets"];
    store.update({
      mission: theirs,
      stored: now,
      planIsStored: false,
      savedBasis: picks.storedBasisOf(stored),
      problem: null,
      conflict: { ...between, base, before, theirs: now, clashes },
    });
  }

  /** Theirs becomes one more step of the history, so that mine is one step back. */
  function takeTheirs() {
    const { mission, conflict, name, plan } = store.state;
    const mine = selection();
    const { stored, plan: theirPlan } = saving().storedOf(mission);
    change(stored);
    store.update({ name: mission.name });
    saving().shownAs(mission, stored, theirPlan);
    toast(t("This is {whose} save of {time}.", { whose: conflict.whose, time: clockText(conflict.at) }), {
      label: t("Back to mine"),
      act() {
        store.update({ conflict });
        change(mine);
        store.update({ name, plan, planIsStored: false });
      },
    });
  }

  function putMineOnTop() {
    store.update({ conflict: null });
    return saving().save();
  }

  /** Both, and mine where both changed the same. */
  function mergeBoth() {
    const { conflict } = store.state;
    const both = merged(conflict.before, mineNow(), conflict.theirs);
    store.update({ conflict: null, name: both.name });
    change(both.selection);
    return saving().save();
  }

  function seeBoth() {
    const { conflict } = store.state;
    if (!conflict) return;
    showBoth(conflict, mineNow(), {
      takeTheirs,
      putMineOnTop,
      mergeBoth: conflict.before && mergeBoth,
      keepMineAsCopy: () => saving().keepMineAsCopy(),
    });
  }

  function tellDeleted() {
    const ways = [{ label: t("Keep mine as a copy"), act: () => saving().keepMineAsCopy() }];
    if (page.canPlan) ways.unshift({ label: t("Bring it back"), act: bringBack });
    const kept = isUnsaved(store.state)
      ? t("Your selection is kept in this browser.")
      : t("Its targets and routes are still on this page.");
    problem(
      isUnsaved(store.state) ? t("Not saved: the mission has been deleted.") : t("The mission has been deleted."),
      kept,
      page.canPlan ? ways : [],
      { isOfSaving: true },
    );
  }

  async function bringBack() {
    try {
      const { data } = await post(`/missions/${store.state.mission.id}/restore`, {});
      store.update({ problem: null });
      await take(data);
    } catch (error) {
      failed(t("Not brought back."), error);
    }
  }

  return { take, meet, conflictWith, seeBoth, tellDeleted };
}
