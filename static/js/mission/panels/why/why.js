/**
 * The panel beside the strips: why a UAV flies its route, why a target is not reached, what differs from the last plan, other objectives,
 * or a manually edited route.
 */

import { post } from "../../../api.js";
import { byId, h, icon, setChildren } from "../../../dom.js";
import { routeLetter, routeNumber } from "../../../domain/palette.js";
import { t } from "../../../text.js";
import { isPlanCurrent, lastPlanOf } from "../../plan/plan_view.js";
import { requestOf } from "../../selection.js";
import { alternatives } from "./alternatives.js";
import { createManualEdit } from "./by_hand.js";
import { comparison } from "./compared.js";
import { routeExplanation } from "./route.js";
import { targetExplanation } from "./target.js";

/** @import { Plan, RouteExplanation, TargetExplanation } from "../../../api_types.d.ts" */
/** @import { Child } from "../../../dom.js" */
/** @import { MissionActions, MissionPageState, MissionStore, PlanResult, ShownPlan, Why } from "../../types.d.ts" */

/** Whether a plan takes shorter paths than the preferred ones. @param {Pick<Plan, "warnings">} plan */
const takesShortestWays = ({ warnings }) => (warnings ?? []).some(({ code }) => code === "shortest_ways");

/** The server's input: the plan as it was made, regardless of later changes to the selection. @param {ShownPlan} plan */
function questionOf({ result, targets, uavs, charging_w }) {
  const { objective, return_to_start, departs_at, conditions } = result;
  return requestOf({
    targets,
    uavs,
    objective,
    return_to_start,
    departs_at,
    conditions,
    charging_w,
    lost_link: null,
    locks: [],
  });
}

/** Create a cache that requests each explanation of a plan once. */
function createQuestions() {
  /** @type {WeakMap<PlanResult, Map<string, Promise<unknown>>>} */
  const answers = new WeakMap();

  /** @param {ShownPlan} plan @param {string} path @param {Record<string, unknown>} more */
  return (plan, path, more) => {
    const known = answers.get(plan.result) ?? new Map();
    answers.set(plan.result, known);
    const key = JSON.stringify([path, more]);
    const asked = known.get(key) ?? post(path, { ...questionOf(plan), ...more }).then(({ data }) => data);
    if (!known.has(key)) {
      asked.catch(() => known.delete(key));
      known.set(key, asked);
    }
    return asked;
  };
}

/** Return the focus to the control that opened the panel; its row may have been redrawn. */
function createOpener() {
  /** @type {Element | null} */
  let opener = null;
  let row = "";
  return {
    remember() {
      opener = document.activeElement;
      row = /** @type {HTMLElement | null | undefined} */ (opener?.closest(".route"))?.dataset.sequence ?? "";
    },
    focus() {
      /** @type {HTMLElement | null} */
      const again = document.querySelector(`.route[data-sequence="${row}"] .why-button`);
      if (opener instanceof HTMLElement && opener.isConnected) opener.focus();
      else if (again) again.focus();
      else if (!document.activeElement || document.activeElement === document.body) byId("compare-plans").focus();
      opener = null;
    },
  };
}

/** @param {string} title @param {...Child} content */
function put(title, ...content) {
  byId("why-title").textContent = title;
  setChildren(byId("why-body"), ...content);
}

/**
 * The letter and colour of the route that it is about.
 *
 * @param {HTMLElement} panel
 * @param {number | undefined} sequence
 */
function markRoute(panel, sequence) {
  panel.className = sequence === undefined ? "why" : `why route-${routeNumber(sequence)}`;
  byId("why-letter").hidden = sequence === undefined;
  byId("why-letter").textContent = sequence === undefined ? "" : routeLetter(sequence);
}

class WhyPanel {
  #panel = byId("why");
  #title = byId("why-title");
  #opener = createOpener();
  #ask = createQuestions();
  /** @type {Why | null} */
  #shown = null; // the question that was drawn last
  #store;
  #actions;
  #canPlan;
  #manualEdit;

  /** @param {MissionStore} store @param {MissionActions} actions @param {boolean} canPlan */
  constructor(store, actions, canPlan) {
    this.#store = store;
    this.#actions = actions;
    this.#canPlan = canPlan;
    this.#manualEdit = createManualEdit(store, actions);
  }

  close() {
    this.#store.update({ why: null });
  }

  /** @param {MissionPageState} state */
  draw(state) {
    const { why, plan } = state;
    const panel = this.#panel;
    const wasHidden = panel.hidden;
    if (this.#store.state.litZones.length) this.#store.update({ litZones: [] });
    panel.hidden = !why || !plan;
    byId("dock").classList.toggle("with-why", !panel.hidden);
    if (!why || !plan) {
      this.#shown = null;
      if (!wasHidden) this.#opener.focus();
      return;
    }
    if (why !== this.#shown) this.#opener.remember();
    byId("dock").classList.toggle("with-hand", why.manualEdit !== undefined);
    this.#explain(state, plan, why);
    markRoute(panel, why.route ?? why.manualEdit);
    if (why !== this.#shown || document.activeElement === document.body) this.#title.focus(); // on a phone it comes into sight so
    this.#shown = why;
  }

  /** Show the requested explanation. @param {MissionPageState} state @param {ShownPlan} plan @param {Why} why */
  #explain(state, plan, why) {
    const mayChange = this.#canPlan && isPlanCurrent(state);
    if (why.manualEdit !== undefined) {
      const { uav: name } = plan.result.routes[why.manualEdit];
      if (why !== this.#shown) put(t("Change the route of {name} by hand", { name }), this.#manualEdit.element);
    } else if (why.alternatives) this.#putAlternatives(state, mayChange);
    else if (why.compare) {
      const last = lastPlanOf(state);
      if (last) put(t("Against the last plan"), ...comparison(plan, last));
      else this.close();
    } else if (why.target) this.#explainTarget(plan, why.target, mayChange);
    else this.#explainRoute(plan, why.route, mayChange);
  }

  /** The ways to plan it, with the focus where it was. @param {MissionPageState} state @param {boolean} mayChange */
  #putAlternatives(state, mayChange) {
    const { activeElement } = document;
    const isInside = this.#panel.contains(activeElement) && activeElement !== this.#title;
    const focused = isInside ? activeElement?.textContent : null;
    put(t("Ways to plan it"), ...alternatives(state, this.#actions, mayChange));
    if (!focused) return;
    const buttons = [...this.#panel.querySelectorAll("button")];
    (buttons.find(({ textContent }) => textContent === focused) ?? this.#title).focus();
  }

  /** @param {ShownPlan} plan @param {string} key of the target @param {boolean} canPlan */
  #explainTarget(plan, key, canPlan) {
    const [store, actions] = [this.#store, this.#actions];
    const index = plan.targets.findIndex((target) => target.key === key);
    const entry = plan.result.unassigned.find(({ target }) => target === index);
    if (!entry) return this.close();
    return this.#answer(
      t("Why {target} is not reached", { target: plan.targets[index].label }),
      /** @type {Promise<TargetExplanation>} */ (this.#ask(plan, "/plans/why-target", { target: index })),
      (explanation) => targetExplanation(explanation, entry, { plan, store, actions, canPlan }),
    );
  }

  /** @param {ShownPlan} plan @param {number | undefined} sequence of the route @param {boolean} canPlan */
  #explainRoute(plan, sequence, canPlan) {
    const [store, actions] = [this.#store, this.#actions];
    const route = sequence === undefined ? undefined : plan.result.routes[sequence];
    if (!route?.geometry) return this.close();
    const asked = this.#ask(plan, "/plans/why-route", {
      uav: sequence,
      routes: plan.result.routes.map(({ targets }) => targets),
      shortest_ways: takesShortestWays(plan.result),
    });
    return this.#answer(
      t("Why {name} flies this way", { name: route.uav }),
      /** @type {Promise<RouteExplanation>} */ (asked),
      (explanation) => routeExplanation(explanation, { plan, store, actions, canPlan }),
    );
  }

  /**
   * @template {{ zones?: { id: number | null }[] }} Explanation
   * @param {string} title
   * @param {Promise<Explanation>} asked
   * @param {(explanation: Explanation) => Child[]} show
   */
  async #answer(title, asked, show) {
    const store = this.#store;
    const { why } = store.state;
    put(
      title,
      h(
        "div",
        { class: "stack", role: "status", "aria-label": t("Being worked out") },
        [1, 2, 3].map(() => h("div", { class: "skeleton" })),
      ),
    );
    try {
      const explanation = await asked;
      if (store.state.why !== why) return;
      put(title, ...show(explanation));
      store.update({ litZones: (explanation.zones ?? []).flatMap(({ id }) => id ?? []) });
    } catch (error) {
      if (store.state.why !== why) return;
      put(
        title,
        h("p", { role: "alert" }, error instanceof Error ? error.message : ""),
        h("button", { type: "button", class: "button", onclick: () => this.draw(store.state) }, t("Ask again")),
      );
    }
  }
}

/** @param {MissionStore} store @param {MissionActions} actions @param {{ canPlan: boolean }} how */
export function mountWhy(store, actions, { canPlan }) {
  const panel = new WhyPanel(store, actions, canPlan);
  byId("close-why").append(icon("x"));
  byId("close-why").addEventListener("click", () => panel.close());
  byId("why").addEventListener("keydown", (event) => {
    if (event.key !== "Escape") return;
    event.stopPropagation();
    panel.close();
  });
  store.listen(["why", "plan", "lastPlan"], (state) => panel.draw(state));
  store.listen(["figures", "planningBeside", "refusedBeside", "selection"], (state) => {
    if (state.why?.alternatives) panel.draw(state);
  });
}
