/**
 * State of a drawing as a value: { shape, growing }. `growing` is the ring [part, ring] that the next vertex goes to, null once the shape
 * is complete. Undo steps through these values, so that it also restores the effect of a click.
 */

import {
  addHole,
  addPart,
  append,
  dropLast,
  leastOf,
  radiusTo,
  ringAt,
  seated,
  stubOf,
  withoutStubs,
} from "./shape.js";

/** @import { Drawing, Shape } from "./types.d.ts" */

/**
 * Begin to draw a shape, or continue one without enough vertices.
 *
 * @param {Shape} shape
 * @returns {Drawing}
 */
export const begin = (shape) => ({ shape, growing: stubOf(shape) });

/** @param {Drawing} state @returns {number[][]} */
export const growingRing = ({ shape, growing }) => (growing ? ringAt(shape, growing) : []);

/**
 * A click. `near`: "first" or "last" where it met that vertex of the growing ring.
 *
 * @param {Drawing} state
 * @param {number[]} position
 * @param {"first" | "last" | null} [near]
 * @returns {Drawing}
 */
export function placed(state, position, near = null) {
  const { shape, growing } = state;
  if (!growing) return state;
  const ring = growingRing(state);
  if (shape.kind === "point") return { shape: append(shape, growing, position), growing: null };
  if (shape.kind === "circle") {
    if (!ring.length) return { shape: append(shape, growing, position), growing };
    return near ? state : { shape: radiusTo(shape, position), growing: null };
  }
  if (near === "last" || (near === "first" && shape.kind === "area"))
    return ring.length >= leastOf(shape.kind) ? ended(state) : state;
  return { shape: append(shape, growing, position), growing };
}

/**
 * Finish the growing ring; a hole or part with too few vertices is dropped, and a shape with too few stays unfinished.
 *
 * @param {Drawing} state
 * @returns {Drawing}
 */
export function ended(state) {
  const { shape, growing } = state;
  if (!growing || shape.kind === "circle" || shape.kind === "point") return state;
  if (growingRing(state).length >= leastOf(shape.kind)) return { shape: seated(shape), growing: null };
  return growing.join() === "0,0" ? state : { shape: withoutStubs(shape), growing: null };
}

/**
 * Remove the vertex that was placed last; a hole or part without any is dropped.
 *
 * @param {Drawing} state
 * @returns {Drawing}
 */
export function stepBack(state) {
  const { shape, growing } = state;
  if (!growing) return state;
  if (growingRing(state).length) return { shape: dropLast(shape, growing), growing };
  return growing.join() === "0,0" ? state : { shape: withoutStubs(shape), growing: null };
}

/** @param {Drawing} state @param {number} [part] @returns {Drawing} */
export const withHole = ({ shape }, part = 0) => ({
  shape: addHole(shape, part),
  growing: [part, shape.parts[part].length],
});
/** @param {Drawing} state @returns {Drawing} */
export const withPart = ({ shape }) => ({ shape: addPart(shape), growing: [shape.parts.length, 0] });

/**
 * The shape after a click at the position: for measures and for a circle that is being drawn.
 *
 * @param {Drawing} state
 * @param {number[] | null} position
 */
export function preview(state, position) {
  const { shape } = state;
  return position && state.growing && shape.kind !== "point" && growingRing(state).length
    ? placed(state, position).shape
    : shape;
}
