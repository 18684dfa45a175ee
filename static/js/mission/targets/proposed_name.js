/** The name that a mission is proposed, from what is picked. Values in, values out. */

import { countedByKind } from "../../domain/counted.js";
import { nameOf } from "../selection.js";

/** @import { PickedTarget } from "../types.d.ts" */

const MAX_LENGTH = 120;

/**
 * "Tower 17 of 41, 138 kV AEP" of one target, "138 kV AEP: 41 towers" where all are alike, else how many there are of each kind; empty without any.
 *
 * @param {Pick<PickedTarget, "kind" | "label" | "detail">[]} targets
 */
export function proposedName(targets) {
  if (!targets.length) return "";
  const whole = targets.length === 1 ? nameOf(targets[0]) : countedByKind(targets);
  const [{ detail }] = targets;
  const isAlike = targets.length > 1 && detail && targets.every((target) => target.detail === detail);
  return (isAlike ? `${detail}: ${whole}` : whole).slice(0, MAX_LENGTH);
}
