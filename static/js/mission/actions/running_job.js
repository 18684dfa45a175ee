/**
 * The large plan that is being made, remembered over a reload of the page: in this tab alone, for each user and
 * mission.
 */

/** @import { MissionSelection } from "../types.d.ts" */

/** @typedef {{ job: string, selection: MissionSelection }} RunningJob */

/** @param {number} user @param {string | null} mission */
const keyOf = (user, mission) => `spanwise.planning.${user}.${mission ?? "new"}`;

/** @param {{ user: number, storage?: () => Storage }} options */
export function createRunningJob({ user, storage = () => globalThis.sessionStorage }) {
  let isLeaving = false; // a failure because the page closes does not end the job
  globalThis.addEventListener?.("pagehide", () => {
    isLeaving = true;
  });
  globalThis.addEventListener?.("pageshow", () => {
    isLeaving = false;
  });

  return {
    /**
     * { job, selection } of the request; null where no job runs.
     *
     * @param {string | null} mission
     * @returns {RunningJob | null}
     */
    read(mission) {
      try {
        const kept = JSON.parse(storage().getItem(keyOf(user, mission)) ?? "null");
        return typeof kept?.job === "string" &&
          Array.isArray(kept.selection?.targets) &&
          Array.isArray(kept.selection.uavs)
          ? kept
          : null;
      } catch {
        return null;
      }
    },
    /** @param {string | null} mission @param {RunningJob} running */
    keep(mission, running) {
      try {
        storage().setItem(keyOf(user, mission), JSON.stringify(running));
      } catch {
        /* after a reload the progress is not shown; the plan is made anyway */
      }
    },
    /** @param {string | null} mission */
    drop(mission) {
      if (isLeaving) return;
      try {
        storage().removeItem(keyOf(user, mission));
      } catch {
        /* not stored */
      }
    },
  };
}
