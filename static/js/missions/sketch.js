/** A small drawing of a mission's routes over the lines round them, without a map. */

import { h, icon, svg } from "../dom.js";
import { routeNumber } from "../domain/palette.js";
import { t } from "../text.js";

const WIDTH_PX = 112;
const HEIGHT_PX = 56;
const MARGIN_PX = 8;
const MIN_SPAN_DEG = 0.008; // of latitude: a single target is drawn with its surroundings

/** @import { MissionSummary } from "../api_types.d.ts" */

/** @typedef {(place: readonly number[]) => [number, number]} Projection from longitude, latitude to pixels */

/**
 * From degrees to places in the drawing, shape kept, so that all of `places` fit. Longitudes shrink with the latitude. Null without places.
 *
 * @param {readonly (readonly number[])[]} places
 * @returns {Projection | null}
 */
export function fitTo(places, width = WIDTH_PX, height = HEIGHT_PX, margin = MARGIN_PX, leastSpan = MIN_SPAN_DEG) {
  if (!places.length) return null;
  const latitude = places.reduce((sum, [, lat]) => sum + lat, 0) / places.length;
  const shrink = Math.max(0.05, Math.cos((latitude * Math.PI) / 180));
  const xs = places.map(([lon]) => lon * shrink);
  const ys = places.map(([, lat]) => -lat);
  const [left, right, top, bottom] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  const scale = Math.min(
    (width - 2 * margin) / Math.max(right - left, leastSpan),
    (height - 2 * margin) / Math.max(bottom - top, leastSpan),
  );
  const [offX, offY] = [width / 2 - ((left + right) / 2) * scale, height / 2 - ((top + bottom) / 2) * scale];
  return ([lon, lat]) => [lon * shrink * scale + offX, -lat * scale + offY];
}

/** @param {readonly (readonly number[])[]} line @param {Projection} place */
const pathOf = (line, place) =>
  line
    .map(
      (at, index) =>
        `${index ? "L" : "M"}${place(at)
          .map((px) => px.toFixed(1))
          .join(" ")}`,
    )
    .join("");

/** @param {Partial<Pick<MissionSummary, "sketch" | "places" | "lines">>} mission */
export function sketch({ sketch: routes = [], places = [], lines = [] }) {
  const place = fitTo([...routes.flat(), ...places]);
  if (!place) return h("span", { class: "sketch none" }, icon("pencil", "small"), t("nothing picked"));
  const isPlanned = routes.some((route) => route.length);
  return svg(
    "svg",
    { class: "sketch", viewBox: `0 0 ${WIDTH_PX} ${HEIGHT_PX}`, "aria-hidden": "true" },
    svg("path", { class: "around", d: lines.map((line) => pathOf(line, place)).join("") }),
    !isPlanned &&
      places.map((at) =>
        svg("circle", { class: "picked", cx: place(at)[0].toFixed(1), cy: place(at)[1].toFixed(1), r: 2 }),
      ),
    routes.map((route, sequence) =>
      route.length
        ? svg(
            "g",
            { class: `route-${routeNumber(sequence)}` },
            svg("path", { d: pathOf(route, place) }),
            svg("circle", { cx: place(route[0])[0].toFixed(1), cy: place(route[0])[1].toFixed(1), r: 2.5 }),
          )
        : null,
    ),
  );
}
