/** The terrain's folds: surfaces that follow the terrain are cut along them, so that they fit exactly. Values in, values out. */

import { area2 } from "./triangulate.js";

/** @import { HeightAt, Ring } from "../types.d.ts" */
/** @import { Ground } from "./ground.js" */

/** @typedef {ReturnType<typeof foldsOf>} Folds */
/** @typedef {[column: number, row: number, toColumn: number, toRow: number]} Block */

/**
 * The part of a convex polygon [[x, z], …] where value(x, z) is not below 0; value is linear.
 *
 * @param {Ring} polygon
 * @param {HeightAt} value
 * @returns {Ring}
 */
export function cutBy(polygon, value) {
  const values = polygon.map(([x, z]) => value(x, z));
  if (values.every((own) => own >= 0)) return polygon;
  if (values.every((own) => own <= 0)) return [];
  /** @type {Ring} */
  const kept = [];
  polygon.forEach((here, at) => {
    const next = (at + 1) % polygon.length;
    if (values[at] >= 0) kept.push(here);
    if (values[at] * values[next] >= 0) return;
    const share = values[at] / (values[at] - values[next]);
    kept.push([here[0] + share * (polygon[next][0] - here[0]), here[1] + share * (polygon[next][1] - here[1])]);
  });
  return kept.length > 2 ? kept : [];
}

/**
 * The same for several polygons, without empty parts.
 *
 * @param {readonly Ring[]} parts
 * @param {HeightAt} value
 */
const cut = (parts, value) => parts.map((part) => cutBy(part, value)).filter((part) => part.length > 0);

const ALL = 1e-7; // of a block's area: a part smaller by this covers it, too

/** Twice the area of convex polygons. @param {readonly Ring[]} parts */
const areaOf = (parts) => parts.reduce((sum, part) => sum + Math.abs(area2(part)), 0);

/** What covers a block whole is the block. @param {Ring[]} parts @param {number[]} box @returns {Ring[]} */
function joined(parts, [x0, z0, x1, z1]) {
  if (parts.length < 2) return parts;
  const isWhole =
    areaOf(parts) >= 2 * (x1 - x0) * (z1 - z0) * (1 - ALL) &&
    parts.every((part) => part.every(([px, pz]) => px > x0 - ALL && px < x1 + ALL && pz > z0 - ALL && pz < z1 + ALL));
  if (!isWhole) return parts;
  const corners = [
    [x0, z0],
    [x1, z0],
    [x1, z1],
    [x0, z1],
  ];
  return [corners];
}

/**
 * The shares of a way at which it crosses a fold, in order.
 *
 * @param {Ground} ground
 * @param {number[]} start
 * @param {number[]} end
 */
function meeting({ west, north, stepX, stepZ }, [ax, az], [bx, bz]) {
  /** @param {number} px @param {number} pz */
  const at = (px, pz) => [(px - west) / stepX, (pz - north) / stepZ];
  const [[au, av], [bu, bv]] = [at(ax, az), at(bx, bz)];
  /** @type {number[]} */
  const shares = [];
  for (const [from, to] of [
    [au, bu],
    [av, bv],
    [av - au, bv - bu],
  ]) {
    for (let line = Math.ceil(Math.min(from, to)); line <= Math.max(from, to) && from !== to; line += 1)
      shares.push((line - from) / (to - from));
  }
  return shares.filter((share) => share > 1e-9 && share < 1 - 1e-9).sort((one, other) => one - other);
}

/**
 * Blocks of the grid's cells, each of four smaller ones, with how far [m] the ground strays in each from two triangles over its corners, and
 * its highest post. Gives
 * pieces(parts, within_m, isFlat): convex polygons that do not overlap, cut into those over which the ground is a plane within so much; where
 * isFlat(highest) returns for a block's highest post whether the ground below it can be ignored, they stay as they are;
 * count(box, within_m): how many blocks lie in [least x, least z, most x, most z], about half as many as pieces;
 * meeting([x, z], [x, z]): the shares of the way at which a fold is crossed, in order.
 *
 * @param {Ground} ground
 */
export function foldsOf(ground) {
  const { columns, rows, west, north, stepX, stepZ } = ground;
  const levels = pyramid(ground);
  /** @param {number} column */
  const x = (column) => west + column * stepX;
  /** @param {number} row */
  const z = (row) => north + row * stepZ;

  /** @param {number} level @param {number} i @param {number} j @returns {Block} */
  function corners(level, i, j) {
    const size = 1 << level;
    return [i * size, j * size, Math.min((i + 1) * size, columns - 1), Math.min((j + 1) * size, rows - 1)];
  }

  /**
   * @param {number} level
   * @param {number} i
   * @param {number} j
   * @param {Ring[]} given
   * @param {number} within_m
   * @param {(highest: number) => boolean} isFlat
   * @param {(piece: Ring) => void} put
   */
  function descend(level, i, j, given, within_m, isFlat, put) {
    const { across, strays, highest } = levels[level];
    const place = j * across + i;
    const [c0, r0, c1, r1] = corners(level, i, j);
    const parts = joined(given, [x(c0), z(r0), x(c1), z(r1)]);
    if (isFlat(highest[place])) {
      parts.forEach(put);
      return;
    }
    if (level === 0 || strays[place] <= within_m) {
      /** @type {HeightAt} */
      const side = (px, pz) => (pz - z(r0)) * (x(c1) - x(c0)) - (px - x(c0)) * (z(r1) - z(r0));
      for (const half of [...cut(parts, side), ...cut(parts, (px, pz) => -side(px, pz))]) put(half);
      return;
    }
    const half = 1 << (level - 1);
    const [c, r] = [c0 + half, r0 + half];
    /** @param {Ring[]} own @param {boolean} isCut @param {number} at @param {0 | 1} axis */
    const halves = (own, isCut, at, axis) =>
      isCut ? [cut(own, (...place) => at - place[axis]), cut(own, (...place) => place[axis] - at)] : [own];
    halves(parts, c < c1, x(c), 0).forEach((column, di) => {
      if (!column.length) return;
      halves(column, r < r1, z(r), 1).forEach((own, dj) => {
        if (own.length) descend(level - 1, 2 * i + di, 2 * j + dj, own, within_m, isFlat, put);
      });
    });
  }

  /**
   * @param {number} level
   * @param {number} i
   * @param {number} j
   * @param {number[]} box
   * @param {number} within_m
   * @returns {number}
   */
  function countIn(level, i, j, box, within_m) {
    const [c0, r0, c1, r1] = corners(level, i, j);
    if (c0 >= columns - 1 || r0 >= rows - 1 || x(c1) < box[0] || x(c0) > box[2] || z(r1) < box[1] || z(r0) > box[3])
      return 0;
    const { across, strays } = levels[level];
    if (level === 0 || strays[j * across + i] <= within_m) return 1;
    let sum = 0;
    for (const [di, dj] of [
      [0, 0],
      [1, 0],
      [0, 1],
      [1, 1],
    ])
      sum += countIn(level - 1, 2 * i + di, 2 * j + dj, box, within_m);
    return sum;
  }

  return {
    /** @param {Ring[]} parts @param {number} within_m @param {(highest: number) => boolean} [isFlat] */
    pieces(parts, within_m, isFlat = () => false) {
      /** @type {Ring[]} */
      const found = [];
      descend(levels.length - 1, 0, 0, parts, within_m, isFlat, (piece) => {
        found.push(piece);
      });
      return found;
    },
    /** @param {number[]} box @param {number} within_m */
    count: (box, within_m) => countIn(levels.length - 1, 0, 0, box, within_m),
    /** @param {number[]} from @param {number[]} to */
    meeting: (from, to) => meeting(ground, from, to),
  };
}

/**
 * From single cells up to one block over all: [{ across, strays, highest }], each by block, row by row.
 *
 * @param {Ground} ground
 */
function pyramid({ columns, rows, heights }) {
  /** @type {{ across: number, strays: Float32Array, highest: Float32Array }[]} */
  const levels = [];
  for (let level = 0; ; level += 1) {
    const size = 1 << level;
    const [across, down] = [Math.ceil((columns - 1) / size), Math.ceil((rows - 1) / size)];
    const [strays, highest] = [new Float32Array(across * down), new Float32Array(across * down).fill(-Infinity)];
    for (let j = 0; j < down; j += 1) {
      for (let i = 0; i < across; i += 1)
        measure(
          heights,
          columns,
          [i * size, j * size, Math.min((i + 1) * size, columns - 1), Math.min((j + 1) * size, rows - 1)],
          j * across + i,
          strays,
          highest,
        );
    }
    levels.push({ across, strays, highest });
    if (across <= 1 && down <= 1) return levels;
  }
}

/**
 * @param {Float32Array} heights
 * @param {number} columns
 * @param {Block} block
 * @param {number} place
 * @param {Float32Array} strays
 * @param {Float32Array} highest
 */
function measure(heights, columns, [c0, r0, c1, r1], place, strays, highest) {
  /** @param {number} column @param {number} row */
  const at = (column, row) => heights[row * columns + column];
  const [northWest, northEast, southWest, southEast] = [at(c0, r0), at(c1, r0), at(c0, r1), at(c1, r1)];
  let [most, high] = [0, -Infinity];
  for (let row = r0; row <= r1; row += 1) {
    for (let column = c0; column <= c1; column += 1) {
      const [east, south] = [(column - c0) / (c1 - c0), (row - r0) / (r1 - r0)];
      const flat =
        south > east
          ? northWest + south * (southWest - northWest) + east * (southEast - southWest)
          : northWest + east * (northEast - northWest) + south * (southEast - northEast);
      const height = at(column, row);
      if (height > high) high = height;
      const off = Math.abs(height - flat);
      if (off > most) most = off;
    }
  }
  strays[place] = most;
  highest[place] = high;
}
