/** Acts on a report: close the mission, plan a follow-up with the missed targets, download. */

import { post } from "../api.js";
import { byId } from "../dom.js";
import { askToClose, canBeClosed } from "../page/close_mission.js";
import { isOver, wasFlown } from "../record/sentence.js";
import { t } from "../text.js";

/** @import { Answer, ApiError } from "../api.js" */
/** @import { Mission, MissionRecord } from "../api_types.d.ts" */

/** @type {string | null} */
let key = null; // of the request: the same until it is answered, so that there is one draft

/**
 * Shown where targets were missed and the reader may plan.
 *
 * @param {MissionRecord} record
 * @param {{ canPlan: boolean }} reader
 */
export function offerFollowUp(record, { canPlan }) {
  const button = byId("report-follow-up", HTMLButtonElement);
  const { all, inspected, "not-confirmed": unsure } = record.summary.results;
  button.hidden = !canPlan || !isOver(record) || inspected + unsure === all;
  button.onclick = () => ask(button, record.mission.id);
}

/** @param {MissionRecord} record @param {{ canFly: boolean }} reader */
export function offerClosing(record, { canFly }) {
  const button = byId("report-close", HTMLButtonElement);
  button.hidden = !canFly || !canBeClosed(record);
  button.onclick = () => askToClose({ mission: record.mission.id, opener: button });
}

/** Only what there is. @param {MissionRecord} record */
export function offerDownloads(record) {
  byId("report-results-files").hidden = record.mission.approval === null;
  for (const link of byId("report-raw-files").querySelectorAll("a"))
    link.hidden = link.id === "report-zip" ? record.mission.approval === null : !wasFlown(record);
  byId("report-raw-files").hidden = record.mission.approval === null && !wasFlown(record);
  byId("report-foot").hidden = byId("report-results-files").hidden && byId("report-raw-files").hidden;
}

/** @param {HTMLButtonElement} button @param {string} mission */
async function ask(button, mission) {
  key ??= crypto.randomUUID?.() ?? `${Date.now()}-${Math.random()}`;
  const summary = byId("report-follow-up-said");
  button.disabled = true;
  summary.textContent = "";
  try {
    const { data } = /** @type {Answer<Mission>} */ (
      await post(`/missions/${mission}/follow-up`, {}, { headers: { "Idempotency-Key": key } })
    );
    location.href = `/missions/${data.id}`;
  } catch (error) {
    const { status, message } = /** @type {ApiError} */ (error);
    if (status) key = null;
    summary.textContent = `${t("No follow-up was made.")} ${message}`;
    button.disabled = false;
  }
}
