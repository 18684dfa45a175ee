/** Words for the states of missions; of a planned one, told truly: whether its plan reaches all, some or none of its targets. */

import { t } from "../text.js";

/** @type {Record<string, string>} */
export const MISSION_STATES = {
  draft: t("Draft"),
  planned: t("Planned"),
  approved: t("Approved"),
  dispatched: t("Uploaded"),
  active: t("In flight"),
  completed: t("Completed"),
  aborted: t("Aborted"),
  failed: t("Failed"),
};

/** A chip of its own, beside the state: the newest rehearsal of the present plan failed. */
export const REHEARSAL_FAILED = t("Rehearsal failed");

/**
 * The chip of a mission whose state is "planned".
 *
 * @param {number} targets of the mission
 * @param {number} missed of these, how many the plan does not reach
 * @returns {{ className: string, words: string }}
 */
export function plannedChip(targets, missed) {
  if (!missed || !targets) return { className: "chip planned", words: t("Planned") };
  if (missed >= targets) return { className: "chip failed", words: t("Not possible") };
  const words = t("Partly planned, {reached} of {targets}", { reached: targets - missed, targets });
  return { className: "chip aborted", words };
}
