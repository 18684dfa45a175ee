/** The dock: the sentence, then a strip for each UAV, all on one axis. */

import { byId, h } from "../../dom.js";
import { routeNumber } from "../../map/palette.js";
import { countText, durationText, lengthText } from "../../units.js";
import { endingOf, isPlanCurrent, routesOf, sentenceOf, stripLabel } from "../plan_view.js";
import { spanStrip, stripAxis, stripTable } from "../span_strip.js";

const NAME_PX = 152; // as in mission.css

/** One whose start lies in a zone; the notice and the row of the UAV say which. */
const isGrounded = ({ result }, { sequence }) => (result.warnings ?? []).some(({ code, uav }) => code === "uav_inside_zone" && uav === sequence);

export function mountRoutes(store, { onAlong }) {
  const dock = byId("dock");
  const list = byId("route-list");
  let width_px = 0;

  function row(route, state) {
    const isUsed = Boolean(route.geometry);
    const look = () => store.update({ lookedAt: route.sequence });
    const leave = () => store.update({ lookedAt: null });
    return h(
      "li",
      { class: `route route-${routeNumber(route.sequence)}`, dataset: { sequence: route.sequence }, onpointerenter: look, onpointerleave: leave, onfocusin: look, onfocusout: leave },
      h(
        "button",
        { type: "button", class: "who", disabled: !isUsed, onclick: () => store.update({ chosenRoute: store.state.chosenRoute === route.sequence ? null : route.sequence }) },
        h("span", { class: "letter" }, route.letter),
        h(
          "span",
          {},
          h("strong", {}, route.name),
          isUsed && h("small", { class: "desk-line" }, countText(route.targets.length, "target")),
          h("small", {}, isUsed ? endingOf(route) : isGrounded(state.plan, route) ? "cannot take off" : "not needed"),
        ),
      ),
      h("div", { class: "strip-place" }, isUsed && strip(route, state)),
      h("span", { class: "figure" }, isUsed ? lengthText(route.length_m) : "—"),
      h("span", { class: "figure" }, isUsed ? durationText(route.duration_s) : "—"),
    );
  }

  function strip(route, { plan }) {
    const { result, targets } = plan;
    const { waypoints, length_m } = route;
    return [
      spanStrip({ waypoints, length_m, longest_m: result.longest_route_m, width_px, label: stripLabel(route, targets), onAlong }),
      h("div", {}, stripTable({ waypoints, length_m, targets, name: route.name })),
    ];
  }

  function draw(state) {
    dock.hidden = !state.plan;
    if (!state.plan) return;
    const { sentence, facts } = sentenceOf(state.plan);
    byId("plan-sentence").textContent = `${sentence}.`;
    byId("plan-facts").textContent = isPlanCurrent(state) ? facts : `${facts} · for the selection before`;
    width_px = measure();
    list.replaceChildren(...routesOf(state.plan).map((route) => row(route, state)));
    byId("route-axis").replaceChildren(h("div", {}, stripAxis(state.plan.result.longest_route_m || 1, width_px)));
    mark(state);
  }

  /** Room for a strip: what the grid leaves beside name and figures. */
  function measure() {
    const room = dock.clientWidth - 32;
    return Math.max(160, matchMedia("(max-width: 720px)").matches ? room : room - NAME_PX - 2 * 76 - 3 * 12);
  }

  function mark({ lookedAt, chosenRoute }) {
    for (const element of list.children) {
      const sequence = Number(element.dataset.sequence);
      element.classList.toggle("lit", lookedAt === sequence);
      element.classList.toggle("chosen", chosenRoute === sequence);
    }
  }

  store.listen(["plan", "selection"], draw);
  store.listen(["plan"], () => dock.closest(".side-scroll")?.scrollTo({ top: 0 })); // on a phone the result stands first
  store.listen(["lookedAt", "chosenRoute"], mark);
  new ResizeObserver(() => {
    if (store.state.plan && measure() !== width_px) draw(store.state);
  }).observe(dock);
}
