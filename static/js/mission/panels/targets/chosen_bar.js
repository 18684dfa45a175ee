/** Acts on several chosen targets: their task, the stretch between two, removing them. */

import { byId, h, icon } from "../../../dom.js";
import { toggleMenu } from "../../../page/chrome.js";
import { t, tn } from "../../../text.js";
import { targetMenu } from "../../targets/target_menu.js";

/** @import { PlanViews } from "../../targets/target_menu.js" */
/** @import { MissionActions, MissionStore } from "../../types.d.ts" */

/**
 * @param {MissionStore} store
 * @param {MissionActions} actions
 * @param {{ chooseAll: () => void, done: () => void, planViews: PlanViews }} acts
 */
export function mountChosenBar(store, actions, { chooseAll, done, planViews }) {
  const bar = byId("chosen-bar");
  const chosen = () => {
    const keys = new Set(store.state.chosenTargets);
    return store.state.selection.targets.filter((target) => keys.has(target.key));
  };
  const count = h("span", { class: "chosen-count", role: "status" });
  const task = h(
    "button",
    {
      type: "button",
      class: "button",
      "aria-haspopup": "true",
      "aria-expanded": "false",
    },
    icon("list-checks", "small"),
    t("Task, priority, UAV"),
  );
  task.addEventListener("click", () =>
    toggleMenu(task, () => targetMenu(chosen(), actions, { ...store.state, orders: [] }, { planViews })),
  );
  const between = h(
    "button",
    { type: "button", class: "button", onclick: addBetween },
    icon("waypoints", "small"),
    t("Between them"),
  );
  const drop = h(
    "button",
    { type: "button", class: "button", onclick: () => actions.removeTargets(store.state.chosenTargets) },
    icon("trash-2", "small"),
    t("Remove"),
  );
  bar.append(
    count,
    h("button", { type: "button", class: "text-button", onclick: chooseAll }, t("All")),
    h("button", { type: "button", class: "text-button", onclick: done }, t("Done")),
    h("div", { class: "chosen-acts" }, task, between, drop),
  );

  async function addBetween() {
    const [first, last] = chosen();
    if (first.asset === null || last.asset === null) return;
    const found = await actions.stretchBetween(first.asset, last.asset);
    if (found) actions.addSupports(found.supports);
  }

  return {
    /** @param {boolean} isShown */
    refresh(isShown) {
      const targets = chosen();
      bar.hidden = !isShown;
      count.textContent = tn(targets.length, "{count} chosen", "{count} chosen");
      task.disabled = targets.length === 0;
      drop.disabled = targets.length === 0;
      between.hidden = !(
        targets.length === 2 && targets.every((target) => target.kind === "tower" && target.asset !== null)
      );
    },
  };
}
