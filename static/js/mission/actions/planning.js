/** Planning what is picked: by the chosen objective, then by the other to set beside it; following a large job, and stopping it. */

import { follow, get, post } from "../../api.js";
import { followLive } from "../../live/jobs.js";
import { say, toast } from "../../page/toast.js";
import { t, tn } from "../../text.js";
import { isSamePlan, isWorse, summaryOfPlan } from "../compare.js";
import {
  figuresOf,
  isPlanCurrent,
  isWithoutBattery,
  OBJECTIVES,
  otherObjective,
  qualityOf,
  sentenceOf,
  unreachedOf,
  wishWordsOf,
} from "../plan_view.js";
import * as picks from "../selection.js";

const MOST_PLANNED_AT_ONCE = 12; // up to here the server answers at once, and a mission that is opened gets both plans
const MOST_KEPT = 16; // plans that undo, redo and the choice of what is best at bring back at once

/** The plan of a result, with the selection that it was made for: its indices point into that. */
export function planOf(result, selection) {
  const { targets, uavs, charging_w = null } = selection;
  return {
    result,
    basis: picks.basisOf(selection),
    freeBasis: picks.basisOf(picks.withoutWishes(selection)),
    targets,
    uavs,
    charging_w,
  };
}

/** Results by what they were made for; the oldest go, and those of another ground: a zone may have come in since. */
export function withResult(figures, basis, result) {
  const rest = Object.entries(figures).filter(
    ([known, other]) => known !== basis && other.ground_revision === result.ground_revision,
  );
  return Object.fromEntries([...rest.slice(-MOST_KEPT + 1), [basis, result]]);
}

/** A large plan names its job: whoever stores the plan stores this one, and no other that a second search would find. */
const ofJob = (job) => job.result && { ...job.result, job: job.id };

/** context: see actions.js. `running.stopping` is the AbortController of what is being waited for. */
export function createPlanning({ store, selection, change, problem, failed, running, page, runningJob }) {
  async function waitForJob(jobId, what) {
    const job = await followLive(jobId, {
      signal: running.stopping?.signal,
      onProgress: (at) =>
        store.update({
          planning: {
            ...store.state.planning,
            what,
            found: at.message,
            share: at.state === "queued" ? null : at.progress,
            isQueued: at.state === "queued",
            best: at.best ?? store.state.planning?.best ?? null,
            job: jobId,
          },
        }),
    });
    if (job.state === "cancelled" && !job.result) throw new DOMException("stopped", "AbortError");
    return job;
  }

  function missing() {
    if (!selection().targets.length)
      return [t("Nothing picked yet."), t("Click a tower, bridge or track on the map, then plan.")];
    if (!selection().uavs.length) return [t("No UAV is chosen."), t("Tick one in the list, or add the first one.")];
    return null;
  }

  let isWanted = false; // somebody asked while a save was under way
  store.listen(["saving"], ({ saving }) => {
    if (saving || !isWanted) return;
    isWanted = false;
    queueMicrotask(plan); // after whoever saved has settled
  });

  async function plan() {
    if (store.state.planning) return;
    if (store.state.saving) {
      isWanted = true;
      return;
    }
    const lacking = missing();
    if (lacking) {
      problem(...lacking, [], { untilChanged: true });
      return;
    }
    const asked = selection();
    await search(asked, async (signal) => {
      const answer = await post("/plans", picks.requestOf(asked), { signal });
      return answer.status === 202 ? { job: answer.data.job } : answer.data;
    });
  }

  /** Shows the plan of what was asked once `begin(signal)` gives it, or the { job } that makes it. */
  async function search(asked, begin) {
    const what = tn(asked.targets.length, "Planning {count} target", "Planning {count} targets");
    const mission = store.state.mission?.id ?? null;
    aside.stop();
    running.stopping = new AbortController();
    store.update({ planning: { what, share: null, job: null, best: null, isStopping: false }, problem: null });
    try {
      let result = await begin(running.stopping.signal);
      if (!result.routes) {
        const { job } = result;
        store.update({ planning: { ...store.state.planning, job } });
        runningJob.keep(mission, { job, selection: asked });
        result = { ...(await waitForJob(job, what)).result, job }; // saved by the job's number
      }
      const made = planOf(result, asked);
      const before = store.state.plan;
      if (before?.basis === made.basis && isWorse(made, before)) {
        toast(t("The new plan is no better ({figures}). The one on the page stays.", { figures: figuresOf(result) }));
        aside.want(asked);
        return;
      }
      if (store.state.planning.isStopping) toast(t("Stopped. The best plan so far is kept."));
      store.update({
        plan: made,
        figures: withResult(store.state.figures, made.basis, result),
        planIsStored: false,
        chosenRoute: null,
        why: null,
      });
      const { sentence, facts } = sentenceOf(made);
      const unreached = unreachedOf(made).length;
      const quality = qualityOf(result);
      say(
        [
          `${sentence}. ${facts}.`,
          quality?.words,
          wishWordsOf(result),
          unreached && tn(unreached, "{count} target is not reached.", "{count} targets are not reached."),
        ]
          .filter(Boolean)
          .join(" "),
      );
      if (picks.basisOf(selection()) === made.basis) aside.want(asked);
      else if (!isPlanCurrent(store.state)) tellChanged();
    } catch (error) {
      if (error.name === "AbortError") toast(t("Planning stopped. Nothing was changed."));
      else failed(t("Not planned."), error, [{ label: t("Plan again"), act: plan }], { untilChanged: true, asked });
    } finally {
      runningJob.drop(mission);
      running.stopping = null;
      store.update({ planning: null });
    }
  }

  function tellChanged() {
    const words = t("The plan is of what was picked when planning began.");
    problem(t("The selection has changed since."), words, [{ label: t("Plan again"), act: plan }], {
      untilChanged: true,
      level: "warning",
    });
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
        if (error.status === 404) throw new DOMException("gone", "AbortError"); // cleared away since
        throw error;
      }
      return { job: kept.job };
    });
  }

  /** Drops the search with what it has found. */
  function cancel() {
    cancelJob(store.state.planning?.job);
    running.stopping?.abort();
  }

  async function stop() {
    const job = store.state.planning?.job;
    if (!job) {
      running.stopping?.abort();
      return;
    }
    store.update({ planning: { ...store.state.planning, isStopping: true } });
    try {
      await post(`/jobs/${job}/cancel`, {});
    } catch (error) {
      if (error.status === 409) return; // it ended by itself
      if (store.state.planning) store.update({ planning: { ...store.state.planning, isStopping: false } });
      failed(t("Not stopped."), error);
    }
  }

  const aside = planBeside(store);

  // A selection that has been planned before, by undo or by the other objective, shows its plan again; so it does when the answer to an
  // earlier save brings back the plan of what was picked then.
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
    if (page.canPlan && isShownAsStored && state.selection.targets.length <= MOST_PLANNED_AT_ONCE)
      aside.want(state.selection);
  });

  let shown = null; // the plan on the page in short
  store.listen(["plan"], ({ plan: now }) => {
    if (!now) return;
    const summary = summaryOfPlan(now);
    if (shown && !isSamePlan(shown, summary)) store.update({ lastPlan: shown });
    shown = summary;
  });

  /** A line of which only parts can be flown becomes these parts. */
  function replaceByStretches(target, stretches) {
    const parts = stretches.map((stretch) => {
      const part = { ...target, position: null, stretch, centre: stretch[0] };
      return { ...part, key: picks.keyOf(part) };
    });
    store.update({ why: null });
    change({
      ...selection(),
      targets: selection().targets.flatMap((other) => (other.key === target.key ? parts : [other])),
    });
  }

  return {
    plan,
    stop,
    cancel,
    resume,
    replaceByStretches,
    waitForJob,
    makeRoom: aside.giveWay,
    planAlternatives: () => store.state.plan && isPlanCurrent(store.state) && aside.wantAll(selection()),
    stopAlternatives: aside.stop,
  };
}

function cancelJob(job) {
  if (job) post(`/jobs/${job}/cancel`, {}).catch(() => {}); // nobody waits for it
}

/**
 * The same by another objective, planned behind the page: its figures stand in the choice, and one click shows it. All of them where somebody
 * compares.
 *
 * A large one waits until the plan on the page is saved and nothing else of this person's runs, and gives way to what is asked for.
 */
function planBeside(store) {
  let wanted = null; // the selection of a large plan, until its other one is begun
  let running = null; // the same while it is made
  let stopping = null;
  let job = null;

  function stop() {
    wanted = running = null;
    stopping?.abort();
    cancelJob(job);
    [stopping, job] = [null, null];
    store.update({ planningBeside: null });
  }

  /** To a save that the server has to plan for; the large one is made after it. */
  function giveWay() {
    if (!running || running.targets.length <= MOST_PLANNED_AT_ONCE) return;
    const later = running;
    stop();
    wanted = later;
  }

  function want(asked) {
    if (asked.targets.length <= MOST_PLANNED_AT_ONCE) void start(asked);
    else {
      wanted = asked;
      beginWanted(store.state);
    }
  }

  function beginWanted({ saving, planning, planIsStored, selection }) {
    if (!wanted || saving || planning || !planIsStored) return;
    const asked = wanted;
    wanted = null;
    if (picks.basisOf(selection) === picks.basisOf(asked)) void start(asked);
  }
  store.listen(["saving", "planning", "planIsStored"], beginWanted);

  async function isAlone(signal) {
    return (await get("/jobs?open=true&mine=true&limit=1", { signal })).data.results.length === 0;
  }

  async function start(asked) {
    const other = { ...asked, objective: otherObjective(asked.objective) };
    const basis = picks.basisOf(other);
    if (store.state.figures[basis] || store.state.planningBeside === basis) return;
    const own = begin(asked);
    try {
      if (asked.targets.length > MOST_PLANNED_AT_ONCE && !(await isAlone(own.signal))) return;
      await make(other, own);
    } catch (error) {
      if (error.name !== "AbortError")
        say(t("The other way of planning has no figures: {reason}", { reason: error.message }));
    } finally {
      end(own);
    }
  }

  /** One after the other; what is refused says why, and the next is made. */
  async function wantAll(asked) {
    stop();
    const own = begin(asked);
    try {
      for (const { value } of OBJECTIVES) {
        const other = { ...asked, objective: value };
        if (own.signal.aborted) return;
        if (store.state.figures[picks.basisOf(other)] || (value === "energy" && isWithoutBattery(store.state.plan)))
          continue;
        try {
          await make(other, own);
        } catch (error) {
          if (error.name === "AbortError") return;
          store.update({ refusedBeside: { ...store.state.refusedBeside, [picks.basisOf(other)]: error.message } });
        }
      }
    } finally {
      end(own);
    }
  }

  function begin(asked) {
    stopping = new AbortController();
    running = asked;
    return stopping;
  }

  function end(own) {
    if (stopping !== own) return;
    [stopping, job, running] = [null, null, null];
    store.update({ planningBeside: null });
  }

  async function make(other, own) {
    const basis = picks.basisOf(other);
    store.update({ planningBeside: basis });
    const answer = await post("/plans", picks.requestOf(other)); // not cut short: a job that nobody knows of could not be stopped
    const begun = answer.status === 202 ? answer.data.job : null;
    if (own.signal.aborted) return void cancelJob(begun);
    job = begun;
    const made = job ? (await follow(job, { signal: own.signal })).result : answer.data;
    job = null;
    const result = made && begun ? { ...made, job: begun } : made;
    if (result && !own.signal.aborted) store.update({ figures: withResult(store.state.figures, basis, result) });
  }

  return {
    want,
    wantAll,
    stop,
    giveWay,
    keepOnlyFor(selection) {
      const { planningBeside } = store.state;
      const wanted = OBJECTIVES.map(({ value }) => picks.basisOf({ ...selection, objective: value }));
      if (planningBeside && !wanted.includes(planningBeside)) stop();
    },
  };
}
