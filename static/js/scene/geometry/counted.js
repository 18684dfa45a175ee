/** What planners count above what is drawn: over supports whose height nobody has stated, and from top to top between them. Values in, arrays out. */

const LEAST_M = 0.5; // less is not shown
const CAP_M = 1.6; // half of the cross on top of a mark

/** How much more planners count of a support than is drawn; 0 where what is drawn is counted. */
export const uncounted_m = ({ height_m, likely_m }) => (height_m - likely_m > LEAST_M ? height_m - likely_m : 0);

/**
 * { points, first }: the wires that planners count there, as polylines of wiresOf, straight from top to top; marks: Float32Array of segments
 * (x, y, z, x, y, z): those, and over each such support a mast up to its counted height with a cross on it.
 */
export function countedAir(scene, frame) {
  const topOf = (place) =>
    frame.toLocal(
      ...scene.supports[place].position,
      scene.supports[place].ground_amsl_m + scene.supports[place].height_m,
    );
  const isHigher = scene.supports.map((support) => uncounted_m(support) > 0);
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
