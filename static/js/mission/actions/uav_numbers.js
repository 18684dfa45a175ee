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
  const none = { uavNumbers: null };

  function close() {
    if (!store.state.uavNumbers) return;
    if (store.state.uavNumbers.planning !== null) aside.stop();
    store.update(none);
  }

  store.listen(["selection"], ({ uavNumbers, selection: now }) => {
    if (uavNumbers && uavNumbers.key !== keyOfNumbers(now)) close();
  });

  /** @param {Partial<NonNullable<typeof store.state.uavNumbers>>} changes */
  function put(changes) {
    const { uavNumbers } = store.state;
    if (uavNumbers) store.update({ uavNumbers: { ...uavNumbers, ...changes } });
  }

  return {
    async compareUavNumbers() {
      const asked = selection();
      if (!canCompareNumbers(asked, store.state.fleet)) return;
      const key = keyOfNumbers(asked);
      const first = withCandidates(asked, store.state.fleet);
      store.update({
        uavNumbers: { key, candidates: first.uavs.length, rows: [], planning: first.uavs.length, fault: "" },
      });
      try {
        await aside.wantInTurn(first, (planned, result) => {
          const row = numberOf(planned, result);
          const rows = store.state.uavNumbers?.rows ?? [];
          const next = withFewer(planned, result);
          put({ rows: row ? [row, ...rows] : rows, planning: next?.uavs.length ?? null });
          return next;
        });
      } catch (error) {
        if (!isAbort(error)) put({ fault: wordsOf(error) });
      } finally {
        put({ planning: null });
      }
    },
    closeUavNumbers: close,
    /** The plan of this row is shown at once. @param {UavNumber} row */
    useUavNumber: ({ uavs }) => change({ ...selection(), uavs, objective: "makespan" }),
  };
}
