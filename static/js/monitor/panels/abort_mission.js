/** "Abort the mission" on the page of a mission in progress. */

import { ApiError, freshKey, post } from "../../api.js";
import { abortQuestion } from "../../domain/command_questions.js";
import { canBeAborted } from "../../domain/flying.js";
import { confirmAct } from "../../page/confirm.js";
import { CHECKING_HOME, returnsNow } from "../../page/present_returns.js";
import { toast } from "../../page/toast.js";
import { t } from "../../text.js";
import { batchScopes } from "../commands/batch.js";
import { commandBatch } from "../commands/batch_commanding.js";

/** @import { LiveMission } from "../../api_types.d.ts" */
/** @import { MonitorPage, MonitorState, MonitorStore } from "../types.d.ts" */

/** @param {MonitorStore} store @param {MonitorPage} page */
export function mountAbortMission(store, page) {
  const button = document.getElementById("abort-mission");
  if (!(button instanceof HTMLButtonElement)) return;
  /** @param {Pick<MonitorState, "missions">} state */
  const own = ({ missions }) => missions.find(({ id }) => id === page.mission);
  button.addEventListener("click", () => {
    const mission = own(store.state);
    if (mission) void abort(mission, button, store);
  });
  store.listen(["missions"], (state) => {
    const mission = own(state);
    button.hidden = !mission || !canBeAborted(mission);
  });
}

/** @param {LiveMission} mission @param {HTMLElement} opener @param {MonitorStore} store */
async function abort(mission, opener, store) {
  const { id, name, state } = mission;
  const reported = { name, isActive: state === "active" };
  const flyers = store.state.uavs.filter(({ mission }) => mission === id);
  const first = abortQuestion({ ...reported, uavs: flyers.map((flyer) => ({ name: flyer.name, check: null })) });
  const later = returnsNow(flyers.map((flyer) => flyer.id)).then((returns) =>
    abortQuestion({ ...reported, uavs: flyers.map((flyer) => ({ name: flyer.name, check: returns.get(flyer.id) })) }),
  );
  const asked = await confirmAct({ ...first, lines: [...first.lines.slice(0, 2), CHECKING_HOME], later, opener });
  if (!asked) return;
  if (asked.safer) {
    const scopes = batchScopes(flyers, [mission]);
    if (scopes.length) await commandBatch(store, "return", scopes, asked.safer.parameters.ways);
    return;
  }
  try {
    // another user's change in the meantime does not delay a stop
    const headers = { "If-Match": "*", "Idempotency-Key": freshKey() };
    await post(`/missions/${id}/abort`, { why: asked.why }, { headers });
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    toast(`${t("Not aborted.")} ${error.message}`);
  }
}
