/** On the stage Rehearse: the dock with the flown heights and battery of one UAV, beside the planned ones. */

import { byId, find, h, refill } from "../../../dom.js";
import { routeLetter, routeNumber } from "../../../domain/palette.js";
import { t } from "../../../text.js";
import { percentText } from "../../../units.js";
import { figuresOf } from "../../rehearsal/rehearsal.js";
import { drawCharts } from "../../rehearsal/rehearsal_charts.js";

/** @import { RehearsalDetail, RehearsedRoute } from "../../../api_types.d.ts" */
/** @import { MissionStore } from "../../types.d.ts" */

const EDGES_PX = 32;

/** @param {MissionStore} store @param {{ choose: (uav: number) => void }} how */
export function createRehearsalDock(store, { choose }) {
  const dock = byId("dock");
  const main = find(dock, ".dock-main", HTMLElement);
  const place = h("section", { class: "rehearsal-dock", "aria-label": t("Flown in simulation") });
  place.hidden = true;
  main.append(place);
  /** @type {number | undefined} */
  let shown;

  /** @param {number | undefined} uav the route that is open in the panel */
  function draw(uav) {
    shown = uav;
    const { detail, run, track } = store.state.rehearsal;
    const routes = detail?.runs[run]?.assessment?.routes ?? [];
    const route = routes.find((one) => one.uav === uav) ?? routes[0];
    const flown = track?.routes.find((one) => one.uav === route?.uav);
    place.hidden = !route || !flown;
    dock.classList.toggle("rehearsed", !place.hidden);
    if (!detail || !route || !flown) return;
    const width_px = Math.max(344, main.clientWidth - EDGES_PX);
    refill(place, JSON.stringify([detail.id, run, route.uav, width_px]), () => [
      h("div", { class: "rehearsal-dock-head" }, tabs(routes, route, choose), facts(route, detail)),
      drawCharts(flown, route.reserve_percent, width_px),
    ]);
  }

  new ResizeObserver(() => draw(shown)).observe(main);
  return { draw };
}

/** @param {RehearsedRoute[]} routes @param {RehearsedRoute} shown @param {(uav: number) => void} choose */
const tabs = (routes, shown, choose) =>
  h(
    "div",
    { class: "segments", role: "group", "aria-label": t("UAV") },
    routes.map(({ uav, name }) =>
      h(
        "button",
        {
          type: "button",
          class: `button small route-${routeNumber(uav)}`,
          "aria-pressed": `${uav === shown.uav}`,
          onclick: () => choose(uav),
        },
        h("span", { class: "letter" }, routeLetter(uav)),
        name,
      ),
    ),
  );

/** @param {RehearsedRoute} route @param {RehearsalDetail} detail */
function facts(route, { limits }) {
  const [time, , battery, across] = figuresOf(route, limits);
  const left = route.energy.map(({ left_percent }) => percentText(left_percent)).join(", ");
  return h(
    "p",
    { class: "caption" },
    [time.flown, `${battery.words} ${left}`, `${across.words} ${across.flown}`].join(" · "),
  );
}
