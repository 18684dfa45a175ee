/** Saving, opening, and what happens when somebody else was faster. */

import { get, patch, post, remove } from "../api.js";
import { toast } from "../page/toast.js";
import { clockText, dayText } from "../units.js";
import { draftDecision, isStarted, whoseSave } from "./draft.js";
import { isUnsaved } from "./plan_view.js";
import { planOf } from "./planning.js";
import * as picks from "./selection.js";

const RETRY_S = 8;

/** context: see actions.js; waitForJob(job, words): of planning.js. */
export function createSaving({ store, history, selection, change, problem, failed, running, page, drafts }, waitForJob) {
  let retry = 0;

  function shownAs(mission, stored, plan) {
    store.update({
      mission,
      plan,
      planIsStored: Boolean(plan),
      savedBasis: picks.basisOf(stored),
      figures: plan ? { ...store.state.figures, [plan.basis]: plan.result } : store.state.figures,
      problem: null,
      conflict: null,
    });
  }

  function storedOf(mission) {
    const stored = picks.selectionOf(mission, store.state.fleet);
    return { stored, plan: mission.plan ? planOf(mission.plan, stored) : null };
  }

  function openStored(mission) {
    const { stored, plan } = storedOf(mission);
    history.startFrom(stored);
    store.update({ name: mission.name });
    shownAs(mission, stored, plan);
  }

  /** The mission as it has just been stored. The history stays, and what was changed meanwhile stays as well. */
  function keepOpen(mission, asked) {
    const { stored, plan } = storedOf(mission);
    const isAsAsked = picks.basisOf(stored) === picks.basisOf(asked.selection);
    if (selection() === asked.selection && !isAsAsked) history.settle(stored);
    if (store.state.name === asked.name) store.update({ name: mission.name });
    shownAs(mission, stored, plan);
  }

  function addressNow(mission) {
    globalThis.history.replaceState(null, "", `/missions/${mission.id}`);
  }

  async function save({ asCopy = false } = {}) {
    if (store.state.saving || store.state.planning) return;
    if (store.state.conflict && !asCopy) {
      toast("Choose first: see what was saved, put yours on top, or keep yours as a copy.");
      return;
    }
    clearTimeout(retry);
    const { mission, plan, name } = store.state;
    const asked = { selection: selection(), name };
    const isNew = !mission || asCopy;
    const draftOf = mission?.id ?? null; // the copy takes the changes along
    const basis = picks.basisOf(asked.selection);
    const withPlan = plan !== null && plan.basis === basis;
    const body = { ...picks.requestOf(asked.selection), name: name.trim() || `Mission of ${dayText(new Date())}, ${clockText(new Date())}` };
    if (asCopy) body.name = `${body.name} (copy)`;
    if (withPlan && (isNew || !store.state.planIsStored || basis !== store.state.savedBasis)) body.plan = true;
    store.update({ saving: true, problem: null });
    let draftId = null; // stored already, its plan not yet
    try {
      const headers = isNew ? { "Idempotency-Key": crypto.randomUUID?.() ?? `${Date.now()}-${Math.random()}` } : { "If-Match": `"${mission.revision}"` };
      const answer = isNew ? await post("/missions", body, { headers }) : await patch(`/missions/${mission.id}`, body, { headers });
      let stored = answer.data;
      if (answer.status === 202) {
        draftId = answer.data.mission;
        drafts.dropOwn(draftOf);
        if (isNew) addressNow({ id: draftId });
        running.stopping = new AbortController();
        await waitForJob(answer.data.job, "Planning what is saved");
        stored = (await get(`/missions/${draftId}`)).data;
      }
      drafts.dropOwn(draftOf);
      keepOpen(stored, asked);
      if (isNew) addressNow(stored);
      settleDraft();
      toast(`“${stored.name}” is saved.`);
    } catch (error) {
      if (draftId) await get(`/missions/${draftId}`).then(({ data }) => keepOpen(data, asked), () => {});
      await saveFailed(error, asCopy);
    } finally {
      running.stopping = null;
      store.update({ saving: false, planning: null });
    }
  }

  const KEEP_COPY = { label: "Keep mine as a copy", act: () => save({ asCopy: true }) };

  async function saveFailed(error, asCopy) {
    const again = () => save({ asCopy });
    if (error.name === "AbortError") {
      problem("Saved as a draft.", "Planning was stopped before it was done.");
    } else if (error.status === 412) {
      await meet();
    } else if (error.status === 404 && store.state.mission && !asCopy) {
      problem("Not saved: the mission has been deleted.", "Your selection is kept in this browser.", [KEEP_COPY]);
    } else if (error.isAway) {
      problem("Not saved: the server cannot be reached.", `Your selection is kept in this browser. Next try in ${RETRY_S} s.`, [{ label: "Try now", act: again }]);
      retry = setTimeout(again, RETRY_S * 1000);
    } else {
      failed("Not saved.", error, [{ label: "Try again", act: again }, ...(error.status === 409 ? [KEEP_COPY] : [])]);
    }
  }

  // somebody else has saved since

  /** Whose save it was: the newest entry of the history, where that can be read. */
  async function lastSave(mission) {
    const newest = await get(`/missions/${mission.id}/history?limit=1`).then(({ data }) => data.results[0], () => null);
    return { whose: whoseSave(newest?.actor, page.userName), at: newest?.recorded_at ?? mission.updated_at };
  }

  /** The server holds a younger revision than the one this selection was made from: theirs is fetched, mine stays on the page. */
  async function meet() {
    try {
      const base = store.state.mission.revision;
      const { data } = await get(`/missions/${store.state.mission.id}`);
      store.update({ planIsStored: false }); // what is stored now is theirs
      await conflictWith(data, base);
    } catch (error) {
      failed("Not saved: changed by another operator.", error, [{ label: "Try again", act: () => save() }, KEEP_COPY]);
    }
  }

  async function conflictWith(theirs, base) {
    const { stored } = storedOf(theirs);
    const { name } = store.state;
    if (picks.basisOf(stored) === picks.basisOf(selection()) && name === theirs.name) {
      keepOpen(theirs, { selection: selection(), name });
      toast("The same is saved already.");
      return;
    }
    const between = await lastSave(theirs);
    store.update({ mission: theirs, savedBasis: picks.basisOf(stored), problem: null, conflict: { ...between, base } });
  }

  /** Theirs becomes one more step of the history, so that mine is one step back. */
  function seeTheirs() {
    const { mission, conflict, name, plan } = store.state;
    const mine = selection();
    const { stored, plan: theirPlan } = storedOf(mission);
    change(stored);
    store.update({ name: mission.name });
    shownAs(mission, stored, theirPlan);
    toast(`This is ${conflict.whose} save of ${clockText(conflict.at)}.`, {
      label: "Back to mine",
      act() {
        change(mine);
        store.update({ name, plan, planIsStored: false, conflict });
      },
    });
  }

  function putMineOnTop() {
    store.update({ conflict: null });
    return save();
  }

  // opening, and the draft that outlives the page

  async function open(id) {
    const { data } = await get(`/missions/${id}`);
    openStored(data);
    const draft = page.canPlan ? drafts.read(id) : null;
    const decision = draftDecision(draft, data, store.state.savedBasis);
    if (draft && decision === "none") drafts.drop(id);
    if (decision === "none") return;
    change(draft.selection);
    store.update({ name: draft.name || data.name });
    if (decision === "behind") await conflictWith(data, draft.revision);
    else toast("Your unsaved changes are back.", { label: "Drop them", act: () => dropChanges(data) });
    settleDraft(); // from now on it is this page's
  }

  function dropChanges(mission) {
    const { name } = store.state;
    const mine = selection();
    const { stored, plan } = storedOf(mission);
    change(stored);
    store.update({ name: mission.name });
    shownAs(mission, stored, plan);
    toast("Your changes are dropped.", { label: "Undo", act: () => (change(mine), store.update({ name })) });
  }

  function openDraft() {
    const draft = drafts.read(null);
    if (!draft || !isStarted({ name: draft.name ?? "", selection: draft.selection })) return;
    history.startFrom(draft.selection);
    store.update({ name: draft.name ?? "" });
    settleDraft();
    if (draft.selection.targets.length || draft.name) toast("Your unsaved mission is back.", { label: "Start empty", act: startEmpty });
  }

  function startEmpty() {
    const { name, plan } = store.state;
    const mine = selection();
    if (!change({ ...picks.EMPTY }) && !name) return;
    store.update({ name: "", plan: null, problem: null, chosenTarget: null, litTarget: null });
    toast("Everything is cleared.", { label: "Undo", act: () => (change(mine), store.update({ name, plan })) });
  }

  /** Keeps what is unsaved, and drops this page's draft where there is nothing left to keep. False where it could not be kept. */
  function settleDraft() {
    const { mission, name, conflict } = store.state;
    const isWorthKeeping = mission ? isUnsaved(store.state) : isStarted(store.state);
    if (isWorthKeeping) return drafts.keep(mission?.id ?? null, { name, selection: selection(), revision: conflict?.base ?? mission?.revision ?? 0 });
    drafts.dropOwn(mission?.id ?? null);
    return true;
  }

  async function deleteMission() {
    try {
      await remove(`/missions/${store.state.mission.id}`);
      drafts.drop(store.state.mission.id);
      location.href = `/?deleted=${store.state.mission.id}&name=${encodeURIComponent(store.state.mission.name)}`;
    } catch (error) {
      failed("Not deleted.", error);
    }
  }

  return {
    save, open, openDraft, startEmpty, settleDraft, deleteMission, seeTheirs, putMineOnTop,
    keepMineAsCopy: KEEP_COPY.act,
    rename: (name) => store.update({ name }),
  };
}
