/** Planning of the selection: by the chosen objective, then by the other for comparison; following a large job, and stopping it. */

import { ApiError, get, isAbort, post } from "../../api.js";
import { followLive } from "../../live/jobs.js";
import { announce, toast } from "../../page/toast.js";
import { t, tn } from "../../text.js";
import { lackingOf } from "../flying/next_act.js";
import { isSamePlan, isWorse, summaryOfPlan } from "../plan/compare.js";
import { qualityOf, wishWordsOf } from "../plan/plan_quality.js";
import { planOf, withResult } from "../plan/plan_results.js";
import { figuresOf, isPlanCurrent, sentenceOf, unassignedOf } from "../plan/plan_view.js";
import * as picks from "../selection.js";
import { cancelJob, createPlanBeside, createUavNumbers, MAX_PLANNED_AT_ONCE } from "./plan_beside.js";
import { createProof } from "./proof.js";
import { replanSmallChanges } from "./replanning.js";

/** @import { Answer } from "../../api.js" */
/** @import { JobLink } from "../../api_types.d.ts" */
/** @import { BestSoFar, MissionContext, MissionSelection, PickedTarget, Planning, PlanResult, ShownPlan } from "../types.d.ts" */

/** @typedef {ReturnType<typeof createPlanBeside>} PlanBeside */
/** @typedef {(signal: AbortSignal) => Promise<PlanResult | { job: string }>} Begin returns the plan, or the job that makes it */

/** @param {MissionContext} context */
export function createPlanning(context) {
  const { store, selection, change } = context;
  const aside = createPlanBeside(store);
  const waitForJob = createWaiting(context);
  const { plan, resume, show } = createSearch(context, aside, waitForJob);
  showKnownPlans(context, aside);
  rememberLastPlan(context);
  replanSmallChanges(context, plan);
  const numbers = createUavNumbers(context, aside);

  return {
    plan() {
      store.update({ tool: "point" }); // picking is over
      return plan();
    },
    resume,
    ...numbers,
    ...createStopping(context),
    ...createProof(context, show),
    waitForJob,
    makeRoom: aside.giveWay,
    planAlternatives: () => {
      if (store.state.plan && isPlanCurrent(store.state)) void aside.wantAll(selection());
    },
    stopAlternatives: aside.stop,
    /**
     * A line of which only parts can be flown becomes these parts.
     *
     * @param {PickedTarget} target
     * @param {number[][][]} stretches
     */
    replaceByStretches(target, stretches) {
      const parts = stretches.map((stretch) => {
        const part = { ...target, position: null, stretch, centre: stretch[0] };
        return { ...part, key: picks.keyOf(part) };
      });
      store.update({ why: null });
      change({
        ...selection(),
        targets: selection().targets.flatMap((other) => (other.key === target.key ? parts : [other])),
      });
    },
  };
}

/** @type {Planning} */
const BEGINNING = { what: "", share: null, job: null, best: null, isStopping: false };

/**
 * Follow a job, with its progress on the page.
 *
 * @param {MissionContext} context
 * @returns {(job: string, what: string) => Promise<unknown>} what it has made
 */
function createWaiting({ store, running }) {
  return async (jobId, what) => {
    const job = await followLive(jobId, {
      signal: running.stopping?.signal,
      onProgress: (at) => {
        const { planning } = store.state;
        const best = /** @type {BestSoFar | null} */ (at.best) ?? planning?.best ?? null;
        const isQueued = at.state === "queued";
        const share = isQueued ? null : at.progress;
        store.update({
          planning: { ...BEGINNING, ...planning, what, found: at.message, share, isQueued, best, job: jobId },
        });
      },
    });
    if (job.state === "cancelled" && !job.result) throw new DOMException("stopped", "AbortError");
    return job.result;
  };
}

/**
 * @param {MissionContext} context
 * @param {PlanBeside} aside
 * @param {ReturnType<typeof createWaiting>} waitForJob
 */
function createSearch(context, aside, waitForJob) {
  const { store, selection, problem, failed, running, page, runningJob } = context;
  const show = createShowing(context, aside, plan);
  let isWanted = false; // planning was requested during a save
  store.listen(["saving"], ({ saving }) => {
    if (saving || !isWanted) return;
    isWanted = false;
    queueMicrotask(plan); // after the save has settled
  });

  async function plan() {
    if (store.state.planning) return;
    if (store.state.saving) {
      isWanted = true;
      return;
    }
    const asked = selection();
    const lacking = lackingOf(asked);
    if (lacking) {
      problem(...lacking, [], { untilChanged: true });
      return;
    }
    await search(asked, async (signal) => {
      const answer = /** @type {Answer<PlanResult | JobLink>} */ (
        await post("/plans", picks.requestOf(asked), { signal })
      );
      return /** @type {PlanResult | { job: string }} */ (
        answer.status === 202 ? { job: answer.data.job } : answer.data
      );
    });
  }

  /** Show the plan of a selection. @param {MissionSelection} asked @param {Begin} begin */
  async function search(asked, begin) {
    const what = tn(asked.targets.length, "Planning {count} target", "Planning {count} targets");
    const mission = store.state.mission?.id ?? null;
    aside.stop();
    running.stopping = new AbortController();
    store.update({ planning: { ...BEGINNING, what }, problem: null });
    try {
      const begun = await begin(running.stopping.signal);
      if ("routes" in begun) show(planOf(begun, asked), asked);
      else {
        const { job } = begun;
        store.update({ planning: { ...BEGINNING, ...store.state.planning, job } });
        runningJob.keep(mission, { job, selection: asked });
        const result = /** @type {PlanResult} */ (await waitForJob(job, what));
        show(planOf({ ...result, job }, asked), asked); // saved by the job's number
      }
    } catch (error) {
      if (isAbort(error)) toast(t("Planning stopped. Nothing was changed."));
      else failed(t("Not planned."), error, [{ label: t("Plan again"), act: plan }], { untilChanged: true, asked });
    } finally {
      runningJob.drop(mission);
      running.stopping = null;
      store.update({ planning: null });
    }
  }

  /** A large plan that was being made when the page was left: its progress comes back, or its result. */
  async function resume() {
    const mission = store.state.mission?.id ?? null;
    const kept = page.canPlan ? runningJob.read(mission) : null;
    if (!kept || store.state.planning) return;
    await search(kept.selection, async (signal) => {
      try {
        await get(`/jobs/${kept.job}`, { signal });
      } catch (error) {
        if (error instanceof ApiError && error.status === 404) throw new DOMException("gone", "AbortError"); // removed since
        throw error;
      }
      return { job: kept.job };
    });
  }

  return { plan, resume, show };
}

/**
 * Shows a plan once it is made, where it is no worse than the one on the page.
 *
 * @param {MissionContext} context
 * @param {PlanBeside} aside
 * @param {() => Promise<void>} planAgain
 * @returns {(made: ShownPlan, asked: MissionSelection) => void}
 */
function createShowing({ store, selection, problem }, aside, planAgain) {
  function showChanged() {
    const words = t("The plan is of what was picked when planning began.");
    problem(t("The selection has changed since."), words, [{ label: t("Plan again"), act: planAgain }], {
      untilChanged: true,
      level: "warning",
    });
  }

  return (made, asked) => {
    const { result } = made;
    const before = store.state.plan;
    if (before?.basis === made.basis && isWorse(made, before)) {
      toast(t("The new plan is no better ({figures}). The one on the page stays.", { figures: figuresOf(result) }));
      aside.want(asked);
      return;
    }
    if (store.state.planning?.isStopping) toast(t("Stopped. The best plan so far is kept."));
    store.update({
      plan: made,
      figures: withResult(store.state.figures, made.basis, result),
      planIsStored: false,
      chosenRoute: null,
      why: null,
    });
    announce(wordsOf(made));
    if (picks.basisOf(selection()) === made.basis) aside.want(asked);
    else if (!isPlanCurrent(store.state)) showChanged();
  };
}

/** A new plan for those who do not see it. @param {ShownPlan} made */
function wordsOf(made) {
  const { sentence, facts } = sentenceOf(made);
  const unreached = unassignedOf(made).length;
  return [
    `${sentence}. ${facts}.`,
    qualityOf(made.result)?.words,
    wishWordsOf(made.result),
    unreached && tn(unreached, "{count} target is not reached.", "{count} targets are not reached."),
  ]
    .filter(Boolean)
    .join(" ");
}

/** @param {MissionContext} context */
function createStopping({ store, failed, running }) {
  /** @param {boolean} isStopping */
  const put = (isStopping) => {
    const { planning } = store.state;
    if (planning) store.update({ planning: { ...planning, isStopping } });
  };
  return {
    /** Cancel the search; its best plan is dropped. */
    cancel() {
      cancelJob(store.state.planning?.job);
      running.stopping?.abort();
    },
    /** Stop the search, and keep the best plan so far. */
    async stop() {
      const job = store.state.planning?.job;
      if (!job) {
        running.stopping?.abort();
        return;
      }
      put(true);
      try {
        await post(`/jobs/${job}/cancel`, {});
      } catch (error) {
        if (error instanceof ApiError && error.status === 409) return; // it ended by itself
        put(false);
        failed(t("Not stopped."), error);
      }
    },
  };
}

/**
 * Show the known plan of a selection that was planned before, after undo or a change of objective; also when the answer to an earlier
 * save brings back the plan of the present selection.
 *
 * @param {MissionContext} context
 * @param {PlanBeside} aside
 */
function showKnownPlans({ store, page }, aside) {
  store.listen(["selection", "plan"], (state) => {
    const basis = picks.basisOf(state.selection);
    const known = state.figures[basis];
    if (known && state.plan?.basis !== basis) {
      store.update({
        plan: planOf(known, state.selection),
        planIsStored: known === state.mission?.plan,
        why: state.why?.compare || state.why?.alternatives ? state.why : null,
      });
    }
    aside.keepOnlyFor(state.selection);
    const isShownAsStored = state.planIsStored && state.plan?.basis === basis;
    if (page.canPlan && isShownAsStored && state.selection.targets.length <= MAX_PLANNED_AT_ONCE)
      aside.want(state.selection);
  });
}

/** The plan before the one on the page is kept in short, to compare. @param {MissionContext} context */
function rememberLastPlan({ store }) {
  store.listen(["plan"], ({ plan: now, shownPlan: before, lastPlan }) => {
    if (!now) return;
    const summary = summaryOfPlan(now);
    store.update({ shownPlan: summary, lastPlan: before && !isSamePlan(before, summary) ? before : lastPlan });
  });
}
