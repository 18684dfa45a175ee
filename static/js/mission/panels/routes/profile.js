/** Under the strips: the flight of the route that is looked at from the side, with the figures at the pointer. */

import { byId, h } from "../../../dom.js";
import { routeNumber } from "../../../domain/palette.js";
import { t, tn } from "../../../text.js";
import { heightText, lengthText, percentText } from "../../../units.js";
import { timeAt } from "../../flight_options.js";
import { isPlanCurrent, lastPlanOf, shownRoute } from "../../plan_view.js";
import { drawProfile, flightOf, profileTable, readingAt } from "../../profile.js";
import { batteryOf, landing_s, stayText } from "../../route_times.js";
import { marginWords, zoneLegend, zoneWords } from "../../zones_passed.js";
import { stripRoom } from "./routes.js";

const MOST_WAITS = 3;

export function mountProfile(store, { grounds }) {
  const dock = byId("dock");
  const place = byId("route-profile");
  let drawn = null; // { route, flight, chart, width_px, longest_m }

  const longestOf = ({ plan, why, ...state }, route) =>
    Math.max(
      plan.result.longest_route_m,
      route.length_m,
      ...(why?.compare ? (lastPlanOf(state)?.routes ?? []) : []).map((route) => route.length_m),
    );

  const departsAt = () => store.state.plan?.result.departs_at ?? null;

  async function draw(state) {
    if (state.hand?.dragged) return; // the ground is asked about once it is dropped
    const route = state.plan ? shownRoute(state) : null;
    place.hidden = !route;
    if (!route) {
      drawn = null;
      byId("zone-keys").hidden = true;
      place.replaceChildren();
      return;
    }
    const [width_px, longest_m] = [stripRoom(dock), longestOf(state, route)];
    if (drawn?.route.waypoints === route.waypoints && drawn.width_px === width_px && drawn.longest_m === longest_m)
      return;
    let ground = null;
    let fault = "";
    try {
      ground = await grounds(route);
    } catch {
      fault = t("The ground could not be read.");
    }
    if (store.state.plan && shownRoute(store.state)?.waypoints === route.waypoints)
      put(route, ground, fault, width_px, longest_m);
  }

  function put(route, ground, fault, width_px, longest_m) {
    const { targets, uavs } = store.state.plan;
    const flight = flightOf(route, ground, uavs[route.sequence]?.battery_wh ?? null, departsAt());
    const chart = drawProfile({
      route,
      flight,
      longest_m,
      width_px,
      reserve_percent: store.state.plan.uavs[route.sequence]?.reserve_percent ?? null,
      onAlong: (at_m) =>
        store.update({
          along: at_m === null ? null : { sequence: route.sequence, at_m, isWished: Boolean(route.isWished) },
        }),
      onTask: (target) => store.update({ litTarget: target === null ? null : (targets[target]?.key ?? null) }),
    });
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
        h("div", {}, profileTable(route, flight, targets, departsAt())),
      ),
    );
    showZoneKeys(flight);
    follow(store.state);
    light(store.state);
  }

  /** Figures at the pointer, else what the whole flight is like. */
  function follow({ along }) {
    if (!drawn) return;
    const { route, flight, chart, fault } = drawn;
    const isHere = along?.sequence === route.sequence && Boolean(along.isWished) === Boolean(route.isWished);
    chart.point(isHere ? along.at_m : null);
    byId("profile-words").replaceChildren(
      ...(isHere
        ? readingWords(readingAt(flight, along.at_m), flight, departsAt())
        : wholeWords(route, flight, fault, departsAt())),
    );
  }

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
  }).observe(dock.querySelector(".dock-main"));
}

/** What the drawn zones mean, and by how much they count beyond their times and heights. */
function showZoneKeys({ zones, margins }) {
  const keys = zoneLegend(zones).map(({ kind, words }) =>
    h("span", { class: "zone-key" }, h("i", { class: `zone-swatch ${kind}`, "aria-hidden": "true" }), words),
  );
  byId("zone-keys").hidden = keys.length === 0;
  byId("zone-keys").replaceChildren(...keys, h("span", {}, marginWords(margins)));
}

const line = (words, isStrong = false) => h(isStrong ? "strong" : "span", {}, words);

function readingWords(
  { at_m, height_m, ground_m, above_m, arrival_s, battery_percent, zones },
  { isFlat },
  departs_at,
) {
  const height = heightText(height_m);
  const place = t("at {distance}", { distance: lengthText(at_m) });
  return [
    line(arrival_s === null ? place : `${place} · ${timeAt(departs_at, arrival_s)}`, true),
    line(isFlat ? t("{height} above take-off", { height }) : t("{height} above sea level", { height })),
    line(
      isFlat
        ? t("flat ground assumed")
        : ground_m === null
          ? t("ground not known")
          : t("{height} above ground", { height: heightText(above_m) }),
    ),
    battery_percent !== null && line(t("battery {percent}", { percent: percentText(battery_percent) })),
    ...[...new Set(zones.map(zoneWords))].map((words) => h("span", { class: "beside-zone" }, words)),
  ].filter(Boolean);
}

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
  const rest = flight.waits.length - MOST_WAITS;
  for (const wait of flight.waits.slice(0, MOST_WAITS))
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
