/**
 * Heights that planners use above the drawing: over supports of unknown height, and from top to top between them. Values in, arrays out.
 */

const MIN_M = 0.5; // less is not shown
const CAP_M = 1.6; // half of the cross on top of a mark

/** @import { Scene, Support } from "../../api_types.d.ts" */
/** @import { Frame, Polylines } from "../types.d.ts" */

/**
 * How much higher planners take a support than it is drawn; 0 where they are equal.
 *
 * @param {Pick<Support, "height_m" | "likely_m">} support
 */
export const uncounted_m = ({ height_m, likely_m }) => (height_m - likely_m > MIN_M ? height_m - likely_m : 0);

/**
 * { points, first }: the wires that planners count there, as polylines of wiresOf, straight from top to top; marks: Float32Array of segments
 * (x, y, z, x, y, z): those, and over each such support a mast up to its counted height with a cross on it.
 *
 * @param {Pick<Scene, "supports" | "spans">} scene
 * @param {Frame} frame
 * @returns {Polylines & { marks: Float32Array }}
 */
export function countedAir(scene, frame) {
  /** @param {number} place in supports */
  const topOf = (place) => {
    const { position, ground_amsl_m, height_m } = scene.supports[place];
    return frame.toLocal(position[0], position[1], ground_amsl_m + height_m);
  };
  const isHigher = scene.supports.map((support) => uncounted_m(support) > 0);
  /** @type {number[]} */
  const segments = [];
  scene.supports.forEach((support, place) => {
    if (!isHigher[place]) return;
    const [x, y, z] = topOf(place);
    segments.push(
      x,
      y - uncounted_m(support),
      z,
      x,
      y,
      z,
      x - CAP_M,
      y,
      z,
      x + CAP_M,
      y,
      z,
      x,
      y,
      z - CAP_M,
      x,
      y,
      z + CAP_M,
    );
  });
  const points = scene.spans
    .filter(({ from, to }) => isHigher[from] || isHigher[to])
    .flatMap(({ from, to }) => [...topOf(from), ...topOf(to)]);
  return {
    points: Float64Array.from(points),
    first: Uint32Array.from({ length: points.length / 6 + 1 }, (_, number) => number * 2),
    marks: Float32Array.from([...segments, ...points]),
  };
}
