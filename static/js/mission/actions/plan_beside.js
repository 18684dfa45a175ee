/** Plans made in the background beside the one on the page: by another objective, and by other numbers of UAVs. One click shows each. */

import { follow, get, isAbort, post } from "../../api.js";
import { announce } from "../../page/toast.js";
import { t } from "../../text.js";
import { withResult } from "../plan/plan_results.js";
import { isWithoutCapacity, OBJECTIVES, otherObjective } from "../plan/plan_view.js";
import * as picks from "../selection.js";
import { canCompareNumbers, keyOfNumbers, numberOf, withCandidates, withFewer } from "../uavs/uav_numbers.js";

/** @import { Answer } from "../../api.js" */
/** @import { JobLink, JobPage } from "../../api_types.d.ts" */
/** @import { MissionContext, MissionPageState, MissionSelection, MissionStore, PlanResult, UavNumber } from "../types.d.ts" */

export const MAX_PLANNED_AT_ONCE = 12; // up to here the server answers at once, and a mission that is opened gets both plans

/** @param {unknown} error */
const wordsOf = (error) => (error instanceof Error ? error.message : String(error));

/** @param {string | null | undefined} job */
export function cancelJob(job) {
  if (job) post(`/jobs/${job}/cancel`, {}).catch(() => {}); // the page no longer waits for it
}

/**
 * Create a search that plans one selection at a time; stop() cancels it.
 *
 * @param {MissionStore} store
 */
function createSideSearch(store) {
  /** @type {MissionSelection | null} */
  let running = null;
  /** @type {AbortController | null} */
  let stopping = null;
  /** @type {string | null} */
  let job = null;

  return {
    running: () => running,
    /** @param {MissionSelection} asked */
    begin(asked) {
      stopping = new AbortController();
      running = asked;
      return stopping;
    },
    /** @param {AbortController} own */
    end(own) {
      if (stopping !== own) return;
      stopping = job = running = null;
      store.update({ planningBeside: null });
    },
    stop() {
      stopping?.abort();
      cancelJob(job);
      stopping = job = running = null;
      store.update({ planningBeside: null });
    },
    /** The plan, which is kept among the figures; null once it was stopped. @param {MissionSelection} other @param {AbortController} own */
    async make(other, own) {
      const basis = picks.basisOf(other);
      store.update({ planningBeside: basis });
      const answer = /** @type {Answer<PlanResult | JobLink>} */ (await post("/plans", picks.requestOf(other))); // not aborted: a job whose id is unknown could not be stopped
      const begun = "job" in answer.data && answer.status === 202 ? (answer.data.job ?? null) : null;
      if (own.signal.aborted) {
        cancelJob(begun);
        return null;
      }
      job = begun;
      const made = job ? (await follow(job, { signal: own.signal })).result : answer.data;
      job = null;
      const result = /** @type {PlanResult | null} */ (made && begun ? { ...made, job: begun } : made);
      if (!result || own.signal.aborted) return null;
      store.update({ figures: withResult(store.state.figures, basis, result) });
      return result;
    },
  };
}

/** @typedef {(planned: MissionSelection, result: PlanResult) => MissionSelection | null} NextOf */

/**
 * Plan selections one after the other; each follows from the plan before it.
 *
 * @param {MissionStore} store
 * @param {ReturnType<typeof createSideSearch>} search
 * @param {MissionSelection} first
 * @param {NextOf} nextOf
 */
async function planInTurn(store, search, first, nextOf) {
  const own = search.begin(first);
  try {
    /** @type {MissionSelection | null} */
    let asked = first;
    while (asked) {
      /** @type {PlanResult | null} */
      const result = store.state.figures[picks.basisOf(asked)] ?? (await search.make(asked, own));
      asked = result && !own.signal.aborted ? nextOf(asked, result) : null;
    }
  } finally {
    search.end(own);
  }
}

/**
 * Create the planning by another objective, or by all of them for a comparison. A large selection waits until the plan on the page is
 * saved and no other job of this user runs; it yields to the user's own requests.
 *
 * @param {MissionStore} store
 */
export function createPlanBeside(store) {
  const search = createSideSearch(store);
  /** @type {MissionSelection | null} */
  let wanted = null; // the selection of a large plan, until its second plan begins

  function stop() {
    wanted = null;
    search.stop();
  }

  /** @param {Readonly<MissionPageState>} state */
  function beginWanted({ saving, planning, planIsStored, selection }) {
    if (!wanted || saving || planning || !planIsStored) return;
    const asked = wanted;
    wanted = null;
    if (picks.basisOf(selection) === picks.basisOf(asked)) void start(asked);
  }
  store.listen(["saving", "planning", "planIsStored"], beginWanted);

  /** @param {AbortSignal} signal */
  async function isAlone(signal) {
    const { data } = /** @type {Answer<JobPage>} */ (await get("/jobs?open=true&mine=true&limit=1", { signal }));
    return data.results.length === 0;
  }

  /** @param {MissionSelection} asked */
  async function start(asked) {
    const other = { ...asked, objective: otherObjective(asked.objective) };
    const basis = picks.basisOf(other);
    if (store.state.figures[basis] || store.state.planningBeside === basis) return;
    const own = search.begin(asked);
    try {
      if (asked.targets.length > MAX_PLANNED_AT_ONCE && !(await isAlone(own.signal))) return;
      await search.make(other, own);
    } catch (error) {
      if (!isAbort(error))
        announce(t("The other way of planning has no figures: {reason}", { reason: wordsOf(error) }));
    } finally {
      search.end(own);
    }
  }

  /** Numbers of UAVs are being planned, in this search. */
  const isComparing = () => (store.state.uavNumbers?.planning ?? null) !== null;

  return {
    stop,
    /** @param {MissionSelection} asked */
    want(asked) {
      if (isComparing()) return;
      if (asked.targets.length <= MAX_PLANNED_AT_ONCE) void start(asked);
      else {
        wanted = asked;
        beginWanted(store.state);
      }
    },
    /** Plan one after the other; a refused one stores its reason, and the next follows. @param {MissionSelection} asked */
    async wantAll(asked) {
      stop();
      const own = search.begin(asked);
      try {
        for (const { value } of OBJECTIVES) {
          const other = { ...asked, objective: value };
          const basis = picks.basisOf(other);
          if (own.signal.aborted) return;
          if (store.state.figures[basis] || (value === "energy" && isWithoutCapacity(store.state.plan))) continue;
          try {
            await search.make(other, own);
          } catch (error) {
            if (isAbort(error)) return;
            store.update({ refusedBeside: { ...store.state.refusedBeside, [basis]: wordsOf(error) } });
          }
        }
      } finally {
        search.end(own);
      }
    },
    /** @param {MissionSelection} first @param {NextOf} nextOf */
    wantInTurn(first, nextOf) {
      stop();
      return planInTurn(store, search, first, nextOf);
    },
    /** To a save that the server has to plan for; the large one is made after it. */
    giveWay() {
      const later = search.running();
      if (!later || later.targets.length <= MAX_PLANNED_AT_ONCE) return;
      stop();
      wanted = later;
    },
    /** @param {MissionSelection} selection */
    keepOnlyFor(selection) {
      const { planningBeside } = store.state;
      if (isComparing()) return; // stopped by the comparison itself
      const bases = OBJECTIVES.map(({ value }) => picks.basisOf({ ...selection, objective: value }));
      if (planningBeside && !bases.includes(planningBeside)) stop();
    },
  };
}

/**
 * The comparison of numbers of UAVs: one plan each, from many to one, kept so that a choice shows its plan at once.
 *
 * @param {MissionContext} context
 * @param {ReturnType<typeof createPlanBeside>} aside
 */
export function createUavNumbers({ store, selection, change, wordsOf }, aside) {
  let run = 0; // an answer that comes after its comparison was closed changes nothing

  function close() {
    if (!store.state.uavNumbers) return;
    run += 1;
    if (store.state.uavNumbers.planning !== null) aside.stop();
    store.update({ uavNumbers: null });
  }

  store.listen(["selection"], ({ uavNumbers, selection: now }) => {
    if (uavNumbers && uavNumbers.key !== keyOfNumbers(now, uavNumbers.candidates)) close();
  });

  return {
    async compareUavNumbers() {
      const asked = selection();
      if (!canCompareNumbers(asked, store.state.fleet)) return;
      const own = ++run;
      const first = withCandidates(asked, store.state.fleet);
      /** @param {Partial<NonNullable<typeof store.state.uavNumbers>>} changes */
      function put(changes) {
        const { uavNumbers } = store.state;
        if (uavNumbers && own === run) store.update({ uavNumbers: { ...uavNumbers, ...changes } });
      }
      const key = keyOfNumbers(asked, first.uavs);
      store.update({
        uavNumbers: { key, candidates: first.uavs, rows: [], planning: first.uavs.length, isStopped: false, fault: "" },
      });
      let isWhole = false;
      try {
        await aside.wantInTurn(first, (planned, result) => {
          if (own !== run) return null;
          const row = numberOf(planned, result);
          const next = withFewer(planned, result);
          const rows = store.state.uavNumbers?.rows ?? [];
          isWhole = next === null;
          put({ rows: row ? [row, ...rows] : rows, planning: next?.uavs.length ?? null });
          return next;
        });
        put({ isStopped: !isWhole });
      } catch (error) {
        put(isAbort(error) ? { isStopped: true } : { fault: wordsOf(error) });
      } finally {
        put({ planning: null });
      }
    },
    closeUavNumbers: close,
    /** The plan of this row is shown at once. @param {UavNumber} row */
    useUavNumber: ({ uavs }) => change({ ...selection(), uavs, objective: "makespan" }),
  };
}
