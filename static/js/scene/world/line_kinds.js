/**
 * Things drawn as lines, with colours and widths: wires by voltage, rails, edges of zones. Each as [segments, tints, sizes] of lines.js.
 */

import { voltageColour } from "../../map/look/voltages.js";
import { Color } from "../three.js";

/** @import { Scene } from "../../api_types.d.ts" */
/** @import { Wires } from "../geometry/wires.js" */
/** @import { ScenePalette, Segments } from "../types.d.ts" */
/** @import { ShownVolume } from "./zones.js" */

/** @typedef {Pick<ScenePalette, "railway" | "ink" | "tower" | "ground" | "zone">} LinePalette */

const WIRE_PX = [
  [380_000, 1.5],
  [200_000, 1.35],
  [100_000, 1.2],
  [0, 1],
];
const WIRE_M = 0.11; // a bundle, or a rope with the eye's help
const EARTH = { px: 0.8, m: 0.05 };
const RAIL = { px: 0.7, m: 0.14 };
const RAIL_WIRE = { px: 0.65, m: 0.05 };
const EDGE_PX = 1.6;
const REST_DASH_M = 40;
const COUNTED = { px: 0.9, dash_m: 4, faint: 0.35 };

/** @param {Wires} wires @param {Pick<Scene, "spans"> | null} scene @param {ScenePalette} palette */
export function wireSegments({ points, first, span, isEarth }, scene, palette) {
  const count = span.length ? points.length / 3 - span.length : 0;
  const lines = arrays(count);
  const colour = new Color();
  let at = 0;
  for (let wire = 0; wire < span.length; wire += 1) {
    const voltage_v = scene?.spans[span[wire]].voltage_v ?? null;
    colour.set(voltageColour(palette, voltage_v === null ? null : voltage_v / 1_000));
    const px = isEarth[wire] ? EARTH.px : (WIRE_PX.find(([least]) => (voltage_v ?? 0) >= least)?.[1] ?? 1);
    for (let point = first[wire]; point < first[wire + 1] - 1; point += 1) {
      lines.put(at, points.subarray(point * 3, point * 3 + 6), colour, 0, px, isEarth[wire] ? EARTH.m : WIRE_M);
      at += 1;
    }
  }
  return lines.all;
}

/** @param {readonly Float32Array[]} rails @param {LinePalette} palette */
export function railSegments(rails, palette) {
  return ofOneLook(rails, new Color(palette.railway).lerp(new Color(palette.ink), 0.35), RAIL);
}

/** @param {readonly Float32Array[]} wires @param {LinePalette} palette */
export function railWireSegments(wires, palette) {
  return ofOneLook(wires, new Color(palette.tower), RAIL_WIRE);
}

/** @param {Float32Array} marks of countedAir @param {LinePalette} palette */
export function countedSegments(marks, palette) {
  const { px, dash_m, faint } = COUNTED;
  return ofOneLook([marks], new Color(palette.tower).lerp(new Color(palette.ground), faint), { px, m: 0, dash_m });
}

/**
 * @param {readonly Float32Array[]} pieces segments: x, y, z, x, y, z
 * @param {Color} colour
 * @param {{ px: number, m: number, dash_m?: number }} size
 */
function ofOneLook(pieces, colour, { px, m, dash_m = 0 }) {
  const lines = arrays(pieces.reduce((sum, own) => sum + own.length / 6, 0));
  let at = 0;
  for (const own of pieces) {
    for (let place = 0; place < own.length; place += 6) {
      lines.put(at, own.subarray(place, place + 6), colour, dash_m, px, m);
      at += 1;
    }
  }
  return lines.all;
}

/** @param {readonly Pick<ShownVolume, "edges" | "isInForce">[]} volumes @param {LinePalette} palette */
export function edgeSegments(volumes, palette) {
  const lines = arrays(volumes.reduce((sum, { edges }) => sum + edges.length / 6, 0));
  const colour = new Color(palette.zone);
  let at = 0;
  for (const { edges, isInForce } of volumes) {
    for (let place = 0; place < edges.length; place += 6) {
      lines.put(
        at,
        edges.subarray(place, place + 6),
        colour,
        isInForce ? 0 : REST_DASH_M,
        isInForce ? EDGE_PX : 1.2,
        0,
      );
      at += 1;
    }
  }
  return lines.all;
}

/** @param {number} count */
function arrays(count) {
  /** @type {Segments} */
  const all = [new Float32Array(count * 6), new Float32Array(count * 4), new Float32Array(count * 2)];
  const [segments, tints, sizes] = all;
  return {
    all,
    /**
     * @param {number} at
     * @param {Float32Array | Float64Array} ends
     * @param {Color} colour
     * @param {number} dash_m
     * @param {number} px
     * @param {number} metres
     */
    put(at, ends, colour, dash_m, px, metres) {
      segments.set(ends, at * 6);
      tints.set([colour.r, colour.g, colour.b, dash_m], at * 4);
      sizes.set([px, metres], at * 2);
    },
  };
}
