/** The flight of one UAV from the side: ground, zones beside it, flight height, task points and battery, on the axis of the strips. */

import { post } from "../api.js";
import { h, svg } from "../dom.js";
import { profileOf } from "../domain/route_profile.js";
import { heightsText } from "../domain/zone_heights.js";
import { rulesOf } from "../terrain/profile_chart.js";
import { t } from "../text.js";
import { heightText, lengthText, percentText } from "../units.js";
import { timeAt } from "./flight_options.js";
import { staysOf, stayText } from "./route_times.js";
import { scaleOf } from "./span_strip.js";
import { passedZones, zoneWords } from "./zones_passed.js";

export const PROFILE_HEIGHT_PX = 96;
const TOP_PX = 14;
const FLOOR_PX = PROFILE_HEIGHT_PX - 4;
const BATTERY_PX = { full: PROFILE_HEIGHT_PX + 8, empty: PROFILE_HEIGHT_PX + 36 };
const LEAST_SPAN_M = 60; // a plain must not look like mountains
const NEAR_ZONE_M = 300;
const MOST_VERTICES = 1_900; // of the 2,000 that the server takes
const MOST_STEPS = 600;

/** Every k-th of the positions where there are more than the server takes; both ends stay. */
export function thinned(positions, most = MOST_VERTICES) {
  const step = Math.ceil((positions.length - 1) / (most - 1));
  if (step <= 1) return positions;
  return positions.filter((_, index) => index % step === 0 || index === positions.length - 1);
}

/** The ground under a route, asked once for each route: [{ at_m, ground_m or null }], and zones near it. */
export function createGrounds() {
  const known = new WeakMap(); // route of a plan → promise
  return (route) => {
    const { waypoints, length_m } = route;
    if (!known.has(waypoints)) {
      const line = thinned(waypoints.map(({ position }) => position));
      const asked = post("/terrain/profile", {
        line,
        step_m: Math.max(5, length_m / MOST_STEPS),
        near_m: NEAR_ZONE_M,
      }).then(({ data }) => groundOf(data, length_m));
      asked.catch(() => known.delete(waypoints)); // asked again the next time
      known.set(waypoints, asked);
    }
    return known.get(waypoints);
  };
}

/** The server's profile, its distances stretched to the route's own length. */
export function groundOf(profile, length_m) {
  const scale = profile.length_m > 0 ? length_m / profile.length_m : 1;
  return {
    samples: profile.distance_m.map((distance, index) => ({
      at_m: distance * scale,
      ground_m: profile.ground_amsl_m[index],
    })),
    zones: profile.zones.map((zone) => ({ ...zone, from_m: zone.from_m * scale, to_m: zone.to_m * scale })),
    zone_margins: profile.zone_margins,
  };
}

/** Heights of the flight over what they count from: sea level, or the take-off place where the ground is taken for flat; departs_at of
 * the plan says which zones are in force. */
export function flightOf(route, ground, battery_wh = null, departs_at = null) {
  const { places, targets } = profileOf(route.waypoints, route.length_m);
  const isFlat = route.waypoints.some(({ altitude_amsl_m }) => altitude_amsl_m === null);
  const heightOf = (waypoint) => (isFlat ? waypoint.altitude_relative_m : waypoint.altitude_amsl_m);
  const stays = new Map(staysOf(route).map((stay) => [stay.index, stay]));
  const path = route.waypoints.flatMap((waypoint, index) => {
    const point = {
      at_m: places[index],
      height_m: heightOf(waypoint),
      arrival_s: route.arrival_s?.[index] ?? null,
      battery_percent: route.battery_left_percent?.[index] ?? null,
    };
    const stay = stays.get(index) ?? (waypoint.task?.hold_s ? { kind: "task", stay_s: waypoint.task.hold_s } : null);
    return stay ? [point, afterStay(point, stay, battery_wh)] : [point];
  });
  const under = isFlat
    ? [
        { at_m: 0, ground_m: 0 },
        { at_m: route.length_m, ground_m: 0 },
      ]
    : (ground?.samples ?? []);
  const tasks = targets.map(({ target, at }) => ({ target, at_m: at, height_m: heightAt(path, at, "height_m") }));
  const waits = [...stays.values()].map((stay) => ({ ...stay, at_m: places[stay.index] }));
  return {
    isFlat,
    path,
    under,
    tasks,
    waits,
    zones: ground ? passedZones(ground, route, places, departs_at) : [],
    margins: ground?.zone_margins,
    hasBattery: path.some(({ battery_percent }) => battery_percent !== null),
  };
}

/** The same place when it goes on from there: later, and with a battery that is full after a base and fuller after charging. */
function afterStay(point, { kind, stay_s, charged_wh }, battery_wh) {
  const { arrival_s, battery_percent } = point;
  const gained = kind === "charging" && battery_wh ? (charged_wh / battery_wh) * 100 : 0;
  const left = battery_percent === null ? null : kind === "base" ? 100 : Math.min(100, battery_percent + gained);
  return { ...point, arrival_s: arrival_s === null ? null : arrival_s + stay_s, battery_percent: left };
}

/** The value of a name at a distance, straight between neighbours; null where one of them is unknown. */
export function heightAt(points, at_m, name) {
  if (!points.length) return null;
  const next = points.findIndex((point) => point.at_m >= at_m);
  if (next === 0) return points[0][name];
  if (next < 0) return points.at(-1)[name];
  const [before, after] = [points[next - 1], points[next]];
  if (before[name] === null || after[name] === null) return null;
  const share = after.at_m > before.at_m ? (at_m - before.at_m) / (after.at_m - before.at_m) : 1;
  return before[name] + (after[name] - before[name]) * share;
}

/** What is said at a distance: { at_m, height_m, ground_m, above_m, arrival_s, battery_percent, zones }; unknown is null. */
export function readingAt(flight, at_m) {
  const height_m = heightAt(flight.path, at_m, "height_m");
  const ground_m = heightAt(flight.under, at_m, "ground_m");
  return {
    at_m,
    height_m,
    ground_m,
    above_m: height_m === null || ground_m === null ? null : height_m - ground_m,
    arrival_s: heightAt(flight.path, at_m, "arrival_s"),
    battery_percent: heightAt(flight.path, at_m, "battery_percent"),
    zones: flight.zones.filter(({ from_m, to_m }) => from_m <= at_m && at_m <= to_m),
  };
}

/** Lowest and highest of what is drawn; a zone without a ceiling does not count. */
export function spanOf({ path, under }) {
  const known = [...path.map(({ height_m }) => height_m), ...under.map(({ ground_m }) => ground_m)].filter(
    (height) => height !== null,
  );
  const low = known.reduce((a, b) => Math.min(a, b), Infinity);
  const high = known.reduce((a, b) => Math.max(a, b), -Infinity);
  const room = Math.max(0, LEAST_SPAN_M - (high - low));
  return { low, high: high + room + (high - low) * 0.08 };
}

/** From where to where a zone reaches at a place, in the heights of the drawing. What it does not state goes to the edge. */
export function bandOf(zone, flight, span) {
  const ground = heightAt(flight.under, (zone.from_m + zone.to_m) / 2, "ground_m") ?? span.low;
  const height = (limit, otherwise) => {
    if (!limit) return otherwise;
    if (limit.reference === "AMSL" || limit.reference === "WGS84") return flight.isFlat ? otherwise : limit.value_m;
    return ground + limit.value_m;
  };
  const clip = (value) => Math.min(Math.max(value, span.low), span.high);
  return { from: clip(height(zone.lower_limit, ground)), to: clip(height(zone.upper_limit, span.high)) };
}

/** The whole in a sentence, for those who do not see the drawing. */
export function profileSentence(route, flight) {
  const heights = flight.path.map(({ height_m }) => height_m);
  const [low, high] = [Math.min(...heights), Math.max(...heights)].map(heightText);
  const words = flight.isFlat
    ? t("{name} flies {low} to {high} above its take-off; flat ground is assumed.", { name: route.name, low, high })
    : t("{name} flies {low} to {high} above sea level.", { name: route.name, low, high });
  const zones = [...new Set(flight.zones.map(zoneWords))];
  return zones.length ? `${words} ${t("Zones: {zones}.", { zones: zones.join("; ") })}` : words;
}

/** Hatched is what a flight must not enter: zones that are only passed by, or not in force then, are outlines. */
const isHatched = ({ kind }) => kind === "met" || kind === "apart";

/** Draws it. onAlong(at_m or null), onTask(target or null); reserve_percent: of the battery, or null. Returns { element, point(at_m or null), light(target or null) }. */
export function drawProfile({ route, flight, longest_m, width_px, reserve_percent = null, onAlong, onTask }) {
  const { x, distanceAt } = scaleOf(longest_m, width_px);
  const span = spanOf(flight);
  const y = (height) => TOP_PX + ((span.high - height) / (span.high - span.low)) * (FLOOR_PX - TOP_PX);
  const end = x(route.length_m);
  const bottom_px = flight.hasBattery ? BATTERY_PX.empty : FLOOR_PX;
  const height_px = flight.hasBattery ? BATTERY_PX.empty + 4 : PROFILE_HEIGHT_PX;
  const element = svg("svg", {
    class: "route-profile-chart",
    role: "img",
    "aria-label": profileSentence(route, flight),
    width: width_px,
    height: height_px,
    viewBox: `0 0 ${width_px} ${height_px}`,
  });
  element.append(hatching());
  if (flight.hasBattery) element.append(...batteryDrawing(flight.path, { x, width_px, reserve_percent }));
  for (const rule of rulesOf(span.low, span.high)) {
    element.append(svg("line", { class: "rule", x1: x(0), x2: width_px, y1: y(rule), y2: y(rule) }));
  }
  for (const piece of knownPieces(flight.under)) {
    const line = piece.map(({ at_m, ground_m }) => `${x(at_m).toFixed(1)},${y(ground_m).toFixed(1)}`);
    element.append(
      svg("polygon", {
        class: "ground",
        points: [
          ...line,
          `${x(piece.at(-1).at_m).toFixed(1)},${FLOOR_PX}`,
          `${x(piece[0].at_m).toFixed(1)},${FLOOR_PX}`,
        ].join(" "),
      }),
      svg("polyline", { class: "ground-edge", points: line.join(" ") }),
    );
  }
  for (const zone of flight.zones) {
    const { from, to } = bandOf(zone, flight, span);
    const [left, right] = [x(zone.from_m), Math.max(x(zone.to_m), x(zone.from_m) + 3)];
    element.append(
      svg(
        "rect",
        {
          class: `zone-band ${zone.kind}`,
          x: left,
          width: right - left,
          y: y(to),
          height: Math.max(1, y(from) - y(to)),
          fill: isHatched(zone) ? "url(#zone-hatch)" : "none",
        },
        svg("title", {}, `${zoneWords(zone)}, ${heightsText(zone)}`),
      ),
    );
  }
  element.append(
    svg("polyline", {
      class: "flight",
      points: flight.path.map(({ at_m, height_m }) => `${x(at_m).toFixed(1)},${y(height_m).toFixed(1)}`).join(" "),
    }),
  );
  for (const rule of rulesOf(span.low, span.high))
    element.append(svg("text", { class: "tick", x: x(0) + 2, y: y(rule) - 3 }, heightText(rule)));
  const dots = new Map();
  for (const task of flight.tasks) {
    const dot = svg("circle", {
      class: "task",
      cx: x(task.at_m),
      cy: y(task.height_m),
      r: 4.5,
      onpointerenter: () => onTask?.(task.target),
      onpointerleave: () => onTask?.(null),
    });
    if (!dots.has(task.target)) dots.set(task.target, []);
    dots.get(task.target).push(dot);
    element.append(dot);
  }
  for (const wait of flight.waits)
    element.append(
      svg(
        "line",
        { class: "wait", x1: x(wait.at_m), x2: x(wait.at_m), y1: TOP_PX, y2: bottom_px },
        svg("title", {}, stayText(wait)),
      ),
    );
  const line = svg("line", { class: "strip-cursor", y1: 0, y2: bottom_px, visibility: "hidden" });
  const dot = svg("circle", { class: "cursor-dot", r: 3.5, visibility: "hidden" });
  element.append(line, dot);

  element.addEventListener("pointermove", (event) => {
    const at = Math.min(end, Math.max(x(0), event.clientX - element.getBoundingClientRect().left));
    onAlong?.(distanceAt(at));
  });
  element.addEventListener("pointerleave", () => onAlong?.(null));
  return {
    element,
    point(at_m) {
      const height = at_m === null ? null : heightAt(flight.path, at_m, "height_m");
      for (const part of [line, dot]) part.setAttribute("visibility", height === null ? "hidden" : "visible");
      if (height === null) return;
      line.setAttribute("x1", x(at_m));
      line.setAttribute("x2", x(at_m));
      dot.setAttribute("cx", x(at_m));
      dot.setAttribute("cy", y(height));
    },
    light(target) {
      for (const [key, circles] of dots) for (const circle of circles) circle.classList.toggle("lit", key === target);
    },
  };
}

/** What is left of the battery, from full to empty, with the reserve that no plan uses. */
function batteryDrawing(path, { x, width_px, reserve_percent }) {
  const y = (percent) => BATTERY_PX.empty - (Math.max(0, percent) / 100) * (BATTERY_PX.empty - BATTERY_PX.full);
  const known = path.filter(({ battery_percent }) => battery_percent !== null);
  const points = known.map(({ at_m, battery_percent }) => `${x(at_m).toFixed(1)},${y(battery_percent).toFixed(1)}`);
  return [
    svg("line", { class: "rule", x1: x(0), x2: width_px, y1: BATTERY_PX.empty, y2: BATTERY_PX.empty }),
    svg("polygon", {
      class: "battery-left",
      points: [
        ...points,
        `${x(known.at(-1).at_m).toFixed(1)},${BATTERY_PX.empty}`,
        `${x(known[0].at_m).toFixed(1)},${BATTERY_PX.empty}`,
      ].join(" "),
    }),
    reserve_percent !== null &&
      svg(
        "line",
        {
          class: "battery-reserve",
          x1: x(0),
          x2: x(known.at(-1).at_m),
          y1: y(reserve_percent),
          y2: y(reserve_percent),
        },
        svg("title", {}, t("Kept in reserve")),
      ),
    svg("polyline", { class: "battery-curve", points: points.join(" ") }),
    svg("text", { class: "tick", x: x(0) + 2, y: BATTERY_PX.empty - 4 }, t("Battery")),
  ].filter(Boolean);
}

function hatching() {
  return svg(
    "defs",
    {},
    svg(
      "pattern",
      { id: "zone-hatch", width: 6, height: 6, patternUnits: "userSpaceOnUse", patternTransform: "rotate(45)" },
      svg("line", { class: "hatch-line", x1: 0, x2: 0, y1: 0, y2: 6 }),
    ),
  );
}

/** Runs of samples whose ground is known, two at least. */
function knownPieces(samples) {
  const pieces = [[]];
  for (const sample of samples) {
    if (sample.ground_m === null) pieces.push([]);
    else pieces.at(-1).push(sample);
  }
  return pieces.filter((piece) => piece.length > 1);
}

/** The profile as a table: each task point with distance, ground and height, and where they are known arrival and battery. */
export function profileTable(route, flight, targets, departs_at) {
  const said = (height) => (height === null ? t("not known") : heightText(height));
  const height = flight.isFlat ? t("Height above take-off") : t("Height above sea level");
  const hasTimes = flight.path.some(({ arrival_s }) => arrival_s !== null);
  return h(
    "table",
    { class: "unseen" },
    h("caption", {}, t("Heights of {name}", { name: route.name })),
    h(
      "thead",
      {},
      h(
        "tr",
        {},
        [
          t("Target"),
          t("Distance flown"),
          t("Ground"),
          height,
          hasTimes && t("Arrival"),
          flight.hasBattery && t("Battery left"),
        ]
          .filter(Boolean)
          .map((words) => h("th", { scope: "col" }, words)),
      ),
    ),
    h(
      "tbody",
      {},
      flight.tasks.map(({ target, at_m }) => {
        const at = readingAt(flight, at_m);
        return h(
          "tr",
          {},
          [
            targets[target]?.label ?? t("Target"),
            lengthText(at_m),
            said(at.ground_m),
            said(at.height_m),
            hasTimes && timeAt(departs_at, at.arrival_s),
            flight.hasBattery && percentText(at.battery_percent),
          ]
            .filter(Boolean)
            .map((words) => h("td", {}, words)),
        );
      }),
    ),
  );
}
