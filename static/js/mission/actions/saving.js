/** Saving of changes: on request, a moment after each change, and again once the server is back. */

import { ApiError, get, isAbort, patch, post } from "../../api.js";
import { toast } from "../../page/toast.js";
import { t } from "../../text.js";
import { isPlanCurrent, isUnsaved } from "../plan/plan_view.js";
import { storedBasisOf } from "../selection.js";
import { settleDraft } from "./opening.js";
import { attemptOf } from "./save_request.js";
import { createStoredMission, unlessOfSaving } from "./stored_mission.js";

/** @import { Answer } from "../../api.js" */
/** @import { JobLink, Mission } from "../../api_types.d.ts" */
/** @import { MissionContext, MissionPageState, Version } from "../types.d.ts" */
/** @import { Attempt } from "./save_request.js" */

/** @typedef {{ asCopy?: boolean, byItself?: boolean }} SaveOptions byItself: saved automatically, so success is not announced */
/** @typedef {{ meet: (lost: Version | null) => Promise<void>, seeBoth: () => void, showDeleted: () => void }} Conflicts */
/** @typedef {{ waitForJob: (job: string, words: string) => Promise<unknown>, makeRoom: () => void }} Planner */
/** @typedef {ReturnType<typeof setTimeout> | undefined} Timer */

export const RETRY_S = 8;
const REST_MS = 1500; // after the last change
const AT_ONCE_MS = 200;

/** @param {Pick<MissionPageState, "selection" | "name" | "plan">} state */
const whatIsThere = ({ selection, name, plan }) =>
  JSON.stringify([storedBasisOf(selection), name, plan?.basis ?? null]);

/** @param {string} id */
function addressNow(id) {
  globalThis.history.replaceState(null, "", `/missions/${id}${location.hash}`);
}

/**
 * @param {MissionContext} context
 * @param {Planner} planner
 * @param {Conflicts} conflicts
 */
export function createSaving(context, { waitForJob, makeRoom }, conflicts) {
  const { store, page, running } = context;
  const send = createSender(context, waitForJob);
  /** @type {Attempt | null} */
  let unsure = null; // a save without an answer
  /** @type {SaveOptions | null} */
  let wanted = null; // a save that the user requested while another was running
  /** @type {string | null} */
  let refused = null; // the version whose save failed: it is retried once it has changed
  /** @type {Timer} */
  let rest;
  const later = createRetry(context, conflicts, save, () => {
    refused = null;
  });

  /** @param {SaveOptions} [options] */
  async function save({ asCopy = false, byItself = false } = {}) {
    const { mission, saving, planning, conflict } = store.state;
    if (saving || planning) {
      if (saving && !byItself) wanted = { asCopy };
      return;
    }
    if (conflict && !asCopy) {
      if (!byItself) conflicts.seeBoth();
      return;
    }
    later.stop();
    clearTimeout(rest);
    const isNew = !mission || asCopy;
    const isAgain = isNew && unsure?.isNew && unsure.asCopy === asCopy; // the answer of the first try may be waiting: ask for just the same
    const attempt = isAgain && unsure ? unsure : attemptOf(store.state, asCopy);
    if (!Object.keys(attempt.body).length) {
      if (!byItself) toast(t("“{name}” is saved.", { name: mission?.name ?? "" }));
      return;
    }
    if (attempt.body.plan && !attempt.body.plan_of) makeRoom();
    store.update({ saving: true, problem: unlessOfSaving(store.state.problem) });
    try {
      const saved = await send(attempt);
      unsure = refused = null;
      if (isNew && byItself) toast(t("“{name}” is saved. From now on it saves itself.", { name: saved.name }));
      else if (!byItself) toast(t("“{name}” is saved.", { name: saved.name }));
    } catch (error) {
      const lost = unsure?.asked ?? null; // what an earlier try may have stored after all
      unsure = error instanceof ApiError && error.isAway ? attempt : null;
      refused = whatIsThere(store.state);
      await later.afterFailure(error, asCopy, lost);
    } finally {
      running.stopping = null;
      store.update({ saving: false, planning: null });
      const next = wanted;
      wanted = null;
      if (next) void save(next);
    }
  }

  // A refused save may succeed on another revision.
  store.listen(["stored"], () => {
    refused = null;
  });
  // A stored mission saves itself a moment after each change; a new one is stored with its first plan.
  store.listen(["selection", "name", "plan", "mission", "saving", "planning", "conflict", "isAway"], (state) => {
    clearTimeout(rest);
    const isWanted = page.canPlan && isUnsaved(state) && (state.mission || isPlanCurrent(state));
    if (!isWanted || state.saving || state.planning || state.conflict) return;
    if (state.isAway || refused === whatIsThere(state)) return; // retried after a delay, when the network returns, or by the user
    rest = setTimeout(() => save({ byItself: true }), state.mission ? REST_MS : AT_ONCE_MS);
  });

  return {
    save,
    keepMineAsCopy: () => save({ asCopy: true }),
    /** @param {string} name */
    rename: (name) => store.update({ name }),
    /** The server answers again: what waited is saved now. */
    connectedAgain(hasWaited = store.state.isAway) {
      later.stop();
      if (hasWaited) refused = null;
      store.update({ isAway: false });
      if (!hasWaited) return;
      if (page.canPlan && (store.state.mission || unsure) && isUnsaved(store.state))
        void save({ byItself: true }).then(
          () => !isUnsaved(store.state) && toast(t("Connected again. Everything is saved.")),
        );
      else toast(t("Connected again."));
    },
  };
}

/**
 * Send the changes and show the server's stored version, also where its plan was not made.
 *
 * @param {MissionContext} context
 * @param {Planner["waitForJob"]} waitForJob
 * @returns {(attempt: Attempt) => Promise<Mission>}
 */
function createSender(context, waitForJob) {
  const { store, drafts, running } = context;
  const { keepOpen } = createStoredMission(context);

  /** @param {string} id */
  const read = async (id) => /** @type {Answer<Mission>} */ (await get(`/missions/${id}`)).data;

  /** @param {JobLink & { mission: string }} begun @param {Version} asked */
  async function planned({ mission: id, job }, asked) {
    running.stopping = new AbortController();
    try {
      await waitForJob(job, t("Planning what is saved"));
      return await read(id);
    } catch (error) {
      await read(id).then(
        (mission) => keepOpen(mission, asked), // stored already, its plan not yet
        () => {},
      );
      throw error;
    }
  }

  return async ({ asked, body, key, isNew }) => {
    const { mission } = store.state;
    const draftOf = mission?.id ?? null; // the copy includes the changes
    const answer = /** @type {Answer<Mission | (JobLink & { mission: string })>} */ (
      isNew || !mission
        ? await post("/missions", body, { headers: { "Idempotency-Key": key } })
        : await patch(`/missions/${mission.id}`, body, { headers: { "If-Match": `"${mission.revision}"` } })
    );
    drafts.dropOwn(draftOf);
    let saved;
    if ("job" in answer.data) {
      if (isNew) addressNow(answer.data.mission);
      saved = await planned(answer.data, asked);
    } else saved = answer.data;
    if (isNew && store.state.name === asked.name) store.update({ name: saved.name }); // a mission without a name receives one
    keepOpen(saved, asked);
    if (isNew) addressNow(saved.id);
    settleDraft(context);
    return saved;
  };
}

/**
 * The text on a failed save, and when it is retried.
 *
 * @param {MissionContext} context
 * @param {Conflicts} conflicts
 * @param {(options: SaveOptions) => Promise<void>} save
 * @param {() => void} mayTryAgain where a plan is being made now, it is tried again after that
 */
function createRetry({ store, problem, failed, wordsOf }, conflicts, save, mayTryAgain) {
  const how = { isOfSaving: true };
  /** @type {Timer} */
  let timer;

  /** @param {ApiError} error @param {boolean} asCopy */
  function waitFor(error, asCopy) {
    const wait_s = Math.max(1, error.retryAfter_s ?? 0);
    const next = t("Next try in {seconds} s.", { seconds: wait_s });
    const again = { label: t("Try now"), act: () => save({ asCopy }) };
    failed(t("Not saved yet."), new ApiError(`${error.message} ${next}`, error), [again], how);
    timer = setTimeout(() => {
      mayTryAgain();
      void save({ asCopy, byItself: true });
    }, wait_s * 1000);
  }

  /** @param {boolean} asCopy */
  function waitForServer(asCopy) {
    store.update({ isAway: true });
    problem(
      t("Not saved: the server cannot be reached."),
      t("Your selection is kept in this browser. Next try in {seconds} s.", { seconds: RETRY_S }),
      [{ label: t("Try now"), act: () => save({ asCopy }) }],
      how,
    );
    timer = setTimeout(() => save({ asCopy, byItself: true }), RETRY_S * 1000);
  }

  /** @param {unknown} error @param {boolean} asCopy */
  function notify(error, asCopy) {
    const standing = unlessOfSaving(store.state.problem);
    if (standing && standing.text === wordsOf(error)) {
      store.update({ problem: { ...standing, title: t("Neither planned nor saved."), ...how } });
      return;
    }
    const isTaken = error instanceof ApiError && error.status === 409;
    const ways = [{ label: t("Try again"), act: () => save({ asCopy }) }];
    if (isTaken) ways.push({ label: t("Keep mine as a copy"), act: () => save({ asCopy: true }) });
    failed(t("Not saved."), error, ways, how);
  }

  return {
    stop: () => clearTimeout(timer),
    /**
     * lost: what an earlier try may have stored after all.
     *
     * @param {unknown} error
     * @param {boolean} asCopy
     * @param {Version | null} lost
     */
    async afterFailure(error, asCopy, lost) {
      if (isAbort(error)) problem(t("Saved as a draft."), t("Planning was stopped before it was done."), [], how);
      else if (!(error instanceof ApiError)) notify(error, asCopy);
      else if (error.status === 412) await conflicts.meet(lost);
      else if (error.status === 404 && store.state.mission && !asCopy) conflicts.showDeleted();
      else if (error.isAway) waitForServer(asCopy);
      else if (error.retryAfter_s !== null) waitFor(error, asCopy);
      else notify(error, asCopy);
    },
  };
}
