/** The dock: the sentence, then a strip for each UAV, all on one axis; on request the strip of the plan before under each. */

import { byId, find, h } from "../../../dom.js";
import { t } from "../../../text.js";
import { counterpart } from "../../plan/compare.js";
import { isPlanCurrent, isPlanInSight, lastPlanOf, pointAlong, routesOf, sentenceOf } from "../../plan/plan_view.js";
import { batteryOf } from "../../plan/route_times.js";
import { stripAxis } from "../../strips/span_strip.js";
import { drawProof, drawQuality } from "./quality.js";
import { isTight, mainOf, stripRoom } from "./room.js";
import { routeRow } from "./row.js";
import { createStrips } from "./strips.js";

/** @import { MissionActions, MissionPageState, MissionStore, ShortPlan, ShownPlan } from "../../types.d.ts" */
/** @import { Grounds } from "./strips.js" */

/**
 * @param {MissionStore} store
 * @param {MissionActions} actions
 * @param {{ canPlan: boolean, grounds: Grounds, showPoint: (position: number[] | null) => void }} how
 */
export function mountRoutes(store, actions, { canPlan, grounds, showPoint }) {
  const dock = byId("dock");
  const list = byId("route-list");
  const strips = createStrips(list, store, actions, { canPlan, grounds });
  let width_px = 0;
  let isPointed = false; // a place of a strip is shown on the map

  /** @param {MissionPageState} state */
  function draw(state) {
    const { plan } = state;
    dock.hidden = !plan;
    if (!plan) return;
    drawHead(state, plan);
    const showsBattery = plan.result.routes.some((route) => batteryOf(route));
    dock.classList.toggle("with-battery", showsBattery);
    dock.classList.toggle("outdated", !isPlanCurrent(state));
    width_px = stripRoom(dock);
    dock.classList.toggle("tight", isTight(dock));
    const last = lastPlanOf(state);
    const before = state.why?.compare ? last : null;
    dock.classList.toggle("comparing", Boolean(before));
    byId("compare-plans").hidden = !last;
    byId("compare-plans").setAttribute("aria-pressed", String(Boolean(before)));
    strips.begin(state, plan);
    drawQuality(state, plan, { canPlan, actions });
    drawRows(state, plan, before, showsBattery);
    mark(state);
  }

  /**
   * @param {MissionPageState} state
   * @param {ShownPlan} plan
   * @param {ShortPlan | null} before
   * @param {boolean} showsBattery
   */
  function drawRows(state, plan, before, showsBattery) {
    const buttons = () => [...list.querySelectorAll("button")];
    const focused = buttons().indexOf(/** @type {HTMLButtonElement} */ (document.activeElement));
    const drawn = { plan, width_px, longest_m: longestOf(plan, before) };
    list.replaceChildren(
      ...routesOf(plan).map((route) => {
        const old = before && counterpart(route, before);
        const { sequence } = route;
        return routeRow(route, {
          result: plan.result,
          canPlan,
          isChosen: state.chosenRoute === sequence,
          isChanged: strips.isChanged(sequence),
          showsBattery,
          before: old,
          strips: strips.draw(route, old, state, drawn),
          acts: {
            look: () => store.update({ lookedAt: sequence }),
            leave: () => store.update({ lookedAt: null }),
            choose: () => store.update({ chosenRoute: store.state.chosenRoute === sequence ? null : sequence }),
            change: () => void actions.beginManually(sequence),
            explain: () => store.update({ why: { route: sequence } }),
          },
        });
      }),
    );
    if (focused >= 0) buttons()[focused]?.focus({ preventScroll: true });
    byId("route-axis").replaceChildren(h("div", {}, stripAxis(drawn.longest_m || 1, width_px)));
  }

  /** @param {MissionPageState} state */
  function mark(state) {
    for (const element of /** @type {HTMLCollectionOf<HTMLElement>} */ (list.children)) {
      const sequence = Number(element.dataset.sequence);
      element.classList.toggle("lit", state.lookedAt === sequence);
      element.classList.toggle("chosen", state.chosenRoute === sequence);
      find(element, ".who").setAttribute("aria-pressed", String(state.chosenRoute === sequence));
    }
    strips.light(state.plan ? state.litTarget : null);
  }

  listenToComparing(store, actions, canPlan);
  store.listen(["plan", "selection", "lastPlan", "mission"], draw);
  store.listen(["proof"], (state) => drawProof(state, { canPlan, actions }));
  store.listen(["why"], (state) => {
    byId("compare-ways").setAttribute("aria-pressed", String(Boolean(state.why?.alternatives)));
    if (Boolean(state.why?.compare) !== dock.classList.contains("comparing")) draw(state);
  });
  store.listen(["plan"], ({ plan, planIsStored }) => {
    if (plan) strips.lookForZones(plan, () => draw(store.state));
    if (!planIsStored) dock.closest(".side-scroll")?.scrollTo({ top: 0 }); // on a phone the result of planning comes first
  });
  store.listen(["lookedAt", "chosenRoute", "litTarget"], mark);
  store.listen(["along"], (state) => {
    strips.point(state.along);
    const position = pointAlong(state);
    if (position || isPointed) showPoint(position);
    isPointed = position !== null;
  });
  new ResizeObserver(() => {
    if (store.state.plan && stripRoom(dock) !== width_px) draw(store.state);
  }).observe(mainOf(dock));
}

/**
 * The buttons for the ways to plan and for the plan before.
 *
 * @param {MissionStore} store
 * @param {MissionActions} actions
 * @param {boolean} canPlan
 */
function listenToComparing(store, actions, canPlan) {
  byId("compare-ways").addEventListener("click", () => {
    const isOpen = Boolean(store.state.why?.alternatives);
    store.update({ why: isOpen ? null : { alternatives: true } });
    if (!isOpen && canPlan) actions.planAlternatives();
  });
  byId("compare-plans").addEventListener("click", () =>
    store.update({ why: store.state.why?.compare ? null : { compare: true } }),
  );
}

/** The sentence and the facts. @param {MissionPageState} state @param {ShownPlan} plan */
function drawHead(state, plan) {
  const { sentence, facts } = sentenceOf(plan);
  byId("plan-sentence").textContent = `${sentence}.`;
  byId("plan-facts").textContent = isPlanCurrent(state)
    ? facts
    : `${facts} · ${isPlanInSight(state) ? t("before your last change") : t("for the selection before")}`;
}

/** What the axis reaches to. @param {ShownPlan} plan @param {ShortPlan | null} before */
const longestOf = (plan, before) =>
  Math.max(plan.result.longest_route_m, ...(before?.routes ?? []).map((route) => route.length_m));
