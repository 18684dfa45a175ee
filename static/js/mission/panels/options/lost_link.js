/** What UAVs do when their link is lost, the rally points where they may land then, and the check of both. */

import { byId, h } from "../../../dom.js";
import { t, tn } from "../../../text.js";
import * as link from "../../options/lost_link.js";
import { faultPlace, showFault } from "./field_fault.js";
import { createLinkCheck } from "./lost_link_check.js";
import { createRallyList } from "./rally_list.js";

/** @import { MissionActions, MissionStore } from "../../types.d.ts" */

/**
 * showPlaces(positions) brings them into view.
 *
 * @param {MissionStore} store
 * @param {MissionActions} actions
 * @param {{ canPlan: boolean, showPlaces: (positions: number[][]) => void }} how
 */
export function mountLostLink(store, actions, { canPlan, showPlaces }) {
  const place = byId("lost-link");
  const check = createLinkCheck(store, showPlaces);
  if (!canPlan) {
    place.append(check);
    return;
  }
  place.append(
    h("h3", { class: "field-label", id: "lost-link-title" }, t("On link loss")),
    ...behaviourChoice(store, actions),
    holdField(store, actions),
    createRallyList(store, actions, showPlaces),
    check,
  );
}

/** @param {MissionStore} store @param {MissionActions} actions */
function behaviourChoice(store, actions) {
  const radios = link.BEHAVIOURS.map(({ value, words, meaning }) => {
    const choose = () => actions.setOption("lost_link", link.withBehaviour(store.state.selection.lost_link, value));
    const radio = h("input", { type: "radio", name: "lost-link", value, onchange: choose });
    return {
      value,
      radio,
      meaning,
      label: h("label", { title: meaning }, radio, h("span", { class: "segment" }, words)),
    };
  });
  const meaning = h("p", { class: "caption" });
  store.listen(["selection"], ({ selection: { lost_link } }) => {
    const { behaviour, rally_points } = link.wholeLostLink(lost_link);
    for (const { value, radio } of radios) radio.checked = value === behaviour;
    const isKept = !link.usesRallyPoints(lost_link) && rally_points.length > 0;
    const kept = tn(
      rally_points.length,
      "Its rally point is kept, and not used.",
      "Its {count} rally points are kept, and not used.",
    );
    const chosen = radios.find(({ value }) => value === behaviour)?.meaning ?? "";
    meaning.textContent = isKept ? `${chosen} ${kept}` : chosen;
  });
  return [
    h(
      "fieldset",
      { class: "segments", "aria-labelledby": "lost-link-title" },
      radios.map(({ label }) => label),
    ),
    meaning,
  ];
}

/** The field of the time that UAVs hold before they return. @param {MissionStore} store @param {MissionActions} actions */
function holdField(store, actions) {
  const fault = faultPlace("lost-link-hold-fault");
  const hold = h("input", {
    class: "input",
    type: "number",
    id: "lost-link-hold",
    min: 0,
    max: link.MAX_HOLD_S,
    step: 1,
    required: true,
    "aria-describedby": fault.id,
  });
  hold.addEventListener("change", () => {
    const isRight = hold.validity.valid && hold.value !== "";
    showFault(hold, fault, isRight ? "" : t("From 0 to {most} s.", { most: link.MAX_HOLD_S }));
    if (isRight) actions.setOption("lost_link", link.withHold(store.state.selection.lost_link, hold.valueAsNumber));
  });
  const element = h(
    "div",
    { class: "field lost-link-hold" },
    h("label", { for: hold.id }, t("Holds for")),
    h("div", { class: "with-unit" }, hold, h("span", { class: "unit" }, "s")),
    fault,
  );
  store.listen(["selection"], ({ selection }) => {
    const { behaviour, hold_s } = link.wholeLostLink(selection.lost_link);
    element.hidden = behaviour !== "hold";
    if (element.hidden || hold.valueAsNumber === hold_s) return;
    hold.value = `${hold_s}`;
    showFault(hold, fault, "");
  });
  return element;
}
