/** A small drawing of a mission's routes, without a map. */

import { h, icon, svg } from "../dom.js";
import { routeNumber } from "../map/palette.js";

const WIDTH_PX = 112;
const HEIGHT_PX = 56;
const MARGIN_PX = 8;

/** Places in the drawing, shape kept: [[[x, y], …] per route]. Longitudes shrink with the latitude. */
export function placeSketch(routes, width = WIDTH_PX, height = HEIGHT_PX, margin = MARGIN_PX) {
  const all = routes.flat();
  if (!all.length) return [];
  const latitude = all.reduce((sum, [, lat]) => sum + lat, 0) / all.length;
  const shrink = Math.max(0.05, Math.cos((latitude * Math.PI) / 180));
  const flat = routes.map((route) => route.map(([lon, lat]) => [lon * shrink, -lat]));
  const xs = flat.flat().map(([x]) => x);
  const ys = flat.flat().map(([, y]) => y);
  const [left, top] = [Math.min(...xs), Math.min(...ys)];
  const [spanX, spanY] = [Math.max(...xs) - left, Math.max(...ys) - top];
  const scale = Math.min(spanX ? (width - 2 * margin) / spanX : Infinity, spanY ? (height - 2 * margin) / spanY : Infinity);
  const factor = Number.isFinite(scale) ? scale : 1;
  const [offX, offY] = [(width - spanX * factor) / 2, (height - spanY * factor) / 2];
  return flat.map((route) => route.map(([x, y]) => [offX + (x - left) * factor, offY + (y - top) * factor]));
}

export function sketch(routes) {
  const places = placeSketch(routes ?? []);
  if (!places.length) return h("span", { class: "sketch none" }, icon("pencil", "small"), "not planned");
  return svg(
    "svg",
    { class: "sketch", viewBox: `0 0 ${WIDTH_PX} ${HEIGHT_PX}`, "aria-hidden": "true" },
    places.map((route, sequence) =>
      route.length
        ? svg(
            "g",
            { class: `route-${routeNumber(sequence)}` },
            svg("path", { d: route.map(([x, y], index) => `${index ? "L" : "M"}${x.toFixed(1)} ${y.toFixed(1)}`).join("") }),
            svg("circle", { cx: route[0][0].toFixed(1), cy: route[0][1].toFixed(1), r: 2.5 }),
          )
        : null,
    ),
  );
}
