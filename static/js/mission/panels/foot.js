/** The one primary button, which names the next act, and the progress of a long plan. */

import { byId, find } from "../../dom.js";
import { t } from "../../text.js";
import { percentText } from "../../units.js";
import { isSavedOnRequest, lackingOf, nextAct, whyNotApproved, whyNotRehearsed } from "../flying/next_act.js";
import { bestWordsOf } from "../plan/plan_quality.js";

/** @import { NextAct } from "../flying/next_act.js" */
/** @import { MissionActions, MissionPageState, MissionStore, Planning } from "../types.d.ts" */

/** @type {NextAct[]} */
const NEXT = ["plan", "rehearse", "approve"];

/** "51.2 km so far · 40 %"; "waiting" for a job that no planner has taken yet. @param {Planning} planning */
export function howFarWords(planning) {
  if (planning.isQueued) return t("waiting");
  const { best, job, found, what, share } = planning;
  const words = bestWordsOf(best) || (job && found !== what ? found : "");
  return [words, typeof share === "number" ? percentText(share * 100) : ""].filter(Boolean).join(" · ");
}

/**
 * The buttons of a mission that can be planned: the next act is primary and stands first.
 *
 * @param {MissionStore} store
 * @param {MissionActions} actions
 * @param {{ approve: () => unknown, rehearse: () => unknown }} acts
 */
export function mountFoot(store, actions, { approve, rehearse }) {
  if (!document.getElementById("plan")) return;
  byId("plan").addEventListener("click", actions.plan);
  byId("rehearse").addEventListener("click", rehearse);
  byId("approve").addEventListener("click", approve);
  byId("stop").addEventListener("click", actions.stop);
  byId("cancel-planning").addEventListener("click", actions.cancel);
  byId("save").addEventListener("click", () => actions.save());
  store.listen(
    [
      "planning",
      "saving",
      "plan",
      "selection",
      "name",
      "mission",
      "planIsStored",
      "savedBasis",
      "rehearsal",
      "isDispatching",
      "arrival",
    ],
    (state) => {
      drawPlan(state);
      drawLater(state);
      drawSave(state);
      putFirst(nextAct(state));
    },
  );
  store.listen(["planning"], drawJob);
}

/** @param {NextAct} act */
function putFirst(act) {
  const foot = byId("plan").parentElement;
  const focused = document.activeElement;
  for (const name of NEXT) byId(name).classList.toggle("primary", name === act);
  if (foot?.firstElementChild !== byId(act)) {
    foot?.prepend(byId(act));
    if (focused instanceof HTMLElement && foot?.contains(focused)) focused.focus({ preventScroll: true });
  }
  const button = byId(act, HTMLButtonElement);
  byId("why-not-next").textContent = button.disabled ? button.title : "";
}

/** @param {MissionPageState} state */
function drawPlan({ planning, plan, saving, selection, arrival }) {
  const button = byId("plan", HTMLButtonElement);
  const stop = byId("stop", HTMLButtonElement);
  const isBusy = planning !== null;
  const isStopping = Boolean(planning?.isStopping);
  const lacking = arrival === "whole" && !isBusy ? lackingOf(selection) : null;
  find(button, "span").textContent = isBusy ? t("Planning") : plan ? t("Plan again") : t("Plan");
  button.setAttribute("aria-busy", String(isBusy));
  button.disabled = lacking !== null;
  button.title = lacking?.join(" ") ?? "";
  stop.hidden = !isBusy;
  stop.textContent = isStopping ? t("Stopping") : planning?.job ? t("Stop, keep the best") : t("Stop");
  stop.setAttribute("aria-busy", String(isStopping));
  stop.disabled = isStopping;
  byId("cancel-planning").hidden = !planning?.job || isStopping || saving;
}

/** What follows planning. @param {MissionPageState} state */
function drawLater(state) {
  const { rehearsal, plan, planning, isDispatching } = state;
  const rehearse = byId("rehearse", HTMLButtonElement);
  const isFlying = rehearsal.running !== null;
  rehearse.hidden = nextAct(state) === "plan";
  rehearse.title = isFlying ? t("A rehearsal is running.") : whyNotRehearsed(state);
  rehearse.disabled = rehearse.title !== "";
  const approve = byId("approve", HTMLButtonElement);
  approve.hidden = !plan || planning !== null;
  approve.title = whyNotApproved(state);
  approve.disabled = approve.title !== "" || isDispatching;
}

/** @param {MissionPageState} state */
function drawSave(state) {
  const save = byId("save", HTMLButtonElement);
  save.hidden = state.planning !== null || !(isSavedOnRequest(state) || (state.saving && !state.mission));
  save.textContent = state.saving ? t("Saving") : t("Save");
  save.setAttribute("aria-busy", String(state.saving));
  save.title = t("Save (Ctrl+S)");
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
