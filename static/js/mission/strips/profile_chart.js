/** The drawing of a flight from the side, on the axis of the strips, and its table. */

import { h, svg } from "../../dom.js";
import { heightsText } from "../../domain/zone_heights.js";
import { rulesOf } from "../../terrain/profile_chart.js";
import { t } from "../../text.js";
import { heightText, lengthText, percentText } from "../../units.js";
import { timeAt } from "../options/flight_options.js";
import { zoneWords } from "../options/zones_passed.js";
import { stayText } from "../plan/route_times.js";
import { bandOf, heightAt, profileSentence, readingAt, spanOf } from "./profile.js";
import { scaleOf } from "./span_strip.js";

/** @import { Flight, GroundSample, PathPoint, Span } from "./profile.js" */
/** @import { PickedTarget, ShownRoute } from "../types.d.ts" */
/** @import { PassedZone } from "../options/zones_passed.js" */

/** @typedef {(metres: number) => number} Axis metres to px */
/**
 * @typedef {object} ChartOptions
 * @property {ShownRoute} route
 * @property {Flight} flight
 * @property {number} longest_m what the axis reaches to
 * @property {number} width_px
 * @property {number | null} [reserve_percent] of the battery
 * @property {(at_m: number | null) => void} [onAlong]
 * @property {(target: number | null) => void} [onTask]
 */

const PROFILE_HEIGHT_PX = 96;
const TOP_PX = 14;
const FLOOR_PX = PROFILE_HEIGHT_PX - 4;
const BATTERY_PX = { full: PROFILE_HEIGHT_PX + 8, empty: PROFILE_HEIGHT_PX + 36 };

/**
 * Draws a flight. Returns { element, point(at_m or null), light(target or null) }.
 *
 * @param {ChartOptions} options
 */
export function drawProfile({ route, flight, longest_m, width_px, reserve_percent = null, onAlong, onTask }) {
  const { x, distanceAt } = scaleOf(longest_m, width_px);
  const span = spanOf(flight);
  /** @type {Axis} */
  const y = (height) => TOP_PX + ((span.high - height) / (span.high - span.low)) * (FLOOR_PX - TOP_PX);
  const bottom_px = flight.hasBattery ? BATTERY_PX.empty : FLOOR_PX;
  const height_px = flight.hasBattery ? BATTERY_PX.empty + 4 : PROFILE_HEIGHT_PX;
  const { dots, light } = taskDots(flight, x, y, onTask);
  const { parts, point } = cursorOn(flight, x, y, bottom_px);
  const rules = rulesOf(span.low, span.high);
  const element = svg(
    "svg",
    {
      class: "route-profile-chart",
      role: "img",
      "aria-label": profileSentence(route, flight),
      width: width_px,
      height: height_px,
      viewBox: `0 0 ${width_px} ${height_px}`,
    },
    hatching(),
    flight.hasBattery && batteryDrawing(flight.path, { x, width_px, reserve_percent }),
    rules.map((rule) => svg("line", { class: "rule", x1: x(0), x2: width_px, y1: y(rule), y2: y(rule) })),
    knownPieces(flight.under).map((piece) => groundDrawing(piece, x, y)),
    flight.zones.map((zone) => zoneBand(zone, flight, span, x, y)),
    svg("polyline", {
      class: "flight",
      points: flight.path.map((at) => `${px(x(at.at_m))},${px(y(at.height_m))}`).join(" "),
    }),
    rules.map((rule) => svg("text", { class: "tick", x: x(0) + 2, y: y(rule) - 3 }, heightText(rule))),
    dots,
    flight.waits.map((wait) =>
      svg(
        "line",
        { class: "wait", x1: x(wait.at_m), x2: x(wait.at_m), y1: TOP_PX, y2: bottom_px },
        svg("title", {}, stayText(wait)),
      ),
    ),
    parts,
  );
  element.addEventListener("pointermove", (event) => {
    const at = event.clientX - element.getBoundingClientRect().left;
    onAlong?.(distanceAt(Math.min(x(route.length_m), Math.max(x(0), at))));
  });
  element.addEventListener("pointerleave", () => onAlong?.(null));
  return { element, point, light };
}

/** @param {number} place */
const px = (place) => place.toFixed(1);

/** @param {Known[]} piece @param {Axis} x @param {Axis} y */
function groundDrawing(piece, x, y) {
  const line = piece.map(({ at_m, ground_m }) => `${px(x(at_m))},${px(y(ground_m))}`);
  const [first, last] = [piece[0], piece[piece.length - 1]];
  const floor = [last, first].map(({ at_m }) => `${px(x(at_m))},${FLOOR_PX}`);
  return [
    svg("polygon", { class: "ground", points: [...line, ...floor].join(" ") }),
    svg("polyline", { class: "ground-edge", points: line.join(" ") }),
  ];
}

/**
 * Hatched is what a flight must not enter: zones that are only passed by, or not in force then, are outlines.
 *
 * @param {PassedZone} zone
 */
const isHatched = ({ kind }) => kind === "met" || kind === "apart";

/** @param {PassedZone} zone @param {Flight} flight @param {Span} span @param {Axis} x @param {Axis} y */
function zoneBand(zone, flight, span, x, y) {
  const { from, to } = bandOf(zone, flight, span);
  const [left, right] = [x(zone.from_m), Math.max(x(zone.to_m), x(zone.from_m) + 3)];
  return svg(
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
  );
}

/**
 * A dot for each task point, and which of them are lit.
 *
 * @param {Flight} flight
 * @param {Axis} x
 * @param {Axis} y
 * @param {ChartOptions["onTask"]} onTask
 */
function taskDots(flight, x, y, onTask) {
  const tasks = flight.tasks.map(({ target, at_m, height_m }) => ({
    target,
    dot: svg("circle", {
      class: "task",
      cx: x(at_m),
      cy: y(height_m ?? 0),
      r: 4.5,
      onpointerenter: () => onTask?.(target),
      onpointerleave: () => onTask?.(null),
    }),
  }));
  return {
    dots: tasks.map(({ dot }) => dot),
    /** @param {number | null} lit a target */
    light(lit) {
      for (const { target, dot } of tasks) dot.classList.toggle("lit", target === lit);
    },
  };
}

/**
 * A line and a dot at a distance flown.
 *
 * @param {Flight} flight
 * @param {Axis} x
 * @param {Axis} y
 * @param {number} bottom_px
 */
function cursorOn(flight, x, y, bottom_px) {
  const line = svg("line", { class: "strip-cursor", y1: 0, y2: bottom_px, visibility: "hidden" });
  const dot = svg("circle", { class: "cursor-dot", r: 3.5, visibility: "hidden" });
  return {
    parts: [line, dot],
    /** @param {number | null} at_m */
    point(at_m) {
      const height = at_m === null ? null : heightAt(flight.path, at_m, "height_m");
      for (const part of [line, dot]) part.setAttribute("visibility", height === null ? "hidden" : "visible");
      if (at_m === null || height === null) return;
      line.setAttribute("x1", `${x(at_m)}`);
      line.setAttribute("x2", `${x(at_m)}`);
      dot.setAttribute("cx", `${x(at_m)}`);
      dot.setAttribute("cy", `${y(height)}`);
    },
  };
}

/**
 * The battery level, from full to empty, with the reserve that no plan uses.
 *
 * @param {PathPoint[]} path
 * @param {{ x: Axis, width_px: number, reserve_percent: number | null }} options
 */
function batteryDrawing(path, { x, width_px, reserve_percent }) {
  /** @param {number} percent */
  const y = (percent) => BATTERY_PX.empty - (Math.max(0, percent) / 100) * (BATTERY_PX.empty - BATTERY_PX.full);
  const known = path.flatMap(({ at_m, battery_percent: percent }) =>
    percent === null ? [] : [{ at: x(at_m), percent }],
  );
  const points = known.map(({ at, percent }) => `${px(at)},${px(y(percent))}`);
  const [first, last] = [known[0], known[known.length - 1]];
  return [
    svg("line", { class: "rule", x1: x(0), x2: width_px, y1: BATTERY_PX.empty, y2: BATTERY_PX.empty }),
    svg("polygon", {
      class: "battery-left",
      points: [...points, `${px(last.at)},${BATTERY_PX.empty}`, `${px(first.at)},${BATTERY_PX.empty}`].join(" "),
    }),
    reserve_percent !== null &&
      svg(
        "line",
        { class: "battery-reserve", x1: x(0), x2: last.at, y1: y(reserve_percent), y2: y(reserve_percent) },
        svg("title", {}, t("Kept in reserve")),
      ),
    svg("polyline", { class: "battery-curve", points: points.join(" ") }),
    svg("text", { class: "tick", x: x(0) + 2, y: BATTERY_PX.empty - 4 }, t("Battery")),
  ];
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

/** @typedef {{ at_m: number, ground_m: number }} Known a place whose ground is known */

/** Runs of samples whose ground is known, two at least. @param {GroundSample[]} samples */
function knownPieces(samples) {
  /** @type {Known[][]} */
  const pieces = [];
  /** @type {Known[]} */
  let piece = [];
  for (const { at_m, ground_m } of samples) {
    if (ground_m === null) piece = [];
    else if (piece.push({ at_m, ground_m }) === 1) pieces.push(piece);
  }
  return pieces.filter(({ length }) => length > 1);
}

/**
 * The profile as a table: each task point with distance, ground and height, and where they are known arrival and
 * battery.
 *
 * @param {Pick<ShownRoute, "name">} route
 * @param {Flight} flight
 * @param {(Pick<PickedTarget, "label"> | undefined)[]} targets
 * @param {string | null} departs_at
 */
export function profileTable(route, flight, targets, departs_at) {
  /** @param {number | null} height */
  const heightOrUnknown = (height) => (height === null ? t("not known") : heightText(height));
  const hasTimes = flight.path.some(({ arrival_s }) => arrival_s !== null);
  const columns = [
    t("Target"),
    t("Distance flown"),
    t("Ground"),
    flight.isFlat ? t("Height above take-off") : t("Height above sea level"),
    hasTimes && t("Arrival"),
    flight.hasBattery && t("Battery left"),
  ];
  const rows = flight.tasks.map(({ target, at_m }) => {
    const at = readingAt(flight, at_m);
    return [
      targets[target ?? -1]?.label ?? t("Target"),
      lengthText(at_m),
      heightOrUnknown(at.ground_m),
      heightOrUnknown(at.height_m),
      hasTimes && timeAt(departs_at, at.arrival_s),
      flight.hasBattery && percentText(at.battery_percent ?? 0),
    ];
  });
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
        columns.filter(Boolean).map((words) => h("th", { scope: "col" }, words)),
      ),
    ),
    h(
      "tbody",
      {},
      rows.map((cells) =>
        h(
          "tr",
          {},
          cells.filter(Boolean).map((words) => h("td", {}, words)),
        ),
      ),
    ),
  );
}
