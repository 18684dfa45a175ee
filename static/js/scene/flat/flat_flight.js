/** Ways and UAVs from above, on a plain canvas: planned thin and dashed, flown solid, estimated hollow in its ring. */

import { ESTIMATED, LOST, MEASURED } from "../sources/pieces.js";

/** @import { FlownRoute, PlannedLine } from "../flight/drawn_flight.js" */
/** @import { Bound, DrawnUav, ScenePalette, Vector } from "../types.d.ts" */

/** @typedef {(place: Vector) => [x: number, y: number]} OnScreen */

const ROUTES = 8;
const DART = [
  [0, -13],
  [9, 11],
  [0, 6],
  [-9, 11],
];
const REST = 0.35; // of routes that are not selected
const MIN_RING_PX = 14;

/** @param {ScenePalette} palette @param {number} place */
const colourOf = (palette, place) => palette.routes[place % ROUTES];

/**
 * @param {CanvasRenderingContext2D} context
 * @param {readonly number[]} positions
 * @param {OnScreen} onScreen
 * @param {number} [until]
 */
function stroke(context, positions, onScreen, until = Infinity) {
  context.beginPath();
  for (let at = 0; at < positions.length && at / 3 < until; at += 3)
    context.lineTo(...onScreen([positions[at], positions[at + 1], positions[at + 2]])); // the first begins it
  context.stroke();
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {object} ways
 * @param {readonly PlannedLine[]} ways.planned
 * @param {readonly FlownRoute[]} ways.flown
 * @param {OnScreen} ways.onScreen
 * @param {ScenePalette} ways.palette
 * @param {number | null} ways.at_ms
 * @param {number | null} ways.looked a route's place
 */
export function drawWays(context, { planned, flown, onScreen, palette, at_ms, looked }) {
  /** @param {number} place */
  const light = (place) => {
    context.globalAlpha = looked === null || looked === place ? 1 : REST;
  };
  context.lineJoin = "round";
  for (const { place, positions } of planned) {
    light(place);
    context.strokeStyle = colourOf(palette, place);
    context.lineWidth = 1.6;
    context.setLineDash([6, 4]);
    stroke(context, positions, onScreen);
  }
  for (const { place, pieces } of flown) {
    light(place);
    context.strokeStyle = colourOf(palette, place);
    context.lineWidth = 3.6;
    for (const { kind, positions, at_ms: times } of pieces) {
      if (at_ms !== null && times[0] > at_ms) continue;
      const after = at_ms === null ? -1 : times.findIndex((time) => time > at_ms);
      context.setLineDash(kind === ESTIMATED ? [1, 5] : []);
      stroke(context, positions, onScreen, after < 0 ? Infinity : after + 1);
    }
  }
  context.setLineDash([]);
  context.globalAlpha = 1;
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {object} uavs
 * @param {readonly DrawnUav[]} uavs.drawn
 * @param {number | null} uavs.chosen
 * @param {OnScreen} uavs.onScreen
 * @param {ScenePalette} uavs.palette
 * @param {number} uavs.metresPerPixel
 * @param {number} uavs.turn
 */
export function drawUavs(context, { drawn, chosen, onScreen, palette, metresPerPixel, turn }) {
  for (const uav of drawn) {
    const { kind, bound } = uav.moment;
    const [x, y] = onScreen(uav.place);
    context.save();
    context.translate(x, y);
    context.strokeStyle = kind === LOST ? palette.inkSecond : uav.colour;
    if (kind === ESTIMATED && bound) ring(context, bound, metresPerPixel, turn, uav.colour);
    context.rotate((uav.heading_deg * Math.PI) / 180 - turn);
    context.beginPath();
    for (const [right, down] of DART) context.lineTo(right, down);
    context.closePath();
    context.fillStyle = kind === MEASURED ? uav.colour : palette.raised;
    context.lineWidth = kind === MEASURED ? 2 : 2.75;
    if (kind === MEASURED) context.strokeStyle = palette.casing;
    context.fill();
    context.stroke();
    if (uav.route === chosen) {
      context.strokeStyle = palette.select;
      context.lineWidth = 2;
      context.beginPath();
      context.arc(0, 0, 19, 0, 2 * Math.PI);
      context.stroke();
    }
    context.restore();
  }
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {Bound} bound
 * @param {number} metresPerPixel
 * @param {number} turn
 * @param {string} colour
 */
function ring(context, { along_m, across_m, bearing_deg }, metresPerPixel, turn, colour) {
  context.save();
  context.rotate((bearing_deg * Math.PI) / 180 - turn);
  context.beginPath();
  context.ellipse(
    0,
    0,
    Math.max(MIN_RING_PX, across_m / metresPerPixel),
    Math.max(MIN_RING_PX, along_m / metresPerPixel),
    0,
    0,
    2 * Math.PI,
  );
  context.globalAlpha = 0.15;
  context.fillStyle = colour;
  context.fill();
  context.globalAlpha = 1;
  context.strokeStyle = colour;
  context.lineWidth = 1.5;
  context.setLineDash([5, 4]);
  context.stroke();
  context.restore();
}
