/** Faults of a shape while it is drawn, shown at once; the server validates it again before it is stored. */

import { continuous } from "../domain/geodesy.js";
import { t } from "../text.js";
import { isInside, leastOf } from "./shape.js";

/** @import { Fault, Shape, VertexPath } from "./types.d.ts" */

export const MAX_CHECKED = 2_000; // vertices; for more, the server checks crossings
/** @typedef {{ from: number[], to: number[] }} Ends */
/**
 * @typedef {Ends & { part: number, ring: string, index: number, size: number, low: number, high: number }} Side
 *   low and high are its longitudes, size the number of sides of its ring
 */

const MAX_FAULTS = 20;
const WORDS = {
  point: t("Click where it stands."),
  line: t("A line needs two points."),
  area: t("An area needs three points."),
  circle: t("Click the centre, then how far it reaches."),
};
/** @type {WeakMap<Shape, Fault[]>} */
const reported = new WeakMap(); // shapes are immutable: results are cached

/**
 * [{ message, position, sides: [[from, to], …] }]; an empty list without faults. A `growing` ring does not have its closing side yet.
 *
 * @param {Shape} shape
 * @param {VertexPath | null} [growing]
 * @returns {Fault[]}
 */
export function faultsOf(shape, growing = null) {
  if (growing) return found(shape, growing);
  const faults = reported.get(shape) ?? found(shape, null);
  reported.set(shape, faults);
  return faults;
}

/** @param {Shape} shape @param {VertexPath | null} growing @returns {Fault[]} */
function found(shape, growing) {
  if (shape.kind === "circle")
    return shape.parts[0][0].length && shape.radius_m ? [] : [{ message: WORDS.circle, position: null, sides: [] }];
  if (!growing && shape.parts.some(([outer]) => outer.length < leastOf(shape.kind)))
    return [{ message: WORDS[shape.kind], position: null, sides: [] }];
  const faults = [...repeated(shape), ...overTheDateLine(shape)];
  if (shape.kind !== "area" || faults.length) return faults;
  const sides = sidesOf(shape, growing);
  if (sides.length > MAX_CHECKED) return [];
  faults.push(...crossings(sides));
  if (!faults.length && !growing) faults.push(...strayRings(shape));
  return faults;
}

/** @param {Shape} shape @returns {Fault[]} */
function repeated(shape) {
  /** @param {number[]} a @param {number[]} b */
  const isSame = (a, b) => a[0] === b[0] && a[1] === b[1];
  return shape.parts
    .flat()
    .flatMap((ring) =>
      ring
        .filter((position, index) => index && isSame(position, ring[index - 1]))
        .map((position) => ({ message: t("Two points lie in one place."), position, sides: [] })),
    );
}

/** @param {Shape} shape @returns {Fault[]} */
function overTheDateLine(shape) {
  if (shape.kind !== "line") return [];
  const [path] = shape.parts[0];
  const index = path.findIndex((position, at) => at && Math.abs(position[0] - path[at - 1][0]) > 180);
  return index > 0
    ? [
        {
          message: t("A line cannot cross the 180th meridian: draw it as two."),
          position: path[index],
          sides: [[path[index - 1], path[index]]],
        },
      ]
    : [];
}

/**
 * Sides of all rings, without jumps at the 180th meridian: { from, to, part, ring, index, size, low, high }.
 *
 * @param {Shape} shape
 * @param {VertexPath | null} growing
 */
function sidesOf(shape, growing) {
  /** @type {Side[]} */
  const sides = [];
  for (const [p, part] of shape.parts.entries()) {
    for (const [r, positions] of part.entries()) {
      const ring = continuous(positions, shape.parts[0][0][0]?.[0]);
      const isOpen = growing?.[0] === p && growing[1] === r;
      for (const [index, from] of ring.slice(0, isOpen ? -1 : undefined).entries()) {
        const to = ring[(index + 1) % ring.length];
        sides.push({
          from,
          to,
          part: p,
          ring: `${p},${r}`,
          index,
          size: isOpen ? Infinity : ring.length,
          low: Math.min(from[0], to[0]),
          high: Math.max(from[0], to[0]),
        });
      }
    }
  }
  return sides;
}

/** Sweeps from west to east: only sides whose longitudes overlap are compared. @param {Side[]} sides */
function crossings(sides) {
  /** @type {Fault[]} */
  const faults = [];
  const sorted = [...sides].sort((a, b) => a.low - b.low);
  /** @type {Side[]} */
  let alive = [];
  for (const side of sorted) {
    alive = alive.filter((other) => other.high >= side.low);
    for (const other of alive) {
      const position = meetingPlace(side, other);
      if (!position) continue;
      faults.push({
        message: meetingWords(side, other),
        position,
        sides: [
          [side.from, side.to],
          [other.from, other.to],
        ],
      });
      if (faults.length >= MAX_FAULTS) return faults;
    }
    alive.push(side);
  }
  return faults;
}

/** Rings may touch each other in a point, one ring may not touch itself. @param {Side} a @param {Side} b */
function meetingPlace(a, b) {
  if (a.ring !== b.ring) return crossingOf(a, b) ?? overlapOf(a, b);
  return areNeighbours(a, b) ? overlapOf(a, b) : meetingOf(a, b);
}

/** @param {Side} a @param {Side} b */
function meetingWords(a, b) {
  if (a.ring === b.ring) return t("The border crosses itself.");
  return a.part === b.part ? t("A hole crosses the border or another hole.") : t("Two parts cross each other.");
}

/** @param {Side} a @param {Side} b */
function areNeighbours(a, b) {
  const gap = Math.abs(a.index - b.index);
  return gap === 1 || gap === a.size - 1;
}

/** @param {number[]} o @param {number[]} a @param {number[]} b */
const cross = (o, a, b) => (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
/** @param {number[]} p @param {number[]} a @param {number[]} b */
const isBetween = (p, a, b) =>
  Math.min(a[0], b[0]) <= p[0] &&
  p[0] <= Math.max(a[0], b[0]) &&
  Math.min(a[1], b[1]) <= p[1] &&
  p[1] <= Math.max(a[1], b[1]);

/** Where two sides cross, each within the other; null where they only touch. @param {Ends} one @param {Ends} other */
function crossingOf({ from: a, to: b }, { from: c, to: d }) {
  const [abc, abd, cda, cdb] = [cross(a, b, c), cross(a, b, d), cross(c, d, a), cross(c, d, b)];
  if (abc * abd >= 0 || cda * cdb >= 0) return null;
  const share = cda / (cda - cdb);
  return [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])];
}

/** Where two sides meet, touching included; null where they do not. @param {Ends} one @param {Ends} other */
export function meetingOf(one, other) {
  const [{ from: a, to: b }, { from: c, to: d }] = [one, other];
  const crossing = crossingOf(one, other);
  if (crossing) return crossing;
  if (cross(a, b, c) === 0 && isBetween(c, a, b)) return c;
  if (cross(a, b, d) === 0 && isBetween(d, a, b)) return d;
  if (cross(c, d, a) === 0 && isBetween(a, c, d)) return a;
  if (cross(c, d, b) === 0 && isBetween(b, c, d)) return b;
  return null;
}

/**
 * A place of the stretch that two sides have in common; null where they have none, or only a point.
 *
 * @param {Ends} one
 * @param {Ends} other
 */
function overlapOf({ from: a, to: b }, { from: c, to: d }) {
  if (cross(a, b, c) !== 0 || cross(a, b, d) !== 0) return null;
  const axis = Math.abs(b[0] - a[0]) >= Math.abs(b[1] - a[1]) ? 0 : 1;
  const [first, second] = [
    [a, b],
    [c, d],
  ].map((side) => [...side].sort((p, q) => p[axis] - q[axis]));
  const begins = first[0][axis] > second[0][axis] ? first[0] : second[0];
  const ends = first[1][axis] < second[1][axis] ? first[1] : second[1];
  return begins[axis] < ends[axis] ? begins : null;
}

/** @param {Shape} shape @returns {Fault[]} */
function strayRings(shape) {
  const holes = shape.parts.flatMap(([outer, ...rest]) =>
    rest
      .filter((hole) => hole.length >= 3 && !hole.some((position) => isInside(position, outer)))
      .map((hole) => ({ message: t("A hole lies outside of the area."), position: hole[0], sides: [] })),
  );
  const parts = shape.parts.flatMap(([outer], index) =>
    shape.parts.some(
      ([other, ...gaps], number) =>
        number !== index &&
        outer.every((position) => isInside(position, other)) &&
        !gaps.some((gap) => isInside(outer[0], gap)),
    )
      ? [{ message: t("A part lies within another."), position: outer[0], sides: [] }]
      : [],
  );
  return [...holes, ...parts];
}
