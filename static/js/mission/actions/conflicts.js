/**
 * Conflicts with another user's save: compatible changes are merged automatically, and the operator decides where both changed the same.
 */

import { get, post } from "../../api.js";
import { isFrozen } from "../../domain/flying.js";
import { toast } from "../../page/toast.js";
import { t } from "../../text.js";
import { clockText } from "../../units.js";
import { isUnsaved } from "../plan/plan_view.js";
import * as picks from "../selection.js";
import { whoseSave } from "./draft.js";
import { isAlike, merged, wordsOfChange } from "./merge.js";
import { createStoredMission } from "./stored_mission.js";

/** @import { Answer } from "../../api.js" */
/** @import { HistoryPage, Mission } from "../../api_types.d.ts" */
/** @import { Conflict, MissionContext, Version, WayOut } from "../types.d.ts" */

/** @typedef {{ save: () => Promise<void>, keepMineAsCopy: () => Promise<void> }} Saving */
/** @typedef {{ takeTheirs: () => void, putMineOnTop: () => Promise<void>, mergeBoth: (() => Promise<void>) | null, keepMineAsCopy: () => Promise<void> }} WaysOut */
/** @typedef {(conflict: Conflict, mine: Version, ways: WaysOut) => void} ShowBoth the dialog with both versions */

/**
 * The author of a save: from the newest entry of the history, where that can be read.
 *
 * @param {Mission} mission
 * @param {string} userName
 */
async function lastSave(mission, userName) {
  const newest = await get(`/missions/${mission.id}/history?limit=1`).then(
    ({ data }) => /** @type {HistoryPage} */ (data).results[0],
    () => null,
  );
  return {
    actor: newest?.actor ?? null,
    whose: whoseSave(newest?.actor, userName),
    at: newest?.recorded_at ?? mission.updated_at,
  };
}

/**
 * @param {MissionContext} context
 * @param {Saving} saving
 * @param {ShowBoth} showBoth
 */
export function createConflicts(context, saving, showBoth) {
  const meeting = createMeeting(context, saving);
  const { seeBoth } = createDecision(context, saving, showBoth);
  return { ...meeting, seeBoth, showDeleted: () => showDeleted(context, saving, meeting.take) };
}

/** @param {Pick<MissionContext, "store" | "selection">} context @returns {Version} */
const mineOf = ({ store, selection }) => ({ name: store.state.name, selection: selection() });

/**
 * Handle a revision of another user: merged with the changes here, or a conflict.
 *
 * @param {MissionContext} context
 * @param {Saving} saving
 */
function createMeeting(context, saving) {
  const { store, history, failed, page } = context;
  const { storedOf, shownAs, keepOpen } = createStoredMission(context);

  /**
   * Take over a newer revision than the one on the page. `lost` is a version that this page sent without receiving an answer: it may be
   * this page's own.
   *
   * @param {Mission} theirs
   * @param {Version | null} [lost]
   */
  async function take(theirs, lost = null) {
    const { stored: before, mission } = store.state;
    const { stored, plan } = storedOf(theirs);
    const now = { name: theirs.name, selection: stored };
    const isOwn = lost !== null && isAlike({ ...lost, name: lost.name.trim() || theirs.name }, now);
    const base = isOwn || !before ? now : before;
    const both = merged(base, mineOf(context), now);
    if (both.clashes.length) {
      await conflictWith(theirs, mission?.revision ?? 0, base);
      return;
    }
    store.update({ restoredBasis: picks.basisOf(both.selection) }); // else each page that has it open plans it again
    history.rebase((step) => merged(base, { name: now.name, selection: step }, now).selection);
    store.update({ name: both.name });
    shownAs(theirs, stored, plan);
    const words = wordsOfChange(before ?? now, now);
    if (isOwn || isFrozen(theirs) || (!words.length && !plan)) return; // approved: only the stage can have changed; the page shows it
    const { actor } = await lastSave(theirs, page.userName);
    const who = actor === page.userName ? t("You, in another window") : (actor ?? t("Another operator"));
    toast(t("{who}: {what}.", { who, what: words.join(", ") || t("planned") }));
  }

  /** After a refused save. @param {Version | null} [lost] */
  async function meet(lost = null) {
    try {
      const { data } = /** @type {Answer<Mission>} */ (await get(`/missions/${store.state.mission?.id}`));
      await take(data, lost);
    } catch (error) {
      failed(
        t("Not saved: changed by another operator."),
        error,
        [
          { label: t("Try again"), act: () => saving.save() },
          { label: t("Keep mine as a copy"), act: () => saving.keepMineAsCopy() },
        ],
        { isOfSaving: true },
      );
    }
  }

  /**
   * base: the revision that mine was made from; before: that as values, where it is known.
   *
   * @param {Mission} theirs
   * @param {number} base
   * @param {Version | null} before
   */
  async function conflictWith(theirs, base, before) {
    const { stored } = storedOf(theirs);
    const mine = mineOf(context);
    const now = { name: theirs.name, selection: stored };
    if (isAlike(mine, now)) {
      keepOpen(theirs, mine);
      toast(t("The same is saved already."));
      return;
    }
    const between = await lastSave(theirs, page.userName);
    const clashes = before ? merged(before, mineOf(context), now).clashes : ["targets"];
    store.update({
      mission: theirs,
      stored: now,
      planIsStored: false,
      savedBasis: picks.storedBasisOf(stored),
      problem: null,
      conflict: { ...between, base, before, theirs: now, clashes },
    });
  }

  return { take, meet, conflictWith };
}

/**
 * What the operator decides where both have changed the same.
 *
 * @param {MissionContext} context
 * @param {Saving} saving
 * @param {ShowBoth} showBoth
 */
function createDecision(context, saving, showBoth) {
  const { store, selection, change } = context;
  const { storedOf, shownAs } = createStoredMission(context);

  /** Theirs becomes one more step of the history, so that mine is one step back. */
  function takeTheirs() {
    const { mission, conflict, name, plan } = store.state;
    if (!mission || !conflict) return;
    const mine = selection();
    const { stored, plan: theirPlan } = storedOf(mission);
    change(stored);
    store.update({ name: mission.name });
    shownAs(mission, stored, theirPlan);
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
    return saving.save();
  }

  /** Both, and mine where both changed the same. @param {Version} before @param {Version} theirs */
  function mergeBoth(before, theirs) {
    const both = merged(before, mineOf(context), theirs);
    store.update({ conflict: null, name: both.name });
    change(both.selection);
    return saving.save();
  }

  return {
    seeBoth() {
      const { conflict } = store.state;
      if (!conflict) return;
      const { before, theirs } = conflict;
      showBoth(conflict, mineOf(context), {
        takeTheirs,
        putMineOnTop,
        mergeBoth: before && (() => mergeBoth(before, theirs)),
        keepMineAsCopy: saving.keepMineAsCopy,
      });
    },
  };
}

/**
 * The mission was deleted: it can be restored, or kept as a copy.
 *
 * @param {MissionContext} context
 * @param {Saving} saving
 * @param {(theirs: Mission) => Promise<void>} take
 */
function showDeleted({ store, problem, failed, page }, saving, take) {
  async function bringBack() {
    try {
      const { data } = /** @type {Answer<Mission>} */ (await post(`/missions/${store.state.mission?.id}/restore`, {}));
      store.update({ problem: null });
      await take(data);
    } catch (error) {
      failed(t("Not brought back."), error);
    }
  }
  /** @type {WayOut[]} */
  const ways = [
    { label: t("Bring it back"), act: bringBack },
    { label: t("Keep mine as a copy"), act: saving.keepMineAsCopy },
  ];
  const isLost = isUnsaved(store.state);
  problem(
    isLost ? t("Not saved: the mission has been deleted.") : t("The mission has been deleted."),
    isLost ? t("Your selection is kept in this browser.") : t("Its targets and routes are still on this page."),
    page.canPlan ? ways : [],
    { isOfSaving: true },
  );
}
