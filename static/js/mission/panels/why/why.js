/** Beside the strips: why a UAV flies its route, why a target is not reached, what differs from the last plan, the ways to plan it, or a
 * route that is changed by hand. */

import { post } from "../../../api.js";
import { byId, h, icon } from "../../../dom.js";
import { routeLetter, routeNumber } from "../../../domain/palette.js";
import { t } from "../../../text.js";
import { isPlanCurrent, lastPlanOf } from "../../plan_view.js";
import { takesShortestWays } from "../../plan_words.js";
import { requestOf } from "../../selection.js";
import { alternatives } from "./alternatives.js";
import { createByHand } from "./by_hand.js";
import { comparison } from "./compared.js";
import { routeExplanation } from "./route.js";
import { targetExplanation } from "./target.js";

/** What the server is asked: the plan as it was made, whatever has been picked since. */
function questionOf({ result, targets, uavs, charging_w }) {
  const { objective, return_to_start, departs_at, conditions } = result;
  return requestOf({ targets, uavs, objective, return_to_start, departs_at, conditions, charging_w });
}

export function mountWhy(store, actions, { canPlan }) {
  const panel = byId("why");
  const answers = new WeakMap(); // result of a plan → Map of question → promise
  const byHand = createByHand(store, actions);
  let opener = null;
  let openedFrom = ""; // the row of it: rows are drawn anew
  let shown = null; // the question that was drawn last

  function ask(plan, path, more) {
    if (!answers.has(plan.result)) answers.set(plan.result, new Map());
    const known = answers.get(plan.result);
    const key = JSON.stringify([path, more]);
    if (!known.has(key)) {
      const asked = post(path, { ...questionOf(plan), ...more }).then(({ data }) => data);
      asked.catch(() => known.delete(key));
      known.set(key, asked);
    }
    return known.get(key);
  }

  function put(title, ...content) {
    byId("why-title").textContent = title;
    byId("why-body").replaceChildren(...content);
  }

  async function answer(title, asked, show) {
    put(
      title,
      h(
        "div",
        { class: "stack", role: "status", "aria-label": t("Being worked out") },
        [1, 2, 3].map(() => h("div", { class: "skeleton" })),
      ),
    );
    const { why } = store.state;
    try {
      const said = await asked;
      if (store.state.why !== why) return;
      put(title, ...show(said));
      store.update({ litZones: (said.zones ?? []).map(({ id }) => id) });
    } catch (error) {
      if (store.state.why === why)
        put(
          title,
          h("p", { role: "alert" }, error.message),
          h("button", { type: "button", class: "button", onclick: () => draw(store.state) }, t("Ask again")),
        );
    }
  }

  function draw(state) {
    const { why, plan } = state;
    const wasHidden = panel.hidden;
    if (store.state.litZones.length) store.update({ litZones: [] });
    panel.hidden = !why || !plan;
    byId("dock").classList.toggle("with-why", !panel.hidden);
    if (panel.hidden) {
      shown = null;
      if (!wasHidden) giveBack();
      return;
    }
    if (why !== shown) {
      opener = document.activeElement;
      openedFrom = opener?.closest(".route")?.dataset.sequence ?? "";
    }
    byId("dock").classList.toggle("with-ways", Boolean(why.alternatives));
    if (why.byHand !== undefined) {
      if (why !== shown)
        put(t("Change the route of {name} by hand", { name: plan.result.routes[why.byHand].uav }), byHand.element);
    } else if (why.alternatives) {
      const focused =
        panel.contains(document.activeElement) && document.activeElement !== byId("why-title")
          ? document.activeElement.textContent
          : null;
      put(t("Ways to plan it"), ...alternatives(state, actions, canPlan && isPlanCurrent(state)));
      if (focused)
        (
          [...panel.querySelectorAll("button")].find(({ textContent }) => textContent === focused) ?? byId("why-title")
        ).focus();
    } else if (why.compare) {
      const last = lastPlanOf(state);
      if (last) put(t("Against the last plan"), ...comparison(plan, last));
      else store.update({ why: null });
    } else if (why.target) {
      const index = plan.targets.findIndex(({ key }) => key === why.target);
      const entry = plan.result.unassigned.find(({ target }) => target === index);
      if (!entry) store.update({ why: null });
      else
        answer(
          t("Why {target} is not reached", { target: plan.targets[index].label }),
          ask(plan, "/plans/why-target", { target: index }),
          (said) => targetExplanation(said, { plan, entry, store, actions, canPlan: canPlan && isPlanCurrent(state) }),
        );
    } else {
      const route = plan.result.routes[why.route];
      if (!route?.geometry) store.update({ why: null });
      else
        answer(
          t("Why {name} flies this way", { name: route.uav }),
          ask(plan, "/plans/why-route", {
            uav: why.route,
            routes: plan.result.routes.map(({ targets }) => targets),
            shortest_ways: takesShortestWays(plan.result),
          }),
          (said) => routeExplanation(said, { plan, store, actions, canPlan: canPlan && isPlanCurrent(state) }),
        );
    }
    const sequence = why.route ?? why.byHand;
    panel.className = sequence === undefined ? "why" : `why route-${routeNumber(sequence)}`;
    byId("why-letter").hidden = sequence === undefined;
    byId("why-letter").textContent = sequence === undefined ? "" : routeLetter(sequence);
    if (why !== shown || document.activeElement === document.body) byId("why-title").focus(); // on a phone it comes into sight so
    shown = why;
  }

  /** Focus goes back to what opened it; a row may have been drawn anew. */
  function giveBack() {
    const row = document.querySelector(`.route[data-sequence="${openedFrom}"] .why-button`);
    if (opener?.isConnected) opener.focus();
    else if (row) row.focus();
    else if (!document.activeElement || document.activeElement === document.body) byId("compare-plans").focus();
    opener = null;
  }

  byId("close-why").append(icon("x"));
  byId("close-why").addEventListener("click", () => store.update({ why: null }));
  panel.addEventListener("keydown", (event) => {
    if (event.key !== "Escape") return;
    event.stopPropagation();
    store.update({ why: null });
  });
  store.listen(["why", "plan", "lastPlan"], draw);
  store.listen(
    ["figures", "planningBeside", "refusedBeside", "selection"],
    (state) => state.why?.alternatives && draw(state),
  );
}
