/**
 * Starting, following and stopping rehearsals of the mission, and reading their results: store.rehearsal, which the panel and the map
 * listen to.
 */

import { ApiError, get, isAbort, post } from "../../api.js";
import { followLive } from "../../live/jobs.js";
import { t } from "../../text.js";
import { isRunning } from "./rehearsal.js";

/** @import { Answer } from "../../api.js" */
/** @import { Rehearsal, RehearsalDetail, RehearsalInputRequest, RehearsalPage, RehearsalRunWithAssessment, RehearsalTrack } from "../../api_types.d.ts" */
/** @import { MissionStore, RehearsalState } from "../types.d.ts" */

/** @type {RehearsalState} */
export const NOTHING = { list: null, detail: null, run: 0, track: null, running: null, fault: "" };

const LEVELS = ["fail", "warnings", "pass"];

/** The worst run that was flown comes first, then in order. @param {RehearsalRunWithAssessment[]} runs */
function worstOf(runs) {
  const flown = runs.filter(({ level }) => level);
  flown.sort((a, b) => LEVELS.indexOf(a.level) - LEVELS.indexOf(b.level) || a.sequence - b.sequence);
  return flown[0]?.sequence ?? 0;
}

/**
 * Create the rehearsals of a mission. isStage: the page shows only rehearsals, and its address names the selected one.
 *
 * @param {MissionStore} store
 * @param {{ isStage?: boolean }} [options]
 */
export function createRehearsing(store, { isStage = false } = {}) {
  const { change, address, reported, missionId } = createChanging(store);
  const { show, chooseRun, showNewest } = createShowing(store, isStage);
  let asked = 0; // the last reading wins

  /**
   * Read the rehearsals of the mission, and the newest in detail; a running one is followed.
   *
   * @param {string | null} [wanted]
   */
  const read = (wanted = null) =>
    reported(async () => {
      const mission = missionId();
      if (!mission) {
        change({ ...NOTHING });
        return;
      }
      asked += 1;
      const turn = asked;
      const { data } = /** @type {Answer<RehearsalPage>} */ (await get(address()));
      if (turn !== asked || mission !== missionId()) return;
      change({ list: data.results, fault: "" });
      const [newest] = data.results;
      if (newest && isRunning(newest)) void follow(newest);
      await showNewest(data.results, wanted);
    });
  const follow = createFollowing(store, read);

  // Another mission, or another revision of it: rehearsals may belong to another plan.
  let known = "";
  store.listen(["mission"], ({ mission }) => {
    const now = mission ? `${mission.id} ${mission.revision}` : "";
    if (now === known) return;
    known = now;
    void read();
  });

  return {
    show,
    chooseRun,
    /**
     * afresh: start even if an equal rehearsal was flown lately.
     *
     * @param {RehearsalInputRequest["conditions"]} conditions
     * @param {{ afresh?: boolean }} [how]
     */
    start: (conditions, { afresh = false } = {}) =>
      reported(async () => {
        change({ fault: "", running: { id: null, job: null, progress: null, message: t("Being sent") } });
        const key = crypto.randomUUID?.() ?? `${Date.now()}-${Math.random()}`;
        const { data } = /** @type {Answer<Rehearsal>} */ (
          await post(address(), { conditions, afresh }, { headers: { "Idempotency-Key": key } })
        );
        await follow(data);
      }),
    cancel: () =>
      reported(async () => {
        const { running } = store.state.rehearsal;
        if (running?.id) await post(address(running.id, "/cancel"));
      }),
  };
}

/** @param {MissionStore} store */
function createChanging(store) {
  /** @param {Partial<RehearsalState>} values */
  const change = (values) => store.update({ rehearsal: { ...store.state.rehearsal, ...values } });
  const missionId = () => store.state.mission?.id ?? null;
  return {
    change,
    missionId,
    address: (rehearsal = "", rest = "") =>
      `/missions/${missionId()}/rehearsals${rehearsal ? `/${rehearsal}` : ""}${rest}`,
    /** Run an act; shows the server's refusal on the panel. @param {() => Promise<void>} act */
    async reported(act) {
      try {
        await act();
      } catch (error) {
        if (isAbort(error)) return;
        if (!(error instanceof ApiError)) throw error;
        change({ fault: error.message, running: null });
      }
    },
  };
}

/** Create the selection of a rehearsal and of one of its runs. @param {MissionStore} store @param {boolean} isStage */
function createShowing(store, isStage) {
  const { change, address, reported } = createChanging(store);
  const ofAddress = new URLSearchParams(isStage ? location.search : "");

  /** Store the selection in the address: it can be reloaded and shared. */
  function remember() {
    const { detail, run } = store.state.rehearsal;
    if (!isStage || !detail) return;
    const query = new URLSearchParams({ rehearsal: detail.id, run: `${run}` });
    history.replaceState(history.state, "", `${location.pathname}?${query}${location.hash}`);
  }

  /** @param {string} id @param {number} run */
  async function showTrack(id, run) {
    const { data: track } = /** @type {Answer<RehearsalTrack>} */ (await get(address(id, `/track?run=${run}`)));
    if (store.state.rehearsal.detail?.id === id && store.state.rehearsal.run === run) change({ track });
  }

  /** run: null for the worst of its runs. @param {string} id @param {number | null} [run] */
  const show = (id, run = null) =>
    reported(async () => {
      const { data: detail } = /** @type {Answer<RehearsalDetail>} */ (await get(address(id)));
      const chosen = run !== null && detail.runs[run] ? run : worstOf(detail.runs);
      change({ detail, run: chosen, track: null });
      remember();
      if (detail.runs[chosen]?.level) await showTrack(id, chosen);
    });

  return {
    show,
    /** @param {number} run */
    chooseRun: (run) =>
      reported(async () => {
        change({ run, track: null });
        remember();
        const { detail } = store.state.rehearsal;
        if (detail?.runs[run]?.level) await showTrack(detail.id, run);
      }),
    /**
     * Show the requested rehearsal, the present one or that of the address; else the newest that has ended.
     *
     * @param {Rehearsal[]} list
     * @param {string | null} wanted
     */
    async showNewest(list, wanted) {
      const { detail, run } = store.state.rehearsal;
      const named = wanted || detail ? null : ofAddress.get("rehearsal");
      if (named) {
        await show(named, ofAddress.has("run") ? Number(ofAddress.get("run")) : null);
        return;
      }
      const shown =
        list.find(({ id }) => id === (wanted ?? detail?.id)) ??
        list.find(({ level, state }) => level || state === "failed" || state === "cancelled");
      if (shown) await show(shown.id, detail?.id === shown.id ? run : null);
      else change({ detail: null, track: null });
    },
  };
}

/**
 * Follow a rehearsal until it has been flown, then read its result.
 *
 * @param {MissionStore} store
 * @param {(wanted: string) => Promise<void>} read
 */
function createFollowing(store, read) {
  const { change, missionId } = createChanging(store);
  /** @type {string | null} */
  let following = null; // the job that is listened to

  /** @param {Pick<Rehearsal, "id" | "job" | "progress" | "message">} rehearsal */
  return async ({ id, job, progress, message }) => {
    if (following === job) return;
    following = job;
    const mission = missionId();
    change({ running: { id, job, progress, message } });
    try {
      await followLive(job, {
        onProgress: (at) => {
          if (mission !== missionId()) return;
          const isQueued = at.state === "queued";
          const summary = isQueued ? t("Waiting for a worker") : at.message;
          change({ running: { id, job, progress: isQueued ? null : at.progress, message: summary } });
        },
      });
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      change({ fault: error.message });
    } finally {
      following = null;
    }
    if (mission !== missionId()) return;
    const { fault } = store.state.rehearsal;
    change({ running: null });
    await read(id);
    if (fault) change({ fault });
  };
}
