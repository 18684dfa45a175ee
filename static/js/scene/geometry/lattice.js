/** A tower of steel lattice: four legs that meet at the lowest arm and go up as a slim body, arms as wedges, crosses between the legs. */

/** @import { Support } from "../../api_types.d.ts" */
/** @import { DrawSupport, Vector } from "../types.d.ts" */

/** @typedef {Support & { depth_m: number }} DrawnSupport depth_m: of its foundations */

/** @type {[across: number, along: number][]} */
const SIDES = [
  [-1, -1],
  [1, -1],
  [1, 1],
  [-1, 1],
]; // corners as signs across and along, in turn

/**
 * Points are [across, up, along].
 *
 * @param {DrawnSupport} support
 * @param {DrawSupport} draw
 * @param {{ foot_m?: number, waist_m?: number }} [how]
 */
export function lattice(support, draw, { foot_m = footOf(support), waist_m = waistOf(support) } = {}) {
  const { height_m, arms } = support;
  const [legs_m, brace_m] = [0.16 + height_m * 0.0032, 0.07 + height_m * 0.0011];
  const lowest_m = arms.length ? Math.min(...arms.map(([arm]) => arm)) : height_m * 0.8;
  if (isDelta(support)) return delta(support, draw, { foot_m, waist_m: waist_m * 0.9, legs_m, brace_m });
  const highest_m = arms.length ? Math.max(...arms.map(([arm]) => arm)) : height_m * 0.9;
  const top_m = waist_m * 0.55;
  body(draw, { low: 0, high: lowest_m, lowHalf_m: foot_m / 2, highHalf_m: waist_m / 2, legs_m, brace_m });
  if (highest_m > lowest_m + 0.5) {
    body(draw, {
      low: lowest_m,
      high: highest_m,
      lowHalf_m: waist_m / 2,
      highHalf_m: top_m / 2,
      legs_m: legs_m * 0.8,
      brace_m: brace_m * 0.85,
    });
  }
  /** @param {number} up */
  const half = (up) =>
    (highest_m > lowest_m ? waist_m + ((top_m - waist_m) * (up - lowest_m)) / (highest_m - lowest_m) : waist_m) / 2;
  for (const arm of arms) wedge(draw, arm, half(arm[0]), brace_m);
  const peak = half(highest_m);
  if (height_m > highest_m + 0.1)
    for (const [a, b] of SIDES) draw.outline([a * peak, highest_m, b * peak], [0, height_m, 0], legs_m * 0.6);
  footings(draw, foot_m, legs_m, support.depth_m);
}

/** @param {Support} support */
function footOf({ height_m }) {
  return Math.min(Math.max(height_m * 0.17, 2.5), 14);
}

/** @param {Support} support */
function waistOf({ height_m, voltage_v }) {
  return Math.min(Math.max(height_m * 0.03 + (voltage_v ?? 110_000) / 400_000, 0.9), 3.4);
}

/** One level with a phase in the axis and two earth wires: that phase hangs in a window. @param {Support} support */
function isDelta({ arms, slots, earth }) {
  return arms.length === 1 && slots.some(([across]) => Math.abs(across) < 0.01) && earth.length === 2;
}

/**
 * Four legs between two heights; near by with crosses and rings, higher than wide each.
 *
 * @param {DrawSupport} draw
 * @param {{ low: number, high: number, lowHalf_m: number, highHalf_m: number, legs_m: number, brace_m: number }} how
 */
function body({ outline, fine }, { low, high, lowHalf_m, highHalf_m, legs_m, brace_m }) {
  /** @param {number} up */
  const half = (up) => lowHalf_m + ((highHalf_m - lowHalf_m) * (up - low)) / (high - low);
  /** @param {[across: number, along: number]} side @param {number} up @returns {Vector} */
  const corner = ([a, b], up) => [a * half(up), up, b * half(up)];
  for (const side of SIDES) outline(corner(side, low), corner(side, high), legs_m);
  for (const [from, to] of panels(low, high, half)) {
    SIDES.forEach((side, number) => {
      const next = SIDES[(number + 1) % 4];
      fine(corner(side, from), corner(next, to), brace_m);
      fine(corner(next, from), corner(side, to), brace_m);
      fine(corner(side, to), corner(next, to), brace_m);
    });
  }
}

/**
 * Heights of the crosses' ends: each cross as high as the body is wide there, at most nine.
 *
 * @param {number} low
 * @param {number} high
 * @param {(up: number) => number} half
 * @returns {[from: number, to: number][]}
 */
function panels(low, high, half) {
  const heights = [low];
  for (let up = low; up < high - 0.1 && heights.length < 10; ) {
    up = Math.min(high, up + Math.max(2 * half(up) * 1.05, (high - low) / 9));
    heights.push(up);
  }
  const [before, last] = heights.slice(-3);
  if (heights.length > 2 && high - last < 0.4 * (last - before)) heights.splice(-2, 1);
  heights[heights.length - 1] = high;
  return heights.slice(1).map((up, number) => [heights[number], up]);
}

/**
 * An arm: two lower chords from the body to the tip, and an upper one that holds it.
 *
 * @param {DrawSupport} draw
 * @param {number[]} arm height, left and right end
 * @param {number} half_m
 * @param {number} brace_m
 */
function wedge({ outline, fine }, [up, left_m, right_m], half_m, brace_m) {
  for (const tip of [left_m, right_m]) {
    const sign = Math.sign(tip);
    const reach_m = Math.abs(tip);
    if (reach_m <= half_m) continue;
    const deep_m = Math.min(Math.max(reach_m * 0.2, 0.6), 2.2);
    for (const along of [-half_m, half_m]) {
      outline([sign * half_m, up, along], [tip, up, 0], brace_m * 1.5);
      outline([sign * half_m * 0.95, up + deep_m, along], [tip, up, 0], brace_m * 1.2);
    }
    const steps = Math.max(2, Math.round(reach_m / 2));
    for (let step = 1; step < steps; step += 1) {
      const share = step / steps;
      const [across, along] = [sign * (half_m + (reach_m - half_m) * share), half_m * (1 - share)];
      fine([across, up, -along], [across, up, along], brace_m * 0.8);
      for (const side of [-along, along])
        fine([across, up, side], [across, up + deep_m * (1 - share), side], brace_m * 0.8);
    }
  }
}

/**
 * The body ends below the beam in two arms of a Y, which carry the beam and, above it, the tips with the earth wires.
 *
 * @param {DrawnSupport} support
 * @param {DrawSupport} draw
 * @param {{ foot_m: number, waist_m: number, legs_m: number, brace_m: number }} how
 */
function delta(support, draw, { foot_m, waist_m, legs_m, brace_m }) {
  const {
    height_m,
    earth,
    arms: [[beam_m, left_m, right_m]],
  } = support;
  const { outline, fine } = draw;
  const shoulder_m = Math.abs(earth[0][0]);
  const neck_m = beam_m - Math.min(shoulder_m * 2.1, beam_m * 0.36);
  const half_m = waist_m / 2;
  body(draw, { low: 0, high: neck_m, lowHalf_m: foot_m / 2, highHalf_m: half_m, legs_m, brace_m });
  const thick_m = Math.min(Math.max(shoulder_m * 0.16, 0.5), 1.1); // of the arms of the Y, and of the beam
  for (const sign of [-1, 1]) {
    for (const along of [-half_m, half_m]) {
      const side = along * 0.7;
      outline([sign * half_m, neck_m, along], [sign * (shoulder_m + thick_m), beam_m, side], legs_m * 0.8);
      outline(
        [sign * half_m * 0.2, neck_m + thick_m, along],
        [sign * (shoulder_m - thick_m), beam_m, side],
        legs_m * 0.7,
      );
      outline([sign * (shoulder_m - thick_m), beam_m, side], [sign * shoulder_m, height_m, 0], legs_m * 0.5);
      outline([sign * (shoulder_m + thick_m), beam_m, side], [sign * shoulder_m, height_m, 0], legs_m * 0.5);
    }
    for (let step = 1; step < 6; step += 1) {
      const share = step / 6;
      const out = half_m + (shoulder_m + thick_m - half_m) * share;
      const inside = half_m * 0.2 + (shoulder_m - thick_m - half_m * 0.2) * share;
      const [up, inner] = [neck_m + (beam_m - neck_m) * share, neck_m + thick_m + (beam_m - neck_m - thick_m) * share];
      for (const along of [-half_m, half_m])
        fine([sign * out, up, along * (1 - 0.3 * share)], [sign * inside, inner, along * (1 - 0.3 * share)], brace_m);
    }
  }
  outline([left_m, beam_m, 0], [right_m, beam_m, 0], brace_m * 1.4);
  for (const along of [-half_m * 0.7, half_m * 0.7]) {
    outline([-shoulder_m, beam_m, along], [shoulder_m, beam_m, along], brace_m * 1.3);
    outline([-shoulder_m, beam_m + thick_m * 1.4, along], [shoulder_m, beam_m + thick_m * 1.4, along], brace_m * 1.3);
    for (const tip of [left_m, right_m])
      outline([Math.sign(tip) * shoulder_m, beam_m + thick_m * 1.4, along], [tip, beam_m, 0], brace_m * 1.2);
    const steps = Math.max(4, Math.round(shoulder_m));
    for (let step = 0; step < steps; step += 1) {
      const [here, there] = [step / steps, (step + 1) / steps].map((share) => -shoulder_m + 2 * shoulder_m * share);
      fine([here, beam_m, along], [there, beam_m + thick_m * 1.4, along], brace_m * 0.8);
    }
  }
  footings(draw, foot_m, legs_m, support.depth_m);
}

/** @param {DrawSupport} draw @param {number} foot_m @param {number} legs_m @param {number} depth_m */
function footings({ fine }, foot_m, legs_m, depth_m) {
  for (const [a, b] of SIDES)
    fine([(a * foot_m) / 2, -depth_m, (b * foot_m) / 2], [(a * foot_m) / 2, 0.4, (b * foot_m) / 2], legs_m * 3, 2);
}
