/** The profile of the selected route under the strips, with the figures at the pointer. */

import { byId, h, setChildren } from "../../../dom.js";
import { routeNumber } from "../../../domain/palette.js";
import { t, tn } from "../../../text.js";
import { heightText, lengthText, percentText } from "../../../units.js";
import { timeAt } from "../../options/flight_options.js";
import { marginWords, zoneLegend, zoneWords } from "../../options/zones_passed.js";
import { isPlanCurrent, lastPlanOf, shownRoute } from "../../plan/plan_view.js";
import { batteryOf, landing_s, stayText } from "../../plan/route_times.js";
import { flightOf, readingAt } from "../../strips/profile.js";
import { drawProfile, profileTable } from "../../strips/profile_chart.js";
import { mainOf, stripRoom } from "./room.js";

/** @import { MissionPageState, MissionStore, ShownPlan, ShownRoute } from "../../types.d.ts" */
/** @import { Grounds } from "./strips.js" */

/** @typedef {Awaited<ReturnType<Grounds>>} RouteGround */
/** @typedef {ReturnType<typeof flightOf>} RouteFlight */
/**
 * @typedef {object} Drawn
 * @property {ShownRoute} route
 * @property {RouteFlight} flight
 * @property {ReturnType<typeof drawProfile>} chart
 * @property {number} width_px
 * @property {number} longest_m
 * @property {string} fault why terrain could not be read
 */

const MAX_WAITS = 3;

/** What the axis reaches to. @param {MissionPageState} state @param {ShownPlan} plan @param {ShownRoute} route */
const longestOf = (state, plan, route) =>
  Math.max(
    plan.result.longest_route_m,
    route.length_m,
    ...(state.why?.compare ? (lastPlanOf(state)?.routes ?? []) : []).map(({ length_m }) => length_m),
  );

/** @param {MissionStore} store @param {{ grounds: Grounds }} how */
export function mountProfile(store, { grounds }) {
  const dock = byId("dock");
  const place = byId("route-profile");
  /** @type {Drawn | null} */
  let drawn = null;

  const departsAt = () => store.state.plan?.result.departs_at ?? null;

  /** @param {MissionPageState} state */
  async function draw(state) {
    if (state.hand?.dragged) return; // terrain is requested once the point is dropped
    const { plan } = state;
    const route = plan ? shownRoute(state) : null;
    place.hidden = !route;
    if (!plan || !route) {
      drawn = null;
      byId("zone-keys").hidden = true;
      place.replaceChildren();
      return;
    }
    const [width_px, longest_m] = [stripRoom(dock), longestOf(state, plan, route)];
    if (drawn?.route.waypoints === route.waypoints && drawn.width_px === width_px && drawn.longest_m === longest_m)
      return;
    /** @type {RouteGround | null} */
    let ground = null;
    let fault = "";
    try {
      ground = await grounds(route);
    } catch {
      fault = t("The ground could not be read.");
    }
    const now = store.state.plan;
    if (!now || shownRoute(store.state)?.waypoints !== route.waypoints) return;
    const uav = now.uavs[route.sequence];
    const flight = flightOf(route, ground, uav?.battery_wh ?? null, departsAt());
    const chart = chartOf(route, flight, now, { longest_m, width_px }, store);
    drawn = { route, flight, chart, width_px, longest_m, fault };
    place.className = `route-profile route-${routeNumber(route.sequence)}`;
    place.replaceChildren(
      h(
        "div",
        { class: "profile-said" },
        h("span", { class: "letter" }, route.letter),
        h("p", { id: "profile-words" }),
      ),
      h(
        "div",
        { class: "profile-place" },
        chart.element,
        h("div", {}, profileTable(route, flight, now.targets, departsAt())),
      ),
    );
    showZoneKeys(flight, state.lookedAt !== null);
    follow(store.state);
    light(store.state);
  }

  /** Figures at the pointer, else what the whole flight is like. @param {MissionPageState} state */
  function follow({ along }) {
    if (!drawn) return;
    const { route, flight, chart, fault } = drawn;
    const isHere = along?.sequence === route.sequence && along.isWished === Boolean(route.isWished);
    const at_m = along && isHere ? along.at_m : null;
    chart.point(at_m);
    setChildren(
      byId("profile-words"),
      at_m === null
        ? wholeWords(route, flight, fault, departsAt())
        : readingWords(readingAt(flight, at_m), flight, departsAt()),
    );
  }

  /** @param {MissionPageState} state */
  function light(state) {
    if (!drawn) return;
    const target =
      state.litTarget && state.plan && isPlanCurrent(state)
        ? state.plan.targets.findIndex(({ key }) => key === state.litTarget)
        : -1;
    drawn.chart.light(target < 0 ? null : target);
  }

  store.listen(["plan", "lookedAt", "chosenRoute", "why", "lastPlan", "hand"], draw);
  store.listen(["along"], follow);
  store.listen(["litTarget"], light);
  new ResizeObserver(() => {
    if (drawn && stripRoom(dock) !== drawn.width_px) draw(store.state);
  }).observe(mainOf(dock));
}

/**
 * @param {ShownRoute} route
 * @param {RouteFlight} flight
 * @param {ShownPlan} plan
 * @param {{ longest_m: number, width_px: number }} size
 * @param {MissionStore} store
 */
const chartOf = (route, flight, { uavs, targets }, size, store) =>
  drawProfile({
    route,
    flight,
    ...size,
    reserve_percent: uavs[route.sequence]?.reserve_percent ?? null,
    onAlong: (at_m) =>
      store.update({
        along: at_m === null ? null : { sequence: route.sequence, at_m, isWished: Boolean(route.isWished) },
      }),
    onTask: (target) => store.update({ litTarget: target === null ? null : (targets[target]?.key ?? null) }),
  });

/**
 * The meaning of the drawn zones, and their margins of time and height. While the pointer previews a route the row keeps its height: the
 * map above must not move under the pointer.
 *
 * @param {RouteFlight} flight
 * @param {boolean} isGlance
 */
function showZoneKeys({ zones, margins }, isGlance) {
  const keys = zoneLegend(zones).map(({ kind, words }) =>
    h("span", { class: "zone-key" }, h("i", { class: `zone-swatch ${kind}`, "aria-hidden": "true" }), words),
  );
  const row = byId("zone-keys");
  const isEmpty = keys.length === 0;
  const keepsRoom = isEmpty && isGlance && !row.hidden;
  row.classList.toggle("blank", keepsRoom);
  row.hidden = isEmpty && !keepsRoom;
  row.replaceChildren(...keys, h("span", {}, marginWords(margins)));
}

/** @param {string} words @param {boolean} [isStrong] */
const line = (words, isStrong = false) => h(isStrong ? "strong" : "span", {}, words);

/** @param {ReturnType<typeof readingAt>} reading @param {RouteFlight} flight @param {string | null} departs_at */
function readingWords(
  { at_m, height_m, ground_m, above_m, arrival_s, battery_percent, zones },
  { isFlat },
  departs_at,
) {
  const height = heightText(height_m ?? 0);
  const place = t("at {distance}", { distance: lengthText(at_m) });
  return [
    line(arrival_s === null ? place : `${place} · ${timeAt(departs_at, arrival_s)}`, true),
    line(isFlat ? t("{height} above take-off", { height }) : t("{height} above sea level", { height })),
    line(
      isFlat
        ? t("flat ground assumed")
        : ground_m === null
          ? t("ground not known")
          : t("{height} above ground", { height: heightText(above_m ?? 0) }),
    ),
    battery_percent !== null && line(t("battery {percent}", { percent: percentText(battery_percent) })),
    ...[...new Set(zones.map(zoneWords))].map((words) => h("span", { class: "beside-zone" }, words)),
  ];
}

/** @param {ShownRoute} route @param {RouteFlight} flight @param {string} fault @param {string | null} departs_at */
function wholeWords(route, flight, fault, departs_at) {
  const heights = flight.path.map(({ height_m }) => height_m);
  const height = heightText(Math.max(...heights));
  const lines = [
    line(route.name, true),
    ...(route.isWished ? [line(t("as changed by hand"))] : []),
    line(
      flight.isFlat ? t("up to {height} above take-off", { height }) : t("up to {height} above sea level", { height }),
    ),
  ];
  const landing = landing_s(route);
  if (landing !== null) lines.push(line(t("done at {time}", { time: timeAt(departs_at, landing) })));
  const battery = batteryOf(route);
  if (battery) lines.push(line(t("{percent} left, {energy} used", { percent: battery.left, energy: battery.used })));
  const rest = flight.waits.length - MAX_WAITS;
  for (const wait of flight.waits.slice(0, MAX_WAITS))
    lines.push(line(`${t("at {distance}", { distance: lengthText(wait.at_m) })}: ${stayText(wait)}`));
  if (rest > 0) lines.push(line(tn(rest, "and {count} more", "and {count} more")));
  if (fault) return [...lines, line(fault)];
  if (flight.isFlat) return [...lines, line(t("flat ground assumed"))];
  const above = route.waypoints.map(({ altitude_agl_m }) => altitude_agl_m).filter((metres) => metres > 0);
  return [
    ...lines,
    line(
      t("{low} to {high} above ground", { low: heightText(Math.min(...above)), high: heightText(Math.max(...above)) }),
    ),
  ];
}
