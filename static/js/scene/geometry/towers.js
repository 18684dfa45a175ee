/** Supports as members: those seen from afar, and those added near by. Values in, arrays out. */

import { lattice } from "./lattice.js";
import { memberList } from "./struts.js";
import { standing } from "./wires.js";

/** @import { Support } from "../../api_types.d.ts" */
/** @import { DrawMember, DrawSupport, Frame, Vector } from "../types.d.ts" */
/** @import { DrawnSupport } from "./lattice.js" */

/** Tones of members. */
export const BODY = 0;
export const INSULATOR = 1;
export const FOUNDATION = 2;

const MIN_DEPTH_M = 0.6; // of a foundation
const SEGMENTS = 5; // of a pole that gets thinner

/**
 * { frame: members of the outline, fine: bracing, insulators and foundations }, each as memberList takes it, in the frame.
 *
 * below_m: how far the drawn ground is below the support's foot: foundations reach down to it.
 * Nothing is higher than the support likely is above its ground, and something of the outline reaches it.
 *
 * @param {Support} support
 * @param {Frame} frame
 * @param {number} [below_m]
 */
export function supportMembers(support, frame, below_m = 0) {
  const stand = standing(support, frame);
  const [outline, fine] = [memberList(), memberList()];
  /** @param {Vector} point @returns {Vector} */
  const place = ([across, up, along]) => [
    stand.foot[0] + across * stand.across[0] + along * stand.along[0],
    stand.foot[1] + up,
    stand.foot[2] + across * stand.across[1] + along * stand.along[1],
  ];
  /** @param {ReturnType<typeof memberList>} list @returns {DrawMember} */
  const into =
    (list) =>
    (start, end, width_m, tone = BODY) =>
      list.add(place(start), place(end), width_m, tone);
  const draw = { outline: into(outline), fine: into(fine) };
  const drawn = { ...support, height_m: support.likely_m, depth_m: MIN_DEPTH_M + Math.max(below_m, 0) };
  (BUILDERS[support.form] ?? pole)(drawn, draw);
  insulators(drawn, draw);
  return { outline: outline.take(), fine: fine.take() };
}

/** @type {Record<string, (support: DrawnSupport, draw: DrawSupport) => void>} */
const BUILDERS = { lattice, guyed, tubular: pole, wooden: pole, "h-frame": twoLegged, portal: twoLegged, stake };

/** @param {DrawnSupport} support @param {DrawSupport} draw */
function stake(support, { outline }) {
  outline([0, 0, 0], [0, support.height_m, 0], 0.25);
}

/**
 * One leg, thinner towards its top, with arms that rise a little to their ends.
 *
 * @param {DrawnSupport} support
 * @param {DrawSupport} draw
 */
function pole(support, { outline, fine }) {
  const { height_m } = support;
  const isWooden = support.form === "wooden";
  const foot_m = isWooden ? 0.42 : Math.min(Math.max(height_m * 0.03, 0.6), 2.2);
  const top_m = isWooden ? 0.28 : foot_m * 0.34;
  for (let part = 0; part < SEGMENTS; part += 1) {
    const [low, high] = [part / SEGMENTS, (part + 1) / SEGMENTS];
    outline([0, low * height_m, 0], [0, high * height_m, 0], foot_m + (top_m - foot_m) * (low + high) * 0.5);
  }
  for (const [arm_m, left_m, right_m] of support.arms) {
    const rise_m = isWooden ? 0 : 0.05 * Math.max(-left_m, right_m);
    for (const end of [left_m, right_m])
      if (end) outline([0, arm_m - rise_m, 0], [end, arm_m, 0], isWooden ? 0.2 : foot_m * 0.24);
    if (isWooden && left_m && right_m) {
      for (const end of [left_m, right_m]) fine([0, arm_m - 0.9, 0], [end * 0.7, arm_m, 0], 0.1);
    }
  }
  if (!isWooden) fine([0, -support.depth_m, 0], [0, 0.35, 0], foot_m * 1.6, FOUNDATION);
  else if (support.depth_m > MIN_DEPTH_M) fine([0, -support.depth_m, 0], [0, 0, 0], foot_m);
}

/**
 * Two legs under a beam, crossed below it; with the tips of the legs above it where earth wires hang.
 *
 * @param {DrawnSupport} support
 * @param {DrawSupport} draw
 */
function twoLegged(support, { outline, fine }) {
  const { height_m, arms, earth } = support;
  const isPortal = support.form === "portal";
  const [arm_m, left_m, right_m] = arms[0];
  const reach_m = Math.max(-left_m, right_m);
  const leg_m = earth.length ? Math.abs(earth[0][0]) : isPortal ? reach_m : reach_m * 0.58;
  const width_m = Math.min(Math.max(height_m * 0.014, 0.35), 0.7);
  for (const side of [-leg_m, leg_m]) {
    outline([side, 0, 0], [side, isPortal ? arm_m : height_m, 0], width_m);
    fine([side, -support.depth_m, 0], [side, 0.35, 0], width_m * 2.4, FOUNDATION);
  }
  outline([-reach_m, arm_m - width_m, 0], [reach_m, arm_m - width_m, 0], width_m * 0.7);
  if (isPortal) outline([-reach_m, arm_m, 0], [reach_m, arm_m, 0], width_m * 0.7);
  if (isPortal && arm_m < height_m) outline([-leg_m, arm_m, 0], [-leg_m, height_m, 0], width_m * 0.5);
  const low_m = arm_m - Math.min(2.2 * leg_m, arm_m * 0.5);
  for (const side of [-1, 1]) fine([side * leg_m, arm_m - width_m, 0], [-side * leg_m, low_m, 0], width_m * 0.35);
}

/** A slim mast on ropes. @param {DrawnSupport} support @param {DrawSupport} draw */
function guyed(support, draw) {
  const { height_m, arms } = support;
  lattice(support, draw, { foot_m: 0.5, waist_m: Math.min(Math.max(height_m * 0.03, 0.8), 1.6) });
  const hold_m = arms.length ? Math.min(...arms.map(([arm]) => arm)) : height_m * 0.7;
  for (const [across, along] of [
    [1, 1],
    [1, -1],
    [-1, 1],
    [-1, -1],
  ]) {
    draw.outline([across * 0.5, hold_m, along * 0.5], [across * hold_m * 0.42, 0, along * hold_m * 0.42], 0.08);
  }
}

/** From the arm down to where the phase hangs. @param {DrawnSupport} support @param {DrawSupport} draw */
function insulators({ arms, slots, form }, { fine }) {
  if (form === "stake") return;
  for (const [across, hangs_m] of slots) {
    const from_m = Math.min(...arms.map(([arm]) => arm).filter((arm) => arm >= hangs_m - 0.3));
    if (!Number.isFinite(from_m)) continue;
    fine(
      [across, from_m, 0],
      [across, Math.abs(from_m - hangs_m) < 0.05 ? hangs_m - 0.25 : hangs_m, 0],
      0.22,
      INSULATOR,
    );
  }
}
