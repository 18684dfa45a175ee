/** Places of names. Values in, a list out; the view draws them, and leaves out those that would overlap. */

import { uncounted_m } from "./counted.js";

/** @import { Scene } from "../../api_types.d.ts" */
/** @import { Frame, Vector } from "../types.d.ts" */

/**
 * A thing with a label. counted_m: the height that planners use, where it is drawn lower.
 *
 * @typedef {object} GroundLabel
 * @property {"zone" | "tower" | "bridge"} kind
 * @property {number} id
 * @property {string} text
 * @property {Vector} position
 * @property {number} weight
 * @property {number | null} [counted_m]
 */

const TOP_M = 4; // over the top of the thing

/**
 * Heavier first.
 *
 * @param {Scene} scene
 * @param {Frame} frame
 * @param {readonly { middle: Vector, isInForce: boolean }[]} volumes
 */
export function labelsOf(scene, frame, volumes) {
  /** @type {GroundLabel[]} */
  const labels = [];
  scene.zones.forEach(({ id, name }, number) => {
    const { middle, isInForce } = volumes[number];
    labels.push({ kind: "zone", id, text: name, position: middle, weight: isInForce ? 90 : 60 });
  });
  for (const support of scene.supports) {
    const { id, label, position, ground_amsl_m, height_m, voltage_v } = support;
    if (id === null) continue;
    const weight = 20 + Math.min((voltage_v ?? 0) / 20_000, 30);
    labels.push({
      kind: "tower",
      id,
      text: label ?? "",
      position: frame.toLocal(position[0], position[1], ground_amsl_m + height_m + TOP_M),
      weight,
      counted_m: uncounted_m(support) ? height_m : null,
    });
  }
  for (const { id, label, is_named, polygons, deck_amsl_m } of scene.bridges) {
    if (!is_named) continue;
    const points = polygons.flatMap(([outline]) => outline);
    const [lon, lat] = [0, 1].map((axis) => points.reduce((sum, point) => sum + point[axis], 0) / points.length);
    labels.push({
      kind: "bridge",
      id,
      text: label,
      position: frame.toLocal(lon, lat, deck_amsl_m + TOP_M),
      weight: 15,
    });
  }
  return labels.sort((one, other) => other.weight - one.weight);
}
