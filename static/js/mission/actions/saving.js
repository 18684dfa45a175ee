/** Saving what is changed, opening a stored mission, and the draft that outlives the page. */

import { ApiError, get, patch, post, remove } from "../../api.js";
import { toast } from "../../page/toast.js";
import { t } from "../../text.js";
import { clockText, dayText } from "../../units.js";
import { UNSAID } from "../flight_options.js";
import { isPlanCurrent, isUnsaved } from "../plan_view.js";
import * as picks from "../selection.js";
import { draftDecision, isStarted } from "./draft.js";
import { merged } from "./merge.js";
import { planOf, withResult } from "./planning.js";

export const RETRY_S = 8;
const REST_MS = 1500; // after the last change
const AT_ONCE_MS = 200;
const UNASKED = { locks: [], ...UNSAID };
const PARTS = ["uavs", "targets", "objective", "return_to_start", ...Object.keys(UNASKED)];

const freshKey = () => crypto.randomUUID?.() ?? `${Date.now()}-${Math.random()}`;

/** The parts of a selection that differ from what is stored, as the API takes them. */
export function changedParts(selection, stored) {
  const [now, before] = [picks.requestOf(selection), stored ? picks.requestOf(stored) : {}].map((body) => ({
    ...UNASKED,
    ...body,
  }));
  const changed = PARTS.filter((part) => JSON.stringify(now[part]) !== JSON.stringify(before[part]));
  const movesPlaces = changed.includes("targets") || changed.includes("uavs"); // locks name UAVs and places in the list of targets
  if (movesPlaces && now.locks.length && !changed.includes("locks")) changed.push("locks");
  return Object.fromEntries(changed.map((part) => [part, now[part]]));
}

/** context: see actions.js; waitForJob(job, words) and makeRoom(): of planning.js; conflicts: see conflicts.js. */
export function createSaving(
  { store, history, selection, change, problem, failed, wordsOf, running, page, drafts },
  { waitForJob, makeRoom },
  conflicts,
) {
  let retry = 0;
  let rest = 0;
  let unsure = null; // { asked, body, key, isNew, asCopy } of a save whose answer never came
  let wanted = null; // what somebody asked for while another save was under way
  let refused = null; // what was not saved: it is tried again once it is another

  /** What is said of a plan stays over a save: it stands until something else is picked. */
  const unlessOfSaving = (standing) => (standing?.about && !standing.isOfSaving ? standing : null);

  const whatIsThere = ({ selection: picked, name, plan }) =>
    JSON.stringify([picks.storedBasisOf(picked), name, plan?.basis ?? null]);

  function shownAs(mission, stored, plan) {
    refused = null; // what was refused may go on top of this revision
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
    const isAsAsked = picks.storedBasisOf(stored) === picks.storedBasisOf(asked.selection);
    if (selection() === asked.selection && !isAsAsked) history.settle(stored);
    if (store.state.name === asked.name && asked.name.trim()) store.update({ name: mission.name });
    shownAs(mission, stored, plan);
  }

  function addressNow(mission) {
    globalThis.history.replaceState(null, "", `/missions/${mission.id}${location.hash}`);
  }

  const nameOf = (name) =>
    name.trim() ||
    store.state.mission?.name ||
    t("Mission of {day}, {time}", { day: dayText(new Date()), time: clockText(new Date()) });

  function bodyOf(asked, { isNew, asCopy }) {
    const { mission, plan, planIsStored, stored } = store.state;
    const basis = picks.basisOf(asked.selection);
    const body = isNew ? picks.requestOf(asked.selection) : changedParts(asked.selection, stored?.selection);
    const name = nameOf(asked.name);
    if (asCopy) body.name = t("{name} (copy)", { name });
    else if (isNew || name !== mission.name) body.name = name;
    if (
      plan !== null &&
      plan.basis === basis &&
      (isNew || !planIsStored || basis !== picks.basisOf(stored.selection))
    ) {
      body.plan = true;
      if (plan.result.job) body.plan_of = plan.result.job;
    }
    return body;
  }

  /** byItself: nobody asked for it, so nothing is said where it goes well. */
  async function save({ asCopy = false, byItself = false } = {}) {
    if (store.state.saving || store.state.planning) {
      if (store.state.saving && !byItself) wanted = { asCopy };
      return;
    }
    if (store.state.conflict && !asCopy) {
      if (!byItself) conflicts.seeBoth();
      return;
    }
    clearTimeout(retry);
    clearTimeout(rest);
    const { mission } = store.state;
    const isNew = !mission || asCopy;
    const draftOf = mission?.id ?? null; // the copy takes the changes along
    const isAgain = isNew && unsure?.isNew && unsure.asCopy === asCopy; // the answer of the first try may be waiting: ask for just the same
    const asked = isAgain ? unsure.asked : { selection: selection(), name: store.state.name };
    const body = isAgain ? unsure.body : bodyOf(asked, { isNew, asCopy });
    const key = isAgain ? unsure.key : freshKey();
    if (!Object.keys(body).length) {
      if (!byItself) toast(t("“{name}” is saved.", { name: mission.name }));
      return;
    }
    if (body.plan && !body.plan_of) makeRoom();
    store.update({ saving: true, problem: unlessOfSaving(store.state.problem) });
    let draftId = null; // stored already, its plan not yet
    try {
      const answer = isNew
        ? await post("/missions", body, { headers: { "Idempotency-Key": key } })
        : await patch(`/missions/${mission.id}`, body, { headers: { "If-Match": `"${mission.revision}"` } });
      let saved = answer.data;
      if (answer.status === 202) {
        draftId = answer.data.mission;
        drafts.dropOwn(draftOf);
        if (isNew) addressNow({ id: draftId });
        running.stopping = new AbortController();
        await waitForJob(answer.data.job, t("Planning what is saved"));
        saved = (await get(`/missions/${draftId}`)).data;
      }
      unsure = refused = null;
      drafts.dropOwn(draftOf);
      if (isNew && store.state.name === asked.name) store.update({ name: saved.name }); // a mission without a name is given one
      keepOpen(saved, asked);
      if (isNew) addressNow(saved);
      settleDraft();
      if (isNew && byItself) toast(t("“{name}” is saved. From now on it saves itself.", { name: saved.name }));
      else if (!byItself) toast(t("“{name}” is saved.", { name: saved.name }));
    } catch (error) {
      const lost = unsure?.asked ?? null; // what an earlier try may have stored after all
      unsure = error.isAway ? { asked, body, key, isNew, asCopy } : null;
      if (draftId)
        await get(`/missions/${draftId}`).then(
          ({ data }) => keepOpen(data, asked),
          () => {},
        );
      refused = whatIsThere(store.state);
      await saveFailed(error, asCopy, lost);
    } finally {
      running.stopping = null;
      store.update({ saving: false, planning: null });
      const next = wanted;
      wanted = null;
      if (next) void save(next);
    }
  }

  const KEEP_COPY = { label: t("Keep mine as a copy"), act: () => save({ asCopy: true }) };

  async function saveFailed(error, asCopy, lost) {
    const again = () => save({ asCopy });
    const how = { isOfSaving: true };
    if (error.name === "AbortError") {
      problem(t("Saved as a draft."), t("Planning was stopped before it was done."), [], how);
    } else if (error.status === 412) {
      await conflicts.meet(lost);
    } else if (error.status === 404 && store.state.mission && !asCopy) {
      conflicts.tellDeleted();
    } else if (error.isAway) {
      store.update({ isAway: true });
      problem(
        t("Not saved: the server cannot be reached."),
        t("Your selection is kept in this browser. Next try in {seconds} s.", { seconds: RETRY_S }),
        [{ label: t("Try now"), act: again }],
        how,
      );
      retry = setTimeout(() => save({ asCopy, byItself: true }), RETRY_S * 1000);
    } else if (error.retryAfter_s !== null && error.retryAfter_s !== undefined) {
      const wait_s = Math.max(1, error.retryAfter_s);
      const next = t("Next try in {seconds} s.", { seconds: wait_s });
      failed(
        t("Not saved yet."),
        new ApiError(`${error.message} ${next}`, error),
        [{ label: t("Try now"), act: again }],
        how,
      );
      retry = setTimeout(() => {
        refused = null; // where a plan is being made now, it is tried again after that
        void save({ asCopy, byItself: true });
      }, wait_s * 1000);
    } else {
      const standing = unlessOfSaving(store.state.problem);
      if (standing && standing.text === wordsOf(error))
        store.update({ problem: { ...standing, title: t("Neither planned nor saved."), ...how } });
      else
        failed(
          t("Not saved."),
          error,
          [{ label: t("Try again"), act: again }, ...(error.status === 409 ? [KEEP_COPY] : [])],
          how,
        );
    }
  }

  // A stored mission saves itself a moment after each change; a new one is stored with its first plan.
  store.listen(["selection", "name", "plan", "mission", "saving", "planning", "conflict", "isAway"], (state) => {
    clearTimeout(rest);
    const isWanted = page.canPlan && isUnsaved(state) && (state.mission || isPlanCurrent(state));
    if (!isWanted || state.saving || state.planning || state.conflict) return;
    if (state.isAway || refused === whatIsThere(state)) return; // it is tried again by the clock, by the network's return, by hand
    rest = setTimeout(() => save({ byItself: true }), state.mission ? REST_MS : AT_ONCE_MS);
  });

  /** The server answers again: what waited is saved now. */
  function connectedAgain(hasWaited = store.state.isAway) {
    clearTimeout(retry);
    if (hasWaited) refused = null;
    store.update({ isAway: false });
    if (!hasWaited) return;
    if (page.canPlan && (store.state.mission || unsure) && isUnsaved(store.state))
      void save({ byItself: true }).then(
        () => !isUnsaved(store.state) && toast(t("Connected again. Everything is saved.")),
      );
    else toast(t("Connected again."));
  }

  // opening, and the draft that outlives the page

  async function open(id) {
    const { data } = await get(`/missions/${id}`);
    openStored(data);
    const draft = page.canPlan ? drafts.read(id) : null;
    const decision = draftDecision(draft, data, store.state.savedBasis);
    if (draft && decision === "none") drafts.drop(id);
    if (decision === "none") return;
    const mine = { name: draft.name || data.name, selection: draft.selection };
    const both = decision === "behind" && draft.base ? merged(draft.base, mine, store.state.stored) : null;
    const shown = both?.clashes.length === 0 ? both : mine;
    change(shown.selection);
    store.update({ name: shown.name });
    if (decision === "behind" && shown === mine) await conflicts.conflictWith(data, draft.revision, draft.base ?? null);
    else toast(t("Your unsaved changes are back."), { label: t("Drop them"), act: () => dropChanges(data) });
    settleDraft(); // from now on it is this page's
  }

  function dropChanges(mission) {
    const { name } = store.state;
    const mine = selection();
    const { stored, plan } = storedOf(mission);
    change(stored);
    store.update({ name: mission.name });
    if (store.state.mission.revision === mission.revision) shownAs(mission, stored, plan);
    toast(t("Your changes are dropped."), { label: t("Undo"), act: () => (change(mine), store.update({ name })) });
  }

  function openDraft() {
    const draft = drafts.read(null);
    if (!draft || !isStarted({ name: draft.name ?? "", selection: draft.selection })) return;
    history.startFrom(draft.selection);
    store.update({ name: draft.name ?? "" });
    settleDraft();
    if (draft.selection.targets.length || draft.name)
      toast(t("Your unsaved mission is back."), { label: t("Start empty"), act: startEmpty });
  }

  function startEmpty() {
    const { name, plan } = store.state;
    const mine = selection();
    if (!change({ ...picks.EMPTY }) && !name) return;
    store.update({ name: "", plan: null, problem: null, chosenTarget: null, litTarget: null });
    toast(t("Everything is cleared."), { label: t("Undo"), act: () => (change(mine), store.update({ name, plan })) });
  }

  /** Keeps what is unsaved, and drops this page's draft where there is nothing left to keep. False where it could not be kept. */
  function settleDraft() {
    const { mission, name, conflict, stored } = store.state;
    const isWorthKeeping = mission ? isUnsaved(store.state) : isStarted(store.state);
    if (isWorthKeeping) {
      const since = conflict
        ? { revision: conflict.base, base: conflict.before }
        : { revision: mission?.revision ?? 0, base: stored };
      return drafts.keep(mission?.id ?? null, { name, selection: selection(), ...since });
    }
    drafts.dropOwn(mission?.id ?? null);
    return true;
  }

  async function deleteMission() {
    try {
      await remove(`/missions/${store.state.mission.id}`);
      drafts.drop(store.state.mission.id);
      location.href = `/?gone=${store.state.mission.id}&was=${encodeURIComponent(store.state.mission.name)}`;
    } catch (error) {
      failed(t("Not deleted."), error);
    }
  }

  return {
    save,
    open,
    openStored,
    openDraft,
    startEmpty,
    settleDraft,
    deleteMission,
    connectedAgain,
    shownAs,
    storedOf,
    keepOpen,
    keepMineAsCopy: KEEP_COPY.act,
    rename: (name) => store.update({ name }),
  };
}
