/** Notice on UAVs of the mission that have changed since it was planned, with a button that takes their present figures. */

import { h, icon } from "../../../dom.js";
import { t, tn } from "../../../text.js";
import { isPlanCurrent } from "../../plan/plan_view.js";
import { changeWords, openChanges } from "../../uavs/uav_changes.js";

/** @import { MissionActions, MissionPageState } from "../../types.d.ts" */

/** @typedef {Pick<MissionPageState, "mission" | "selection" | "plan" | "planIsStored">} State */

const CHANGEABLE = ["draft", "planned"];
const MAX_SHOWN = 4;

/**
 * Changes that concern the present page: figures that are still the old ones, and states that its plan does not contain.
 *
 * @param {State} state
 */
export function shownChanges({ mission, selection, plan, planIsStored }) {
  if (!mission) return [];
  const isOfPlan = planIsStored && isPlanCurrent({ plan, selection });
  return openChanges(selection, mission.uav_changes)
    .map((change) => (isOfPlan ? change : { ...change, state: null }))
    .filter(({ figures, state, said }) => figures.length > 0 || state !== null || said.length > 0);
}

/** The notice on changes of UAVs; null without changes. @param {State} state @param {MissionActions} actions @param {boolean} canPlan */
export function uavNotice(state, actions, canPlan) {
  const changes = shownChanges(state);
  if (!state.mission || !changes.length) return null;
  const mayChange = canPlan && CHANGEABLE.includes(state.mission.state);
  const hasFigures = changes.some(({ figures }) => figures.length > 0);
  const isOfFleetAlone = !hasFigures && changes.every((change) => change.state === null);
  const acts = [];
  if (hasFigures) acts.push({ label: t("Use the present figures"), act: actions.takePresentFigures });
  else if (!isOfFleetAlone) acts.push({ label: t("Plan again"), act: actions.plan });
  if (changes.some(({ said }) => said.length > 0))
    acts.push({ label: t("Use the fleet's instead of this mission's own"), act: actions.takeFleetFigures });
  const headline = isOfFleetAlone
    ? t("The fleet's figures changed since this mission was given its own.")
    : isPlanCurrent(state)
      ? tn(changes.length, "A UAV changed since this was planned.", "{count} UAVs changed since this was planned.")
      : tn(
          changes.length,
          "A UAV changed since this mission was made.",
          "{count} UAVs changed since this mission was made.",
        );
  const more = changes.length - MAX_SHOWN;
  return h(
    "div",
    { class: "notice warning" },
    icon("triangle-alert"),
    h(
      "div",
      {},
      h("p", {}, h("strong", {}, headline)),
      h(
        "ul",
        { class: "causes" },
        changes.slice(0, MAX_SHOWN).map((change) => h("li", {}, changeWords(change))),
      ),
      more > 0 && h("p", { class: "caption" }, tn(more, "{count} more UAV", "{count} more UAVs")),
      mayChange &&
        h(
          "p",
          {},
          acts.map(({ label, act }) => h("button", { type: "button", class: "text-button", onclick: act }, label)),
        ),
    ),
  );
}
