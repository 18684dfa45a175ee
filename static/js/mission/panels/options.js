/** What the plan is to be best at, with the figures of each where they are known, and whether UAVs fly back. */

import { byId, h } from "../../dom.js";
import { endingsOf, figuresOf, OBJECTIVES } from "../plan_view.js";
import { basisOf } from "../selection.js";

export function mountOptions(store, actions, canPlan) {
  const choices = OBJECTIVES.map(({ value, words }) => {
    const radio = h("input", { type: "radio", name: "objective", value, disabled: !canPlan, onchange: () => actions.setOption("objective", value) });
    const figures = h("small", {});
    return { value, radio, figures, label: h("label", {}, radio, h("span", { class: "segment" }, h("span", {}, words), figures)) };
  });
  byId("objective").append(...choices.map((choice) => choice.label));
  const meaning = h("p", { class: "caption objective-meaning" });
  byId("objective").after(meaning);

  const back = byId("return-to-start");
  const ending = back.closest("label").querySelector("small");
  back.disabled = !canPlan;
  back.addEventListener("change", () => actions.setOption("return_to_start", back.checked));

  store.listen(["selection", "figures"], ({ selection, figures }) => {
    for (const choice of choices) {
      choice.radio.checked = selection.objective === choice.value;
      const known = figures[basisOf({ ...selection, objective: choice.value })];
      choice.figures.textContent = known ? figuresOf(known) : "";
    }
    meaning.textContent = OBJECTIVES.find(({ value }) => value === selection.objective)?.meaning ?? "";
    back.checked = selection.return_to_start;
    ending.textContent = endingsOf(selection);
  });
}
