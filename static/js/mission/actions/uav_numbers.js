/** The comparison of numbers of UAVs: one plan each, from many to one, kept so that a choice shows its plan at once. */

import { isAbort } from "../../api.js";
import { canCompareNumbers, keyOfNumbers, numberOf, withCandidates, withFewer } from "../uavs/uav_numbers.js";

/** @import { MissionContext, UavNumber } from "../types.d.ts" */
/** @import { PlanBeside } from "./planning.js" */

/**
 * @param {MissionContext} context
 * @param {PlanBeside} aside
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
