/** The objective of the plan, each with its figures once planned, and whether UAVs fly back. */

import { byId, find, h } from "../../../dom.js";
import { t } from "../../../text.js";
import { endingsOf, figuresOf, OBJECTIVES } from "../../plan/plan_view.js";
import { basisOf } from "../../selection.js";

/** @import { MissionActions, MissionPageState, MissionStore } from "../../types.d.ts" */

/** @param {MissionStore} store @param {MissionActions} actions @param {boolean} canPlan */
export function mountOptions(store, actions, canPlan) {
  const choices = OBJECTIVES.map(({ value, words, meaning }) => {
    const radio = h("input", {
      type: "radio",
      name: "objective",
      value,
      disabled: !canPlan,
      onchange: () => actions.setOption("objective", value),
    });
    const figures = h("small", {});
    return {
      value,
      radio,
      figures,
      label: h("label", { title: meaning }, radio, h("span", { class: "segment" }, h("span", {}, words), figures)),
    };
  });
  const group = byId("objective");
  group.append(...choices.map((choice) => choice.label));
  const home = byId("objective-before-plan");
  const meaning = h("p", { class: "caption objective-meaning" });
  home.after(meaning);

  const back = byId("return-to-start", HTMLInputElement);
  const ending = find(/** @type {HTMLElement} */ (back.closest("label")), "small");
  back.disabled = !canPlan;
  back.addEventListener("change", () => actions.setOption("return_to_start", back.checked));

  /** Move beside the routes once there are some: the choice is then between two results. @param {MissionPageState} state */
  function settle({ plan }) {
    const place = plan ? byId("objective-of-plan") : home;
    if (group.parentElement !== place) place.append(group);
    meaning.hidden = Boolean(plan);
  }

  store.listen(["plan"], settle);
  store.listen(["selection", "figures", "planningBeside", "plan"], ({ selection, figures, planningBeside }) => {
    for (const choice of choices) {
      choice.radio.checked = selection.objective === choice.value;
      const basis = basisOf({ ...selection, objective: choice.value });
      choice.figures.textContent = figures[basis]
        ? figuresOf(figures[basis])
        : planningBeside === basis
          ? t("planning")
          : "";
    }
    meaning.textContent = OBJECTIVES.find(({ value }) => value === selection.objective)?.meaning ?? "";
    back.checked = selection.return_to_start;
    ending.textContent = endingsOf(selection);
  });
}
