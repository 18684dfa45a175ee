/** The button beside Plan and Save that approves a planned and saved mission. */

import { byId } from "../../dom.js";
import { t } from "../../text.js";
import { isPlanCurrent, isUnsaved } from "../plan_view.js";

/** @import { createFlying } from "../flying/flying_actions.js" */
/** @import { MissionPageState, MissionStore } from "../types.d.ts" */

/** @typedef {ReturnType<typeof createFlying>} Flying */

/** Why the plan on the page cannot be approved; empty where it can. @param {MissionPageState} state */
export function whyNotApproved(state) {
  if (!isPlanCurrent(state)) return t("It has changed since it was planned. Plan again first.");
  if (!state.plan?.result.routes.some((route) => route.geometry))
    return t("The plan reaches no target: there is nothing to approve.");
  if (!state.mission || isUnsaved(state) || !state.planIsStored || state.saving) return t("It is not saved yet.");
  return "";
}

/** @param {MissionStore} store @param {Flying} flying */
export function mountApprove(store, flying) {
  const button = byId("approve", HTMLButtonElement);
  button.addEventListener("click", () => void flying.approve());
  store.listen(
    ["mission", "plan", "planIsStored", "selection", "name", "savedBasis", "saving", "planning", "isDispatching"],
    (state) => {
      button.hidden = !state.plan || state.planning !== null;
      const reason = whyNotApproved(state);
      button.disabled = Boolean(reason) || state.isDispatching;
      button.title = reason;
    },
  );
}
