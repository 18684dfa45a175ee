/** All wires of a scene as polylines in the frame: from slot to slot, with their sag. */

import { direction } from "../frame.js";
import { hang, piecesFor } from "./catenary.js";

/** @import { Scene, Support } from "../../api_types.d.ts" */
/** @import { Frame, Vector } from "../types.d.ts" */

/** @typedef {ReturnType<typeof standing>} Stand */
/** @typedef {ReturnType<typeof wiresOf>} Wires */

/**
 * A support's foot in the frame, and its axes on the ground: { foot: [x, y, z], along: [x, z], across: [x, z] (to the right) }.
 *
 * @param {Support} support
 * @param {Frame} frame
 */
export function standing(support, frame) {
  const along = direction(support.bearing_deg);
  const { position, ground_amsl_m } = support;
  return { foot: frame.toLocal(position[0], position[1], ground_amsl_m), along, across: [-along[1], along[0]] };
}

/**
 * The point in the frame of a slot of a support: [across_m, height_m].
 *
 * @param {Stand} stand
 * @param {readonly number[]} slot
 * @returns {Vector}
 */
export function slotPoint({ foot, across }, [across_m, height_m]) {
  return [foot[0] + across_m * across[0], foot[1] + height_m, foot[2] + across_m * across[1]];
}

/**
 * Gives { points: Float64Array (x, y, z …), first: Uint32Array (n + 1: a wire's first point), span: Uint32Array (n), isEarth: Uint8Array (n) }.
 *
 * @param {Scene} scene
 * @param {Frame} frame
 */
export function wiresOf(scene, frame) {
  const stands = scene.supports.map((support) => standing(support, frame));
  /** @type {number[]} */
  const points = [];
  const first = [0];
  /** @type {number[]} */
  const span = [];
  /** @type {number[]} */
  const isEarth = [];
  /** @param {Vector} start @param {Vector} end @param {number} sag_m @param {number} number @param {0 | 1} earth */
  const add = (start, end, sag_m, number, earth) => {
    hang(start, end, sag_m, piecesFor(sag_m), points);
    first.push(points.length / 3);
    span.push(number);
    isEarth.push(earth);
  };
  scene.spans.forEach((own, number) => {
    const ends = [own.from, own.to].map((place) => ({ support: scene.supports[place], stand: stands[place] }));
    const [phases, earth] = [pairs(ends, "slots", own.phases), pairs(ends, "earth", own.earth)];
    for (const [start, end] of phases) add(start, end, own.sag_m, number, 0);
    for (const [start, end] of earth) add(start, end, own.sag_m * scene.rules.earth_sag_share, number, 1);
  });
  return {
    points: Float64Array.from(points),
    first: Uint32Array.from(first),
    span: Uint32Array.from(span),
    isEarth: Uint8Array.from(isEarth),
  };
}

/**
 * Pairs of slots to connect: both ends sorted from left to right as seen from the span's start, then from below.
 *
 * @param {{ support: Support, stand: Stand }[]} ends
 * @param {"slots" | "earth"} kind
 * @param {number} wanted
 */
function pairs(ends, kind, wanted) {
  const [start, end] = ends.map(({ stand }) => stand);
  const [x, z] = [end.foot[0] - start.foot[0], end.foot[2] - start.foot[2]];
  const length = Math.hypot(x, z) || 1;
  const right = [-z / length, x / length];
  const sorted = ends.map(({ support, stand }) => {
    const turned = stand.across[0] * right[0] + stand.across[1] * right[1] < 0 ? -1 : 1;
    return chosen(support[kind], wanted)
      .sort((one, other) => turned * (one[0] - other[0]) || one[1] - other[1])
      .map((slot) => slotPoint(stand, slot));
  });
  return Array.from({ length: Math.min(wanted, sorted[0].length, sorted[1].length) }, (_, place) => [
    sorted[0][place],
    sorted[1][place],
  ]);
}

/**
 * The slots to use where there are more than wires: those of one side if they suffice, else the inner ones.
 *
 * @param {readonly number[][]} slots
 * @param {number} wanted
 */
function chosen(slots, wanted) {
  if (slots.length <= wanted) return [...slots];
  const side = slots.filter(([across_m]) => across_m > 0);
  const from = side.length >= wanted ? side : slots;
  return [...from].sort((one, other) => Math.abs(one[0]) - Math.abs(other[0]) || one[1] - other[1]).slice(0, wanted);
}
