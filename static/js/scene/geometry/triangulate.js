/** Polygons as triangles, by cutting ears off. Numbers in, numbers out. */

/** @import { Ring } from "../types.d.ts" */

/**
 * rings: the outline and its holes, each a list of points [x, z], closed or not, in any turn. Gives { points: [[x, z], …], triangles:
 * [a, b, c, …] }: places in points, all turning one way (to the left where x goes right and z up). Rings of fewer than three points give nothing.
 *
 * @param {readonly Ring[]} rings
 */
export function triangulate(rings) {
  const [outline, ...holes] = rings.map(opened).filter((ring) => ring.length >= 3);
  if (!outline) return { points: [], triangles: [] };
  let ring = turned(outline, 1);
  const cuts = holes.map((hole) => turned(hole, -1)).sort((one, other) => rightmost(other)[0] - rightmost(one)[0]);
  for (const hole of cuts) ring = bridged(ring, hole);
  return { points: ring, triangles: ears(ring) };
}

/** @param {Ring} ring */
function opened(ring) {
  const points = ring.filter(([x, z], at) => at === 0 || x !== ring[at - 1][0] || z !== ring[at - 1][1]);
  const [first, last] = [points[0], points[points.length - 1]];
  return points.length > 1 && first[0] === last[0] && first[1] === last[1] ? points.slice(0, -1) : points;
}

/** Twice the signed area. @param {Ring} ring */
export function area2(ring) {
  return ring.reduce((sum, [x, z], at) => {
    const [nextX, nextZ] = ring[(at + 1) % ring.length];
    return sum + x * nextZ - nextX * z;
  }, 0);
}

/** @param {Ring} ring @param {1 | -1} way */
function turned(ring, way) {
  return Math.sign(area2(ring)) === way ? ring : [...ring].reverse();
}

/** @param {Ring} ring */
function rightmost(ring) {
  return ring.reduce((best, point) => (point[0] > best[0] ? point : best));
}

/**
 * Outline and hole as one ring, joined where the hole's rightmost point sees a corner of the outline.
 *
 * @param {Ring} ring
 * @param {Ring} hole
 */
function bridged(ring, hole) {
  const point = rightmost(hole);
  const start = hole.indexOf(point);
  let best = -1;
  let nearest = Infinity;
  for (let at = 0; at < ring.length; at += 1) {
    const distance = (ring[at][0] - point[0]) ** 2 + (ring[at][1] - point[1]) ** 2;
    if (distance < nearest && seen(ring, hole, point, at)) [best, nearest] = [at, distance];
  }
  if (best < 0) return ring;
  const round = [...hole.slice(start), ...hole.slice(0, start), point];
  return [...ring.slice(0, best + 1), ...round, ring[best], ...ring.slice(best + 1)];
}

/** @param {Ring} ring @param {Ring} hole @param {number[]} point @param {number} at */
function seen(ring, hole, point, at) {
  const corner = ring[at];
  for (const sides of [ring, hole]) {
    for (let side = 0; side < sides.length; side += 1) {
      const [a, b] = [sides[side], sides[(side + 1) % sides.length]];
      if ([a, b].some((end) => same(end, corner) || same(end, point))) continue;
      if (cross(a, b, point) * cross(a, b, corner) < 0 && cross(point, corner, a) * cross(point, corner, b) < 0)
        return false;
    }
  }
  return true;
}

/** @param {Ring} ring */
function ears(ring) {
  const left = ring.map((_, at) => at);
  /** @type {number[]} */
  const triangles = [];
  let tried = 0;
  let at = 0;
  while (left.length > 3 && tried < left.length) {
    const [a, b, c] = [0, 1, 2].map((step) => left[(at + step) % left.length]);
    if (isEar(ring, left, a, b, c)) {
      triangles.push(a, b, c);
      left.splice((at + 1) % left.length, 1);
      tried = 0;
      at %= left.length;
    } else {
      tried += 1;
      at = (at + 1) % left.length;
    }
  }
  if (left.length === 3 && cross(ring[left[0]], ring[left[1]], ring[left[2]]) > 0) triangles.push(...left);
  return triangles;
}

/** @param {Ring} ring @param {readonly number[]} left @param {number} a @param {number} b @param {number} c */
function isEar(ring, left, a, b, c) {
  const [first, tip, last] = [ring[a], ring[b], ring[c]];
  if (cross(first, tip, last) <= 0) return tip !== first && cross(first, tip, last) === 0;
  const low_x = Math.min(first[0], tip[0], last[0]);
  const high_x = Math.max(first[0], tip[0], last[0]);
  const low_z = Math.min(first[1], tip[1], last[1]);
  const high_z = Math.max(first[1], tip[1], last[1]);
  for (const other of left) {
    const point = ring[other];
    if (point[0] < low_x || point[0] > high_x || point[1] < low_z || point[1] > high_z) continue;
    if (same(point, first) || same(point, tip) || same(point, last)) continue;
    if (cross(first, tip, point) >= 0 && cross(tip, last, point) >= 0 && cross(last, first, point) >= 0) return false;
  }
  return true;
}

/** @param {number[]} one @param {number[]} other */
function same(one, other) {
  return one[0] === other[0] && one[1] === other[1];
}

/** @param {number[]} a @param {number[]} b @param {number[]} c */
function cross(a, b, c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}
