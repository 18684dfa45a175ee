/** "Plan a follow-up": a draft with the targets that were missed. */

import { post } from "../api.js";
import { byId } from "../dom.js";
import { isOver } from "../record/sentence.js";
import { t } from "../text.js";

let key = null; // of the asking: the same until it is answered, so that there is one draft

/** Shown where targets were missed and the reader may plan. */
export function offerFollowUp(record, { canPlan }) {
  const button = byId("report-follow-up");
  button.hidden = !canPlan || !isOver(record);
  button.onclick = () => ask(button, record.mission.id);
}

async function ask(button, mission) {
  key ??= crypto.randomUUID?.() ?? `${Date.now()}-${Math.random()}`;
  const said = byId("report-follow-up-said");
  button.disabled = true;
  said.textContent = "";
  try {
    const { data } = await post(`/missions/${mission}/follow-up`, {}, { headers: { "Idempotency-Key": key } });
    location.href = `/missions/${data.id}`;
  } catch (error) {
    if (error.status) key = null;
    said.textContent = `${t("No follow-up was made.")} ${error.message}`;
    button.disabled = false;
  }
}
