/** One command to a UAV, sent once; a start that is refused for its slot is confirmed once more. */

import { ApiError, freshKey, post } from "../api.js";
import { outOfSlotQuestion } from "../domain/command_questions.js";
import { confirmAct } from "./confirm.js";

/** @import { CommandKind } from "../api_types.d.ts" */

const ANSWER_WITHIN_MS = 30_000; // timeout for a frozen connection

/**
 * Send a command. Resolves to whether it was sent; false where the user prefers to wait. Rejects with ApiError.
 *
 * @param {number | null} uav
 * @param {string} name
 * @param {CommandKind} kind
 * @param {Record<string, any>} filled what was filled in
 * @param {{ key?: string, within_ms?: number }} [how] key: idempotency key of the command; within_ms: timeout of the answer
 */
export async function commandUav(
  uav,
  name,
  kind,
  { why = "", ...parameters } = {},
  { key = freshKey(), within_ms = ANSWER_WITHIN_MS } = {},
) {
  /** @param {Record<string, any>} more @param {string} own key */
  const notify = (more, own) =>
    post(
      `/uavs/${uav}/commands`,
      { kind, why, parameters: { ...parameters, ...more } },
      { headers: { "Idempotency-Key": own }, signal: AbortSignal.timeout(within_ms) },
    );
  try {
    await notify({}, key);
  } catch (error) {
    if (!(error instanceof ApiError) || error.code !== "start_slot") throw error;
    if (!(await confirmAct(outOfSlotQuestion(name, error.message)))) return false;
    await notify({ out_of_slot: true }, freshKey());
  }
  return true;
}
