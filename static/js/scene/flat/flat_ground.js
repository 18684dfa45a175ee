/** Zones, railways, bridges, lines and towers from above, on a plain canvas. */

/** @import { Scene, SceneZone } from "../../api_types.d.ts" */
/** @import { Frame, ScenePalette } from "../types.d.ts" */
/** @import { OnScreen } from "./flat_flight.js" */

/** @typedef {"volt400" | "volt220" | "volt132" | "volt66" | "volt20" | "voltUnknown"} VoltageColour */
/** @typedef {(place: number[]) => [x: number, y: number]} PlaceOnScreen of lon, lat */
/**
 * @typedef {object} FlatLook
 * @property {OnScreen} onScreen
 * @property {ScenePalette} palette
 * @property {number} metresPerPixel
 * @property {{ width: number, height: number }} size
 */

/** @type {[least_v: number, colour: VoltageColour, width_px: number][]} */
const VOLTAGES = [
  [380_000, "volt400", 3],
  [200_000, "volt220", 2.2],
  [100_000, "volt132", 1.6],
  [50_000, "volt66", 1.1],
  [0, "volt20", 0.8],
];
const GRID_M = [10, 20, 50, 100, 200, 500, 1_000, 2_000, 5_000, 10_000];
const GRID_PX = 70;
const TOWERS_PX = 0.18; // pixels a metre, from which on towers are drawn
const HATCH_PX = 9;

/** @param {number | null} voltage_v @returns {[least_v: number, colour: VoltageColour, width_px: number]} */
const lookOf = (voltage_v) =>
  (voltage_v === null ? undefined : VOLTAGES.find(([least]) => voltage_v >= least)) ?? [0, "voltUnknown", 1.2];

/** @param {CanvasRenderingContext2D} context @param {FlatLook & { scene: Scene, frame: Frame }} ground */
export function drawGround(context, { scene, frame, onScreen, palette, metresPerPixel, size }) {
  /** @type {PlaceOnScreen} */
  const at = ([lon, lat]) => onScreen(frame.toLocal(lon, lat, 0));
  graticule(context, { onScreen, palette, metresPerPixel, size });
  for (const zone of scene.zones) drawZone(context, zone, at, palette);
  /** @param {readonly number[][]} places @param {string} colour @param {number} width @param {number[]} [dash] */
  const line = (places, colour, width, dash = []) => {
    context.beginPath();
    for (const place of places) context.lineTo(...at(place)); // the first begins it
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.setLineDash(dash);
    context.stroke();
  };
  for (const { line: places } of scene.railways) {
    line(places, palette.railway, 2.2);
    line(places, palette.ground, 1.2, [5, 5]);
  }
  for (const { polygons } of scene.bridges)
    for (const rings of polygons) for (const outline of rings) line(outline, palette.bridge, 1.6);
  for (const span of scene.spans) {
    const [, name, width] = lookOf(span.voltage_v);
    line(
      [scene.supports[span.from].position, scene.supports[span.to].position],
      palette[name],
      width,
      name === "voltUnknown" ? [4, 2] : [],
    );
  }
  context.setLineDash([]);
  if (1 / metresPerPixel < TOWERS_PX) return;
  context.fillStyle = palette.ground;
  context.strokeStyle = palette.tower;
  context.lineWidth = 1.4;
  for (const { kind, position } of scene.supports) {
    if (kind === "vertex") continue;
    const [x, y] = at(position);
    if (x < -9 || y < -9 || x > size.width + 9 || y > size.height + 9) continue;
    context.beginPath();
    context.arc(x, y, kind === "pole" ? 2 : 3, 0, 2 * Math.PI);
    context.fill();
    context.stroke();
  }
}

/** @param {CanvasRenderingContext2D} context @param {FlatLook} look */
function graticule(context, { onScreen, palette, metresPerPixel, size }) {
  const step = GRID_M.find((metres) => metres / metresPerPixel >= GRID_PX) ?? GRID_M[GRID_M.length - 1];
  const reach = Math.ceil((Math.hypot(size.width, size.height) * metresPerPixel) / step) + 1;
  const [cx, cy] = onScreen([0, 0, 0]);
  const middle = [
    Math.round(((size.width / 2 - cx) * metresPerPixel) / step),
    Math.round(((size.height / 2 - cy) * metresPerPixel) / step),
  ];
  context.strokeStyle = palette.graticule;
  context.lineWidth = 1;
  context.setLineDash([]);
  context.beginPath();
  for (let number = -reach; number <= reach; number += 1) {
    const [x, z] = [(middle[0] + number) * step, (middle[1] + number) * step];
    context.moveTo(...onScreen([x, 0, (middle[1] - reach) * step]));
    context.lineTo(...onScreen([x, 0, (middle[1] + reach) * step]));
    context.moveTo(...onScreen([(middle[0] - reach) * step, 0, z]));
    context.lineTo(...onScreen([(middle[0] + reach) * step, 0, z]));
  }
  context.stroke();
}

/**
 * Filled, hatched and outlined, as on the map.
 *
 * @param {CanvasRenderingContext2D} context
 * @param {SceneZone} zone
 * @param {PlaceOnScreen} at
 * @param {ScenePalette} palette
 */
function drawZone(context, { polygons }, at, palette) {
  context.save();
  context.beginPath();
  let box = [Infinity, Infinity, -Infinity, -Infinity];
  for (const rings of polygons) {
    for (const ring of rings) {
      ring.forEach((place, index) => {
        const [x, y] = at(place);
        box = [Math.min(box[0], x), Math.min(box[1], y), Math.max(box[2], x), Math.max(box[3], y)];
        context[index ? "lineTo" : "moveTo"](x, y);
      });
      context.closePath();
    }
  }
  context.strokeStyle = palette.zone;
  context.fillStyle = palette.zoneFill;
  context.setLineDash([]);
  context.fill("evenodd");
  context.lineWidth = 1.75;
  context.stroke();
  context.clip("evenodd");
  context.lineWidth = 1;
  context.globalAlpha = 0.5;
  context.beginPath();
  const [west, north, east, south] = [
    Math.max(box[0], -50),
    Math.max(box[1], -50),
    Math.min(box[2], context.canvas.width + 50),
    Math.min(box[3], context.canvas.height + 50),
  ];
  for (let x = west - (south - north); x < east; x += HATCH_PX) {
    context.moveTo(x, south);
    context.lineTo(x + (south - north), north);
  }
  context.stroke();
  context.restore();
}
