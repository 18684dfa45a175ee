/** How a wire hangs between two points. Numbers in, numbers out. */

/** @import { Vector } from "../types.d.ts" */

/**
 * Horizontal pull over weight by length [m] of a wire over a level span with this sag in its middle; Infinity for a straight one.
 *
 * @param {number} length_m
 * @param {number} sag_m
 */
export function catenaryConstant(length_m, sag_m) {
  if (!(sag_m > 0) || !(length_m > 0)) return Infinity;
  let constant = length_m ** 2 / (8 * sag_m) + sag_m / 6;
  for (let round = 0; round < 4; round += 1) {
    const half = length_m / (2 * constant);
    const off = constant * (Math.cosh(half) - 1) - sag_m;
    constant -= off / (Math.cosh(half) - 1 - half * Math.sinh(half));
  }
  return constant;
}

/**
 * Sag of the wire [m] below the straight line between its ends, at a share of the length.
 *
 * @param {number} share
 * @param {number} length_m
 * @param {number} sag_m
 * @param {number} [constant]
 */
export function sagAt(share, length_m, sag_m, constant = catenaryConstant(length_m, sag_m)) {
  if (!Number.isFinite(constant)) return 0;
  return sag_m - constant * (Math.cosh(((share - 0.5) * length_m) / constant) - 1);
}

/**
 * The number of straight pieces that keep each within `within_m` of the curve.
 *
 * @param {number} sag_m
 * @param {number} [within_m]
 */
export function piecesFor(sag_m, within_m = 0.06) {
  return Math.min(Math.max(Math.ceil(Math.sqrt(Math.max(sag_m, 0) / within_m)), 2), 24);
}

/**
 * Points [x, y, z, …] of the wire from start to end, pieces + 1 of them, appended to `points`.
 *
 * @param {Vector} start
 * @param {Vector} end
 * @param {number} sag_m
 * @param {number} pieces
 * @param {number[]} points
 */
export function hang(start, end, sag_m, pieces, points) {
  const length_m = Math.hypot(end[0] - start[0], end[2] - start[2]);
  const constant = catenaryConstant(length_m, sag_m);
  for (let piece = 0; piece <= pieces; piece += 1) {
    const share = piece / pieces;
    points.push(
      start[0] + share * (end[0] - start[0]),
      start[1] + share * (end[1] - start[1]) - sagAt(share, length_m, sag_m, constant),
      start[2] + share * (end[2] - start[2]),
    );
  }
}
