/** A flown or planned path as a flat band with poles to the ground. Arrays in, arrays out. */

/** @import { HeightAt } from "../types.d.ts" */

/**
 * positions: flat [x, y, z, …] of n points in the frame, in the order flown. The band lies level across the way, `width_m` wide, and passes
 * through every point; straight up or down it turns its broad side along the last level direction.
 *
 * Gives { vertices: Float32Array (2 n points: left, right of each), normals, along_m: Float32Array (2 n), index: Uint32Array }.
 *
 * @param {ArrayLike<number>} positions
 * @param {{ width_m?: number }} [how]
 */
export function ribbon(positions, { width_m = 2 } = {}) {
  const count = positions.length / 3;
  const vertices = new Float32Array(count * 6);
  const normals = new Float32Array(count * 6);
  const along_m = new Float32Array(count * 2);
  const index = new Uint32Array(Math.max(count - 1, 0) * 6);
  const across = directionsAcross(positions);
  const half_m = width_m / 2;
  let way_m = 0;
  for (let point = 0; point < count; point += 1) {
    const at = point * 3;
    if (point)
      way_m += Math.hypot(
        positions[at] - positions[at - 3],
        positions[at + 1] - positions[at - 2],
        positions[at + 2] - positions[at - 1],
      );
    const [side_x, side_z, stretch] = across[point];
    for (const [side, sign] of [
      [0, -1],
      [1, 1],
    ]) {
      const to = (point * 2 + side) * 3;
      vertices[to] = positions[at] + sign * half_m * stretch * side_x;
      vertices[to + 1] = positions[at + 1];
      vertices[to + 2] = positions[at + 2] + sign * half_m * stretch * side_z;
      normals[to + 1] = 1;
      along_m[point * 2 + side] = way_m;
    }
    if (point < count - 1) {
      const low = point * 2;
      index.set([low, low + 1, low + 2, low + 1, low + 3, low + 2], point * 6);
    }
  }
  return { vertices, normals, along_m, index };
}

/**
 * For each point the level direction to the right of the path, and the factor of the mitre's length; at most 2.
 *
 * @param {ArrayLike<number>} positions
 */
function directionsAcross(positions) {
  const count = positions.length / 3;
  /** @type {(number[] | null)[]} */
  const legs = [];
  let last = [1, 0];
  for (let point = 0; point < count - 1; point += 1) {
    const [x, z] = [
      positions[point * 3 + 3] - positions[point * 3],
      positions[point * 3 + 5] - positions[point * 3 + 2],
    ];
    const length = Math.hypot(x, z);
    if (length > 1e-6) last = [-z / length, x / length];
    legs.push(length > 1e-6 || point ? last : null);
  }
  const first = legs.find(Boolean) ?? last;
  const sides = legs.map((leg) => leg ?? first);
  return Array.from({ length: count }, (_, point) => {
    const before = sides[Math.max(point - 1, 0)] ?? last;
    const after = sides[Math.min(point, sides.length - 1)] ?? last;
    const [x, z] = [before[0] + after[0], before[1] + after[1]];
    const length = Math.hypot(x, z);
    if (length < 1e-3) return [...after, 1]; // turns back on itself
    return [x / length, z / length, Math.min(2 / length, 2)];
  });
}

/**
 * Poles from the path down to the ground, one at each `spacing_m` of the path over the ground and at both ends.
 *
 * groundAt(x, z) -> y. Gives { segments: Float32Array [x, top, z, x, ground, z, …], heights_m: Float32Array }.
 *
 * @param {number[]} positions
 * @param {HeightAt} groundAt
 * @param {{ spacing_m?: number }} [how]
 */
export function heightPoles(positions, groundAt, { spacing_m = 50 } = {}) {
  /** @type {number[]} */
  const segments = [];
  /** @type {number[]} */
  const heights_m = [];
  /** @param {number} x @param {number} y @param {number} z */
  const stand = (x, y, z) => {
    const ground = groundAt(x, z);
    segments.push(x, y, z, x, ground, z);
    heights_m.push(y - ground);
  };
  let left_m = 0;
  for (let at = 0; at + 5 < positions.length; at += 3) {
    const [x, y, z] = [positions[at], positions[at + 1], positions[at + 2]];
    const [dx, dy, dz] = [positions[at + 3] - x, positions[at + 4] - y, positions[at + 5] - z];
    const length = Math.hypot(dx, dz);
    for (; left_m < length; left_m += spacing_m)
      stand(x + (dx * left_m) / length, y + (dy * left_m) / length, z + (dz * left_m) / length);
    left_m -= length;
  }
  if (positions.length >= 3) {
    const [x, y, z] = positions.slice(-3);
    stand(x, y, z);
  }
  return { segments: new Float32Array(segments), heights_m: new Float32Array(heights_m) };
}

/**
 * With points in between, where a stretch is longer than longest_m: { positions, at_s }.
 *
 * @template {{ positions: number[], at_s?: number[] | null }} Line
 * @param {Line} line
 * @param {number} longest_m
 */
export function stepped({ positions, at_s, ...line }, longest_m) {
  const all = positions.slice(0, 3);
  const times = at_s ? [at_s[0]] : null;
  for (let end = 3; end < positions.length; end += 3) {
    const [from, to] = [positions.slice(end - 3, end), positions.slice(end, end + 3)];
    const steps = Math.max(1, Math.ceil(Math.hypot(...to.map((metres, axis) => metres - from[axis])) / longest_m));
    for (let step = 1; step <= steps; step += 1) {
      /** @param {number} one @param {number} other */
      const between = (one, other) => (step === steps ? other : one + ((other - one) * step) / steps);
      all.push(...to.map((metres, axis) => between(from[axis], metres)));
      if (at_s) times?.push(between(at_s[end / 3 - 1], at_s[end / 3]));
    }
  }
  return { ...line, positions: all, at_s: times };
}
