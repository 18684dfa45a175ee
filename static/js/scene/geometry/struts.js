/** Straight members: what towers are built of. Arrays in, arrays out. */

/** @import { Members, Vector } from "../types.d.ts" */

/** A list of members that grows. */
export function memberList() {
  /** @type {number[]} */
  const ends = [];
  /** @type {number[]} */
  const widths = [];
  /** @type {number[]} */
  const tones = [];
  return {
    /** @param {Vector} start @param {Vector} end @param {number} width_m @param {number} [tone] */
    add(start, end, width_m, tone = 0) {
      ends.push(...start, ...end);
      widths.push(width_m);
      tones.push(tone);
    },
    get length() {
      return widths.length;
    },
    /** @returns {Members} */
    take: () => ({ ends: Float32Array.from(ends), width_m: Float32Array.from(widths), tone: Uint8Array.from(tones) }),
  };
}

/**
 * For each member the 4 x 4 matrix, by columns, that brings a prism of width 1 around y = -1/2 to 1/2 to its place; written to `into` from
 * member number `from` on, where given.
 *
 * @param {Pick<Members, "ends" | "width_m">} members
 * @param {Float32Array} [into]
 * @param {number} [from]
 */
export function memberMatrices({ ends, width_m }, into = new Float32Array(width_m.length * 16), from = 0) {
  for (let member = 0; member < width_m.length; member += 1) {
    const at = member * 6;
    const [dx, dy, dz] = [ends[at + 3] - ends[at], ends[at + 4] - ends[at + 1], ends[at + 5] - ends[at + 2]];
    const length = Math.hypot(dx, dy, dz) || 1e-6;
    const [ux, uy, uz] = [dx / length, dy / length, dz / length];
    // A side that is level where the member is not upright, so that prisms are square.
    const level = Math.hypot(ux, uz);
    const [sx, sy, sz] = level > 1e-4 ? [-uz / level, 0, ux / level] : [1, 0, 0];
    const [tx, ty, tz] = [sy * uz - sz * uy, sz * ux - sx * uz, sx * uy - sy * ux];
    const width = width_m[member];
    const to = (from + member) * 16;
    into[to] = sx * width;
    into[to + 1] = sy * width;
    into[to + 2] = sz * width;
    into[to + 3] = 0;
    into[to + 4] = dx;
    into[to + 5] = dy;
    into[to + 6] = dz;
    into[to + 7] = 0;
    into[to + 8] = tx * width;
    into[to + 9] = ty * width;
    into[to + 10] = tz * width;
    into[to + 11] = 0;
    into[to + 12] = ends[at] + dx / 2;
    into[to + 13] = ends[at + 1] + dy / 2;
    into[to + 14] = ends[at + 2] + dz / 2;
    into[to + 15] = 1;
  }
  return into;
}
