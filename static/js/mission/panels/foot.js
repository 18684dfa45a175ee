/** The one primary button, saving, and the progress of a long plan. */

import { byId, find } from "../../dom.js";
import { t } from "../../text.js";
import { percentText } from "../../units.js";
import { bestWordsOf } from "../plan_quality.js";
import { isUnsaved } from "../plan_view.js";

/** @import { MissionActions, MissionPageState, MissionStore, Planning } from "../types.d.ts" */

/** "51.2 km so far · 40 %"; "waiting" for a job that no planner has taken yet. @param {Planning} planning */
export function howFarWords(planning) {
  if (planning.isQueued) return t("waiting");
  const { best, job, found, what, share } = planning;
  const words = bestWordsOf(best) || (job && found !== what ? found : "");
  return [words, typeof share === "number" ? percentText(share * 100) : ""].filter(Boolean).join(" · ");
}

/** @param {MissionStore} store @param {MissionActions} actions */
export function mountFoot(store, actions) {
  if (!document.getElementById("plan")) return;
  byId("plan").addEventListener("click", actions.plan);
  byId("stop").addEventListener("click", actions.stop);
  byId("cancel-planning").addEventListener("click", actions.cancel);
  byId("save").addEventListener("click", () => actions.save());
  store.listen(
    ["planning", "saving", "plan", "selection", "name", "mission", "planIsStored", "savedBasis"],
    (state) => {
      drawPlan(state);
      drawSave(state);
    },
  );
  store.listen(["planning"], drawJob);
}

/** @param {MissionPageState} state */
function drawPlan({ planning, plan, saving }) {
  const button = byId("plan");
  const stop = byId("stop", HTMLButtonElement);
  const isBusy = planning !== null;
  const isStopping = Boolean(planning?.isStopping);
  find(button, "span").textContent = isBusy ? t("Planning") : plan ? t("Plan again") : t("Plan");
  button.setAttribute("aria-busy", String(isBusy));
  stop.hidden = !isBusy;
  stop.textContent = isStopping ? t("Stopping") : planning?.job ? t("Stop, keep the best") : t("Stop");
  stop.setAttribute("aria-busy", String(isStopping));
  stop.disabled = isStopping;
  byId("cancel-planning").hidden = !planning?.job || isStopping || saving;
}

/** @param {MissionPageState} state */
function drawSave(state) {
  const save = byId("save", HTMLButtonElement);
  const nothing = !isUnsaved(state);
  save.hidden = state.planning !== null;
  save.textContent = state.saving ? t("Saving") : t("Save");
  save.setAttribute("aria-busy", String(state.saving));
  save.disabled = nothing && !state.mission; // a stored mission answers that it is saved
  save.title = nothing ? (state.mission ? t("Everything is saved") : t("Nothing to save yet")) : t("Save (Ctrl+S)");
}

/** Show the progress of a long plan. @param {MissionPageState} state */
function drawJob({ planning }) {
  byId("job").hidden = planning === null;
  if (!planning) return;
  const { share } = planning;
  byId("job-what").textContent = planning.what;
  byId("job-how-far").textContent = howFarWords(planning);
  const bar = byId("job-progress");
  const isKnown = typeof share === "number";
  if (isKnown) bar.setAttribute("aria-valuenow", String(Math.round(share * 100)));
  else bar.removeAttribute("aria-valuenow");
  /** @type {HTMLElement} */ (bar.firstElementChild).style.width = isKnown ? `${share * 100}%` : "12%";
}
