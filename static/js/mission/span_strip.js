/** The span strip: a route pulled straight. Distance runs to the right, ticks are towers, circles are targets. */

import { h, svg } from "../dom.js";
import { lengthText } from "../units.js";

const EARTH_RADIUS_M = 6_371_008.8; // IUGG mean radius
const TICK_SPACING_PX = 3.5;
const TARGET_SPACING_PX = 19;
const HEIGHT_PX = 34;
const MIDDLE_PX = 18;
const EDGE_PX = 10;

/** Great-circle distance between two lon lat positions, for drawing; figures come from the server. */
export function distance_m([lon1, lat1], [lon2, lat2]) {
  const rad = Math.PI / 180;
  const half = (degrees) => Math.sin((degrees * rad) / 2) ** 2;
  return 2 * EARTH_RADIUS_M * Math.asin(Math.sqrt(half(lat2 - lat1) + Math.cos(lat1 * rad) * Math.cos(lat2 * rad) * half(lon2 - lon1)));
}

/** Along a route's waypoints: where each stands, which legs leave the network, where targets are. All in metres flown. */
export function profileOf(waypoints, length_m) {
  const along = [0];
  for (let index = 1; index < waypoints.length; index += 1) along.push(along[index - 1] + distance_m(waypoints[index - 1].position, waypoints[index].position));
  const scale = along.at(-1) > 0 ? length_m / along.at(-1) : 1; // the server's geodesic length is the true one
  const places = along.map((distance) => distance * scale);
  const isOff = (waypoint) => waypoint.kind === "start" || waypoint.kind === "end" || waypoint.asset === null;
  const legs = [];
  for (let index = 1; index < waypoints.length; index += 1) {
    if (places[index] === places[index - 1]) continue;
    const offNetwork = isOff(waypoints[index - 1]) || isOff(waypoints[index]);
    const last = legs.at(-1);
    if (last && last.offNetwork === offNetwork) last.to = places[index];
    else legs.push({ from: places[index - 1], to: places[index], offNetwork });
  }
  const targets = [];
  waypoints.forEach((waypoint, index) => {
    if (waypoint.kind === "target") targets.push({ target: waypoint.target, at: places[index] });
  });
  return { places, legs, targets, ticks: places.filter((_, index) => waypoints[index].kind !== "start" && waypoints[index].kind !== "end") };
}

/** Places in px: ticks thinned, targets pushed right when they would touch; more than fit side by side are dots at their true places. */
export function layOut(profile, longest_m, width_px) {
  const room = width_px - 2 * EDGE_PX;
  const x = (distance) => EDGE_PX + (longest_m > 0 ? (distance / longest_m) * room : 0);
  const ticks = [];
  for (const distance of profile.ticks) {
    if (!ticks.length || x(distance) - ticks.at(-1) >= TICK_SPACING_PX) ticks.push(x(distance));
  }
  const targets = profile.targets.map(({ target, at }, index) => ({ target, number: index + 1, at, x: x(at) }));
  const isCrowded = (targets.length - 1) * TARGET_SPACING_PX > room;
  if (!isCrowded) keepApart(targets, width_px - EDGE_PX);
  const end = profile.places.at(-1) ?? 0;
  return { ticks, targets, isCrowded, legs: profile.legs.map((leg) => ({ ...leg, x1: x(leg.from), x2: x(leg.to) })), start: x(0), end: x(end) };
}

/** Pushes to the right, and what would leave the right edge back to the left. */
function keepApart(targets, limit_px) {
  for (let index = 1; index < targets.length; index += 1) {
    targets[index].x = Math.max(targets[index].x, targets[index - 1].x + TARGET_SPACING_PX);
  }
  for (let index = targets.length - 1; index >= 0; index -= 1) {
    const after = targets[index + 1]?.x ?? limit_px + TARGET_SPACING_PX;
    targets[index].x = Math.min(targets[index].x, after - TARGET_SPACING_PX);
  }
}

/** Position on the route's waypoints at a distance from its start, lon lat. */
export function positionAt(waypoints, places, distance) {
  const next = places.findIndex((place) => place >= distance);
  if (next <= 0) return waypoints[next === 0 ? 0 : waypoints.length - 1].position;
  const span = places[next] - places[next - 1];
  const share = span > 0 ? (distance - places[next - 1]) / span : 0;
  const [from, to] = [waypoints[next - 1].position, waypoints[next].position];
  return [from[0] + (to[0] - from[0]) * share, from[1] + (to[1] - from[1]) * share];
}

/** Round figures for the axis, in km: at most six. */
export function axisTicks(longest_m) {
  const longest_km = longest_m / 1000;
  if (!(longest_km > 0)) return [0];
  const rough = longest_km / 5;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((candidate) => candidate >= rough);
  return Array.from({ length: Math.floor(longest_km / step + 1e-9) + 1 }, (_, index) => Number((index * step).toPrecision(6)));
}

/** strip({ waypoints, length_m, longest_m, width_px, label, names, onAlong }) → SVG element */
export function spanStrip({ waypoints, length_m, longest_m, width_px, label, onAlong }) {
  const profile = profileOf(waypoints, length_m);
  const plan = layOut(profile, longest_m, width_px);
  const mark = (x) => svg("rect", { x: x - 4, y: MIDDLE_PX - 4, width: 8, height: 8, class: "strip-base" });
  const cursor = svg("line", { y1: 0, y2: HEIGHT_PX, class: "strip-cursor", visibility: "hidden" });
  const drawing = svg(
    "svg",
    { class: "strip", role: "img", "aria-label": label, width: width_px, height: HEIGHT_PX, viewBox: `0 0 ${width_px} ${HEIGHT_PX}` },
    plan.ticks.map((x) => svg("line", { x1: x, x2: x, y1: MIDDLE_PX - 6, y2: MIDDLE_PX - 1, class: "strip-tick" })),
    plan.legs.map((leg) => svg("line", { x1: leg.x1, x2: leg.x2, y1: MIDDLE_PX, y2: MIDDLE_PX, class: leg.offNetwork ? "strip-leg off" : "strip-leg" })),
    mark(plan.start),
    mark(plan.end),
    plan.targets.map(({ x, number }) =>
      plan.isCrowded ? svg("circle", { cx: x, cy: MIDDLE_PX, r: 3.5, class: "strip-dot" }) : svg("g", { class: "strip-target" }, svg("circle", { cx: x, cy: MIDDLE_PX, r: 9 }), svg("text", { x, y: MIDDLE_PX + 4 }, `${number}`)),
    ),
    cursor,
  );
  drawing.addEventListener("pointermove", (event) => {
    const x = Math.min(plan.end, Math.max(plan.start, event.clientX - drawing.getBoundingClientRect().left));
    const at = plan.end > plan.start ? ((x - plan.start) / (plan.end - plan.start)) * length_m : 0;
    cursor.setAttribute("x1", x);
    cursor.setAttribute("x2", x);
    cursor.setAttribute("visibility", "visible");
    onAlong?.(positionAt(waypoints, profile.places, at));
  });
  drawing.addEventListener("pointerleave", () => {
    cursor.setAttribute("visibility", "hidden");
    onAlong?.(null);
  });
  return drawing;
}

/** The axis under a list of strips. */
export function stripAxis(longest_m, width_px) {
  const room = width_px - 2 * EDGE_PX;
  const ticks = axisTicks(longest_m);
  return svg(
    "svg",
    { class: "strip-axis", width: width_px, height: 22, "aria-hidden": "true" },
    ticks.map((tick_km, index) => {
      const x = EDGE_PX + ((tick_km * 1000) / longest_m) * room;
      const isLast = index === ticks.length - 1;
      return [svg("line", { x1: x, x2: x, y1: 0, y2: 4 }), svg("text", { x, y: 16 }, isLast ? `${tick_km} km` : `${tick_km}`)];
    }),
  );
}

/** The strip's table for those who do not see it: targets in order with the distance flown to each. */
export function stripTable({ waypoints, length_m, targets, name }) {
  const profile = profileOf(waypoints, length_m);
  return h(
    "table",
    { class: "unseen" },
    h("caption", {}, `Route of ${name}`),
    h("thead", {}, h("tr", {}, h("th", { scope: "col" }, "Target"), h("th", { scope: "col" }, "Distance flown"))),
    h(
      "tbody",
      {},
      profile.targets.map(({ target, at }) => h("tr", {}, h("td", {}, targets[target]?.label ?? "Target"), h("td", {}, lengthText(at)))),
    ),
  );
}
