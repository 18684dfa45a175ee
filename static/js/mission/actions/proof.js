/** The proof of the stored plan in the background: a better bound for it, or a better plan that one click shows. */

import { ApiError, get, isAbort, post } from "../../api.js";
import { followLive } from "../../live/jobs.js";
import { announce } from "../../page/toast.js";
import { t } from "../../text.js";
import { improvementWords, isWorse } from "../plan/compare.js";
import { planOf, withResult } from "../plan/plan_results.js";
import { isPlanCurrent } from "../plan/plan_view.js";
import { cancelJob } from "./plan_beside.js";

/** @import { Answer } from "../../api.js" */
/** @import { Job, JobLink, Mission } from "../../api_types.d.ts" */
/** @import { MissionContext, MissionPageState, MissionStore, PlanProof, PlanResult, ShownPlan } from "../types.d.ts" */

const MAX_PROVEN_TARGETS = 40;
const BY_HAND = "by hand";
const SEARCHED = "ruin and recreate"; // the method of plans that a proof can better: of others it knows as much already

/** @type {Omit<PlanProof, "mission" | "basis" | "planned_at">} */
const BEGINNING = {
  job: null,
  isStopping: false,
  isOver: false,
  isFinished: false,
  progress: 0,
  better: null,
  words: "",
};

/**
 * Whether a proof can say more of the plan on the page: stored, searched, and neither proven nor about to change.
 *
 * @param {Readonly<MissionPageState>} state
 */
export function canBeProven({ plan, planIsStored, mission, planning, saving, selection, hand }) {
  if (!plan || !planIsStored || planning || saving || hand || mission?.state !== "planned") return false;
  const { is_proven, method, routes } = plan.result;
  return (
    isPlanCurrent({ plan, selection }) &&
    !is_proven &&
    method === SEARCHED &&
    selection.targets.length <= MAX_PROVEN_TARGETS &&
    routes.some(({ geometry }) => geometry)
  );
}

/**
 * The plan on the page with what the server knows of its quality by now.
 *
 * @param {PlanResult} result
 * @param {PlanResult} known
 * @returns {PlanResult}
 */
export function withQuality(result, { lower_bound_m, lower_bound_s, lower_bound_wh, gap, gap_of, is_proven, proof }) {
  return { ...result, lower_bound_m, lower_bound_s, lower_bound_wh, gap, gap_of, is_proven, proof };
}

/** The plan on the page is the stored one: its quality is known better now. @param {MissionStore} store @param {PlanResult} known */
function learn(store, known) {
  const { plan, mission, figures } = store.state;
  if (!plan || !mission) return;
  const result = withQuality(plan.result, known);
  store.update({
    mission: { ...mission, plan: result },
    plan: { ...plan, result },
    figures: withResult(figures, plan.basis, result),
  });
}

/**
 * What is better in the plan that a proof has found; empty where it is no better than the one on the page, or by metres and seconds alone.
 *
 * @param {Readonly<MissionPageState>} state
 * @param {PlanProof} now
 * @param {PlanResult} found
 */
function betterWords({ plan, selection }, now, found) {
  if (!plan || plan.basis !== now.basis || !isWorse(plan, planOf(found, selection))) return "";
  return improvementWords(plan.result, found);
}

/** Null where there is no such job any more. @param {unknown} error */
function orGone(error) {
  if (error instanceof ApiError && error.status === 404) return null;
  throw error;
}

/**
 * Follow the proof of a mission's plan to its end. One is begun where the mission names none, or one that is gone or was cancelled.
 *
 * @param {string} mission
 * @param {string | null} known the job that the mission names
 * @param {{ signal: AbortSignal, onJob: (job: string) => void, onProgress: (job: Job) => void }} how
 */
export async function endOfProof(mission, known, { signal, onJob, onProgress }) {
  let hasRun = false; // while it was followed
  /** @param {string} job */
  const follow = (job) => {
    onJob(job);
    return followLive(job, {
      signal,
      onProgress(now) {
        hasRun = true;
        onProgress(now);
      },
    });
  };
  const ended = known && (await follow(known).catch(orGone));
  if (known && ended && (ended.state !== "cancelled" || hasRun)) return { job: known, ended };
  const { data } = /** @type {Answer<JobLink>} */ (await post(`/missions/${mission}/proof`, {}));
  return { job: data.job, ended: await follow(data.job) };
}

/**
 * @param {MissionContext} context
 * @param {(made: ShownPlan, asked: MissionPageState["selection"]) => void} show
 */
export function createProof({ store, page }, show) {
  /** @type {AbortController | null} */
  let following = null;

  /** @param {PlanProof} now @param {Partial<PlanProof>} changes */
  function put(now, changes) {
    const { proof } = store.state;
    if (proof?.basis === now.basis && proof.planned_at === now.planned_at)
      store.update({ proof: { ...proof, ...changes } });
  }

  /** @param {PlanProof} now */
  async function look(now) {
    const { mission } = now;
    const own = new AbortController();
    following = own;
    try {
      const { job, ended } = await endOfProof(mission, store.state.plan?.result.proof ?? null, {
        signal: own.signal,
        onJob: (job) => put(now, { job }),
        // several plans are looked for in turn, and the server tells the progress of each
        onProgress: ({ progress }) => put(now, { progress: Math.max(progress, store.state.proof?.progress ?? 0) }),
      });
      const { data: stored } = /** @type {Answer<Mission>} */ (
        await get(`/missions/${mission}`, { signal: own.signal })
      );
      if (own.signal.aborted || stored.planned_at !== now.planned_at) return;
      put(now, { isOver: true, isFinished: ended.state === "done" });
      if (stored.plan) learn(store, stored.plan);
      const better = /** @type {PlanResult | null} */ (ended.result && { ...ended.result, job });
      const words = better ? betterWords(store.state, now, better) : "";
      if (!words) return;
      put(now, { better, words });
      announce(t("A better plan was found: {difference}.", { difference: words }));
    } catch (error) {
      if (!isAbort(error)) put(now, { isOver: true }); // the plan stays as good as it is known to be
      if (!(error instanceof ApiError) && !isAbort(error)) throw error;
    } finally {
      if (following === own) following = null;
    }
  }

  /** Forget the proof of a plan that is no longer on the page. Where the mission has another one, its job would prove nothing. */
  function forget() {
    const { proof } = store.state;
    if (!proof) return;
    following?.abort();
    following = null;
    const { mission } = store.state;
    const isReplaced = mission?.id === proof.mission && mission.planned_at !== proof.planned_at;
    if (!proof.isOver && isReplaced) cancelJob(proof.job);
    store.update({ proof: null });
  }

  store.listen(["plan", "planIsStored", "mission", "planning", "saving", "selection", "hand"], (state) => {
    const { plan, mission, proof } = state;
    const isOfPlan =
      proof &&
      plan?.basis === proof.basis &&
      mission?.planned_at === proof.planned_at &&
      plan.result.method !== BY_HAND;
    if (proof && !(isOfPlan && isPlanCurrent(state))) forget();
    if (!page.canPlan || store.state.proof || !mission?.planned_at || !plan || !canBeProven(state)) return;
    const now = { ...BEGINNING, mission: mission.id, basis: plan.basis, planned_at: mission.planned_at };
    store.update({ proof: now });
    void look(now);
  });

  return {
    /** What is known until now is kept. */
    stopProof() {
      const { proof } = store.state;
      if (!proof) return;
      cancelJob(proof.job);
      store.update({ proof: { ...proof, isStopping: true } });
    },
    showBetterPlan() {
      const { proof, selection } = store.state;
      if (!proof?.better) return;
      const { better } = proof;
      store.update({ proof: { ...proof, better: null } });
      show(planOf(better, selection), selection);
    },
  };
}
