/**
 * A shape that is drawn, and every step that changes it. Shapes are immutable: steps return a new one.
 *
 * { kind: "point" | "line" | "area" | "circle", parts: [[ring, …], …], radius_m }
 * A ring is a list of positions [lon, lat]; a point has one ring of one position, a line one ring, an area its outer ring first and then
 * its holes, none of them repeating the first position; a circle has its centre and `radius_m`.
 */

import { beside, distance_m, towards } from "../domain/geodesy.js";

/** @import { Shape, ShapeKind, VertexPath } from "./types.d.ts" */

/**
 * @typedef {{ type: "Point", coordinates: number[] } | { type: "LineString", coordinates: number[][] }
 *   | { type: "Polygon", coordinates: number[][][] } | { type: "MultiPolygon", coordinates: number[][][][] }} DrawnGeometry GeoJSON
 */

/** @type {Record<ShapeKind, number>} */
const MIN_POINTS = { point: 1, line: 2, area: 3, circle: 1 };

/** @param {ShapeKind} kind @returns {Shape} */
export const empty = (kind) => ({ kind, parts: [[[]]], radius_m: kind === "circle" ? 0 : null });
/** @param {Shape} shape */
export const isEmpty = (shape) => shape.parts.every((part) => part.every((ring) => ring.length === 0));
/** @param {ShapeKind} kind */
export const leastOf = (kind) => MIN_POINTS[kind];

/** @param {number[][]} ring */
const open = (ring) => (ring.length > 1 && same(ring[0], ring[ring.length - 1]) ? ring.slice(0, -1) : ring);
/** @param {number[]} a @param {number[]} b */
const same = (a, b) => a[0] === b[0] && a[1] === b[1];
/** @param {number[]} position */
const flat = ([longitude, latitude]) => [longitude, latitude]; // heights of a file are no part of a shape

/**
 * From GeoJSON, or from a circle { centre, radius_m } that stands behind an area.
 *
 * @param {DrawnGeometry | null} geometry
 * @param {{ centre: number[], radius_m: number } | null} [circle]
 * @returns {Shape}
 */
export function shapeOf(geometry, circle = null) {
  if (circle) return { kind: "circle", parts: [[[flat(circle.centre)]]], radius_m: circle.radius_m };
  if (!geometry) return empty("circle");
  if (geometry.type === "Point") return { kind: "point", parts: [[[flat(geometry.coordinates)]]], radius_m: null };
  if (geometry.type === "LineString")
    return { kind: "line", parts: [[geometry.coordinates.map(flat)]], radius_m: null };
  const polygons = geometry.type === "Polygon" ? [geometry.coordinates] : geometry.coordinates;
  return { kind: "area", parts: polygons.map((rings) => rings.map((ring) => open(ring.map(flat)))), radius_m: null };
}

/** GeoJSON; null as long as the shape has too few vertices. @param {Shape} shape @returns {DrawnGeometry | null} */
export function geometryOf(shape) {
  if (shape.kind === "circle") return null;
  const parts = shape.parts
    .map((rings) => rings.filter((ring, index) => index === 0 || ring.length >= MIN_POINTS.area))
    .filter((rings) => rings[0].length >= MIN_POINTS[shape.kind]);
  if (!parts.length) return null;
  if (shape.kind === "point") return { type: "Point", coordinates: parts[0][0][0] };
  if (shape.kind === "line") return { type: "LineString", coordinates: parts[0][0] };
  const closed = parts.map((rings) => rings.map((ring) => [...ring, ring[0]]));
  return closed.length === 1
    ? { type: "Polygon", coordinates: closed[0] }
    : { type: "MultiPolygon", coordinates: closed };
}

/** @param {Shape} shape */
export function circleOf(shape) {
  const centre = shape.parts[0][0][0];
  return shape.kind === "circle" && centre && shape.radius_m ? { centre, radius_m: shape.radius_m } : null;
}

/** Every vertex: { at: [part, ring, index], position }. @param {Shape} shape */
export function verticesOf(shape) {
  return shape.parts.flatMap((part, p) =>
    part.flatMap((ring, r) => ring.map((position, i) => ({ at: [p, r, i], position }))),
  );
}

/** The middle of every side: { after: [part, ring, index], position }. @param {Shape} shape */
export function middlesOf(shape) {
  if (shape.kind === "point" || shape.kind === "circle") return [];
  return shape.parts.flatMap((part, p) =>
    part.flatMap((ring, r) => {
      const closes = shape.kind === "area" && ring.length > 2;
      return ring.slice(0, closes ? undefined : -1).map((position, i) => {
        const next = ring[(i + 1) % ring.length];
        return {
          after: [p, r, i],
          position: [round((position[0] + beside(position[0], next[0])) / 2), (position[1] + next[1]) / 2],
        };
      });
    }),
  );
}

/** @param {Shape} shape @param {VertexPath} at @param {(ring: number[][]) => number[][]} change @returns {Shape} */
function withRing(shape, [p, r], change) {
  const parts = shape.parts.map((part, index) =>
    index === p ? part.map((ring, number) => (number === r ? change(ring) : ring)) : part,
  );
  return { ...shape, parts };
}

/** @param {Shape} shape @param {VertexPath} at @returns {number[] | null} */
export const positionAt = (shape, [p, r, i]) => shape.parts[p]?.[r]?.[i] ?? null;
/** @param {Shape} shape @param {VertexPath} at @returns {number[][]} */
export const ringAt = (shape, [p, r]) => shape.parts[p]?.[r] ?? [];

/** @param {Shape} shape @param {VertexPath} at @param {number[]} position */
export const move = (shape, at, position) =>
  withRing(shape, at, (ring) => ring.map((old, index) => (index === at[2] ? position : old)));
/** @param {Shape} shape @param {VertexPath} at @param {number[]} position */
export const insertAfter = (shape, at, position) =>
  withRing(shape, at, (ring) => [...ring.slice(0, at[2] + 1), position, ...ring.slice(at[2] + 1)]);
/** At the end of a ring, as drawing does. @param {Shape} shape @param {VertexPath} at @param {number[]} position */
export const append = (shape, at, position) => withRing(shape, at, (ring) => [...ring, position]);
/** @param {Shape} shape @param {VertexPath} at */
export const dropLast = (shape, at) => withRing(shape, at, (ring) => ring.slice(0, -1));

/**
 * Remove the vertex. A ring left with too few vertices is removed too; if it is the last one, the shape is unchanged.
 *
 * @param {Shape} shape
 * @param {VertexPath} at
 */
export function removeVertex(shape, at) {
  if (ringAt(shape, at).length > MIN_POINTS[shape.kind])
    return withRing(shape, at, (old) => old.filter((_, index) => index !== at[2]));
  return removeRing(shape, at);
}

/**
 * Without a hole, or without a part where there are others.
 *
 * @param {Shape} shape
 * @param {VertexPath} at
 * @returns {Shape}
 */
export function removeRing(shape, [p, r]) {
  if (shape.kind !== "area") return shape;
  if (r > 0)
    return {
      ...shape,
      parts: shape.parts.map((part, index) => (index === p ? part.filter((_, number) => number !== r) : part)),
    };
  return shape.parts.length > 1 ? { ...shape, parts: shape.parts.filter((_, index) => index !== p) } : shape;
}

/** @param {Shape} shape @param {number} p @returns {Shape} */
export const addHole = (shape, p) => ({
  ...shape,
  parts: shape.parts.map((part, index) => (index === p ? [...part, []] : part)),
});
/** @param {Shape} shape @returns {Shape} */
export const addPart = (shape) => ({ ...shape, parts: [...shape.parts, [[]]] });
/** [part, ring] of a ring that has too few positions yet, or null. @param {Shape} shape @returns {VertexPath | null} */
export function stubOf(shape) {
  if (shape.kind === "circle") return shape.parts[0][0].length && shape.radius_m ? null : [0, 0];
  for (const [p, part] of shape.parts.entries())
    for (const [r, ring] of part.entries()) if (ring.length < MIN_POINTS[shape.kind]) return [p, r];
  return null;
}

/** The shape without unfinished rings. @param {Shape} shape @returns {Shape} */
export function withoutStubs(shape) {
  if (shape.kind !== "area") return shape;
  const parts = shape.parts
    .map((part) => part.filter((ring, index) => index === 0 || ring.length >= MIN_POINTS.area))
    .filter((part) => part[0].length >= MIN_POINTS.area);
  return { ...shape, parts: parts.length ? parts : [[[]]] };
}

/**
 * A hole that was drawn in another part than it began from belongs to that part.
 *
 * @param {Shape} shape
 * @returns {Shape}
 */
export function seated(shape) {
  if (shape.kind !== "area" || shape.parts.length < 2) return shape;
  const homes = shape.parts.map(([outer]) => [outer]);
  for (const [index, [outer, ...holes]] of shape.parts.entries()) {
    for (const hole of holes) {
      const home = isInside(hole[0], outer) ? index : shape.parts.findIndex(([other]) => isInside(hole[0], other));
      homes[home < 0 ? index : home].push(hole);
    }
  }
  return { ...shape, parts: homes };
}

/** @param {number[]} position @param {number[][]} ring */
export function isInside([x, y], ring) {
  let inside = false;
  ring.forEach(([longitude, ay], index) => {
    const [nextLon, by] = ring[(index + 1) % ring.length];
    const ax = beside(x, longitude);
    const bx = beside(ax, nextLon);
    if (ay > y !== by > y && x < ((bx - ax) * (y - ay)) / (by - ay) + ax) inside = !inside;
  });
  return inside;
}

/** The whole shape, by degrees. @param {Shape} shape @param {number[]} by east, north [deg] @returns {Shape} */
export const moveAll = (shape, [east, north]) => ({
  ...shape,
  parts: shape.parts.map((part) =>
    part.map((ring) => ring.map(([longitude, latitude]) => rounded([longitude + east, latitude + north]))),
  ),
});

/** @param {Shape} shape @param {number} radius_m @returns {Shape} */
export const withRadius = (shape, radius_m) => ({ ...shape, radius_m });
/** Position of the handle of a circle's radius: east of its centre. @param {Shape} shape */
export function radiusHandle(shape) {
  const circle = circleOf(shape);
  return circle && towards(circle.centre, 90, circle.radius_m);
}
/** @param {Shape} shape @param {number[]} position */
export const radiusTo = (shape, position) =>
  withRadius(shape, Math.max(1, Math.round(distance_m(shape.parts[0][0][0], position))));

/** @param {number} longitude */
const wrap = (longitude) => (Math.abs(longitude) <= 180 ? longitude : longitude - 360 * Math.round(longitude / 360));
/**
 * Rounded to seven decimals, about a centimetre, as stored; longitudes beyond ±180 are wrapped.
 *
 * @param {number} degrees
 */
export const round = (degrees) => Number(wrap(degrees).toFixed(7));
/** @param {number[]} position @returns {[number, number]} */
export const rounded = ([longitude, latitude]) => [round(longitude), round(Math.max(-90, Math.min(90, latitude)))];
