/** A command to a UAV, sent once; a start that is refused for its slot is asked for once more. */

import { ApiError, freshKey, post } from "../api.js";
import { outOfSlotQuestion } from "../domain/command_questions.js";
import { confirmAct } from "./confirm.js";

/** @import { CommandKind } from "../api_types.d.ts" */

/**
 * Whether it is being told; not where somebody rather waits. Rejects with ApiError.
 *
 * @param {number | null} uav
 * @param {string} name
 * @param {CommandKind} kind
 * @param {Record<string, any>} filled what was filled in
 */
export async function tellUav(uav, name, kind, { why = "", ...parameters } = {}) {
  /** @param {Record<string, any>} more */
  const tell = (more) =>
    post(
      `/uavs/${uav}/commands`,
      { kind, why, parameters: { ...parameters, ...more } },
      { headers: { "Idempotency-Key": freshKey() } },
    );
  try {
    await tell({});
  } catch (error) {
    if (!(error instanceof ApiError) || error.code !== "start_slot") throw error;
    if (!(await confirmAct(outOfSlotQuestion(name, error.message)))) return false;
    await tell({ out_of_slot: true });
  }
  return true;
}
