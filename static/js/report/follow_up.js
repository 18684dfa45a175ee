/** "Plan a follow-up": a draft with the targets that were missed. */

import { post } from "../api.js";
import { byId } from "../dom.js";
import { isOver } from "../record/sentence.js";
import { t } from "../text.js";

/** @import { Answer, ApiError } from "../api.js" */
/** @import { Mission, MissionRecord } from "../api_types.d.ts" */

/** @type {string | null} */
let key = null; // of the asking: the same until it is answered, so that there is one draft

/**
 * Shown where targets were missed and the reader may plan.
 *
 * @param {MissionRecord} record
 * @param {{ canPlan: boolean }} reader
 */
export function offerFollowUp(record, { canPlan }) {
  const button = byId("report-follow-up", HTMLButtonElement);
  button.hidden = !canPlan || !isOver(record);
  button.onclick = () => ask(button, record.mission.id);
}

/** @param {HTMLButtonElement} button @param {string} mission */
async function ask(button, mission) {
  key ??= crypto.randomUUID?.() ?? `${Date.now()}-${Math.random()}`;
  const said = byId("report-follow-up-said");
  button.disabled = true;
  said.textContent = "";
  try {
    const { data } = /** @type {Answer<Mission>} */ (
      await post(`/missions/${mission}/follow-up`, {}, { headers: { "Idempotency-Key": key } })
    );
    location.href = `/missions/${data.id}`;
  } catch (error) {
    const { status, message } = /** @type {ApiError} */ (error);
    if (status) key = null;
    said.textContent = `${t("No follow-up was made.")} ${message}`;
    button.disabled = false;
  }
}
