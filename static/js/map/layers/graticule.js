/** Faint lines of longitude and latitude, where there is no base map. */

import { sourceOf } from "../look/style.js";

/** @import { Box, MapLibreMap, Position } from "../types.d.ts" */

const STEPS_DEG = [30, 15, 10, 5, 2, 1, 0.5, 0.25, 0.1, 0.05, 0.025, 0.01, 0.005, 0.0025, 0.001];
const WANTED_PX = 150;

/** The step whose lines are nearest to 150 px apart. @param {number} zoom */
export function graticuleStep(zoom) {
  const degrees_per_px = 360 / (512 * 2 ** zoom);
  return STEPS_DEG.reduce((best, step) =>
    Math.abs(Math.log(step / degrees_per_px / WANTED_PX)) < Math.abs(Math.log(best / degrees_per_px / WANTED_PX))
      ? step
      : best,
  );
}

/**
 * Lines over [west, south, east, north] and one step beyond, as a MultiLineString.
 *
 * @param {Box} box
 * @param {number} step [deg]
 * @returns {{ type: "MultiLineString", coordinates: Position[][] }}
 */
export function graticuleLines([west, south, east, north], step) {
  /** @param {number} low */
  const from = (low) => Math.floor(low / step) - 1;
  /** @param {number} high */
  const to = (high) => Math.ceil(high / step) + 1;
  const bottom = Math.max(-85, from(south) * step);
  const top = Math.min(85, to(north) * step);
  /** @type {Position[][]} */
  const lines = [];
  for (let index = from(west); index <= to(east); index += 1)
    lines.push([
      [index * step, bottom],
      [index * step, top],
    ]);
  for (let index = from(south); index <= to(north); index += 1) {
    const latitude = index * step;
    if (Math.abs(latitude) <= 85)
      lines.push([
        [from(west) * step, latitude],
        [to(east) * step, latitude],
      ]);
  }
  return { type: "MultiLineString", coordinates: lines };
}

/** @param {MapLibreMap} map */
export function addTo(map) {
  const draw = () => update(map);
  map.on("moveend", draw);
  draw();
}

/** @param {MapLibreMap} map */
export function update(map) {
  const bounds = map.getBounds();
  /** @type {Box} */
  const frame = [bounds.getWest(), bounds.getSouth(), bounds.getEast(), bounds.getNorth()];
  sourceOf(map, "graticule")?.setData({
    type: "Feature",
    properties: {},
    geometry: graticuleLines(frame, graticuleStep(map.getZoom())),
  });
}
