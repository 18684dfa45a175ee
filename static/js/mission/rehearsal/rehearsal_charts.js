/** Height and battery of one rehearsed route over time: planned dashed, flown in simulation solid. */

import { h, svg } from "../../dom.js";
import { routeNumber } from "../../domain/palette.js";
import { t } from "../../text.js";
import { durationText, heightText, percentText, SHORT_UNIT } from "../../units.js";
import { curvesOf, rulesUpTo } from "./rehearsal.js";

/** @import { RouteTrack } from "../../api_types.d.ts" */

/** @typedef {{ at_s: number, value: number }[]} Line */
/**
 * @typedef {object} ChartOptions
 * @property {string} words
 * @property {Line[]} flown
 * @property {Line[]} planned
 * @property {number | null} [limit]
 * @property {number | null} [highest]
 * @property {number} unit of the rules
 * @property {(value: number) => string} text
 * @property {number} height_px
 * @property {number} longest_s
 * @property {number} place of the UAV in the mission
 * @property {number} width_px
 */

const [TOP_PX, BOTTOM_PX, LEFT_PX] = [8, 14, 44];
const PANEL_PX = 344; // of the panel; the drawing is scaled to it

/** @param {ChartOptions} options */
function chart({
  words,
  flown,
  planned,
  limit = null,
  highest = null,
  unit,
  text,
  height_px,
  longest_s,
  place,
  width_px,
}) {
  const values = [...flown, ...planned].flat().map(({ value }) => value);
  const top = highest ?? Math.max(unit, ...values) * 1.05;
  const bottom = Math.min(0, ...values);
  /** @param {number} at_s */
  const x = (at_s) => LEFT_PX + (at_s / longest_s) * (width_px - LEFT_PX - 2);
  /** @param {number} value */
  const y = (value) => TOP_PX + ((top - value) / (top - bottom)) * (height_px - TOP_PX - BOTTOM_PX);
  /** @param {Line} points @param {string} name */
  const line = (points, name) =>
    svg("polyline", {
      class: name,
      points: points.map(({ at_s, value }) => `${x(at_s).toFixed(1)},${y(value).toFixed(1)}`).join(" "),
    });
  return h(
    "figure",
    { class: "rehearsal-chart" },
    h("figcaption", {}, words),
    svg(
      "svg",
      {
        role: "img",
        "aria-label": words,
        viewBox: `0 0 ${width_px} ${height_px}`,
        class: `route-${routeNumber(place)}`,
      },
      [0, ...rulesUpTo(top / unit).map((rule) => rule * unit)].map((rule) => [
        svg("line", { class: "rule", x1: LEFT_PX, x2: width_px, y1: y(rule), y2: y(rule) }),
        svg("text", { class: "tick", x: LEFT_PX - 6, y: y(rule) + 4 }, text(rule)),
      ]),
      limit !== null && svg("line", { class: "limit", x1: LEFT_PX, x2: width_px, y1: y(limit), y2: y(limit) }),
      planned.map((points) => line(points, "planned")),
      flown.map((points) => line(points, "flown")),
    ),
  );
}

/** route: of the track; reserve_percent: of its plan. @param {RouteTrack} route @param {number} reserve_percent @param {number} [width_px] */
export function drawCharts(route, reserve_percent, width_px = PANEL_PX) {
  const { flown, planned } = curvesOf(route);
  const longest_s = Math.max(1, ...[...flown.height, ...planned.height].flat().map(({ at_s }) => at_s));
  const place = route.uav;
  return h(
    "div",
    { class: "rehearsal-charts" },
    chart({
      words: t("Height above take-off by time"),
      flown: flown.height,
      planned: planned.height,
      unit: SHORT_UNIT.metres,
      text: heightText,
      height_px: 104,
      longest_s,
      place,
      width_px,
    }),
    chart({
      words: t("Battery by time"),
      flown: flown.battery,
      planned: planned.battery,
      limit: reserve_percent,
      highest: 100,
      unit: 1,
      text: percentText,
      height_px: 84,
      longest_s,
      place,
      width_px,
    }),
    h("p", { class: "rehearsal-axis" }, h("span", {}, t("departure")), h("span", {}, durationText(longest_s))),
    h(
      "ul",
      { class: "rehearsal-key", "aria-label": t("How the lines are drawn") },
      [
        ["flown", t("flown in simulation")],
        ["planned", t("planned")],
        ["limit", t("reserve")],
      ].map(([name, words]) =>
        h(
          "li",
          {},
          svg(
            "svg",
            { width: 22, height: 8, "aria-hidden": "true", class: `route-${routeNumber(place)}` },
            svg("line", { class: name, x1: 0, x2: 22, y1: 4, y2: 4 }),
          ),
          words,
        ),
      ),
    ),
  );
}
