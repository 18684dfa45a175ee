/** The name that a mission is proposed, from what is picked. Values in, values out. */

import { countedByKind } from "../../domain/counted.js";
import { nameOf } from "../selection.js";
import { lineOfPart } from "./line_parts.js";

/** @import { PickedTarget } from "../types.d.ts" */

const MAX_LENGTH = 120;

/** @typedef {Pick<PickedTarget, "kind" | "label" | "detail"> & Partial<Pick<PickedTarget, "asset" | "stretch">>} Named */

/**
 * "Tower 17 of 41, 138 kV AEP" of one target, "138 kV AEP: 41 towers" where all are alike, else how many there are of each kind; empty without any.
 *
 * @param {Named[]} picked
 */
export function proposedName(picked) {
  if (!picked.length) return "";
  const targets = withLinesOnce(picked);
  const whole = targets.length === 1 ? nameOf(targets[0]) : countedByKind(targets);
  const [{ detail }] = targets;
  const isAlike = targets.length > 1 && detail && targets.every((target) => target.detail === detail);
  return (isAlike ? `${detail}: ${whole}` : whole).slice(0, MAX_LENGTH);
}

/** The parts of a line count as one. @param {Named[]} targets @returns {Named[]} */
function withLinesOnce(targets) {
  const lines = new Set();
  return targets.flatMap((target) => {
    if (!target.stretch || target.asset === null) return [target];
    if (lines.has(target.asset)) return [];
    lines.add(target.asset);
    return [{ ...target, label: lineOfPart(target.label), detail: "" }];
  });
}
