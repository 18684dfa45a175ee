/**
 * What is being drawn, and every step that changes it. A shape is a value: steps give a new one.
 *
 * { kind: "point" | "line" | "area" | "circle", parts: [[ring, …], …], radius_m }
 * A ring is a list of positions [lon, lat]; a point has one ring of one position, a line one ring, an area its outer ring first and then
 * its holes, none of them repeating the first position; a circle has its centre and `radius_m`.
 */

import { distance_m, towards } from "./measure.js";

const LEAST = { point: 1, line: 2, area: 3, circle: 1 };

export const empty = (kind) => ({ kind, parts: [[[]]], radius_m: kind === "circle" ? 0 : null });
export const isEmpty = (shape) => shape.parts.every((part) => part.every((ring) => ring.length === 0));
export const leastOf = (kind) => LEAST[kind];

const open = (ring) => (ring.length > 1 && same(ring[0], ring.at(-1)) ? ring.slice(0, -1) : ring);
const same = (a, b) => a[0] === b[0] && a[1] === b[1];
const flat = ([longitude, latitude]) => [longitude, latitude]; // heights of a file are no part of a shape

/** From GeoJSON, or from a circle { centre, radius_m } that stands behind an area. */
export function shapeOf(geometry, circle = null) {
  if (circle) return { kind: "circle", parts: [[[flat(circle.centre)]]], radius_m: circle.radius_m };
  const { type, coordinates } = geometry;
  if (type === "Point") return { kind: "point", parts: [[[flat(coordinates)]]], radius_m: null };
  if (type === "LineString") return { kind: "line", parts: [[coordinates.map(flat)]], radius_m: null };
  const polygons = type === "Polygon" ? [coordinates] : coordinates;
  return { kind: "area", parts: polygons.map((rings) => rings.map((ring) => open(ring.map(flat)))), radius_m: null };
}

/** GeoJSON; null as long as there is too little of it. */
export function geometryOf(shape) {
  if (shape.kind === "circle") return null;
  const parts = shape.parts.map((rings) => rings.filter((ring, index) => index === 0 || ring.length >= LEAST.area)).filter((rings) => rings[0].length >= LEAST[shape.kind]);
  if (!parts.length) return null;
  if (shape.kind === "point") return { type: "Point", coordinates: parts[0][0][0] };
  if (shape.kind === "line") return { type: "LineString", coordinates: parts[0][0] };
  const closed = parts.map((rings) => rings.map((ring) => [...ring, ring[0]]));
  return closed.length === 1 ? { type: "Polygon", coordinates: closed[0] } : { type: "MultiPolygon", coordinates: closed };
}

export function circleOf(shape) {
  const centre = shape.parts[0][0][0];
  return shape.kind === "circle" && centre && shape.radius_m > 0 ? { centre, radius_m: shape.radius_m } : null;
}

/** Every vertex: { at: [part, ring, index], position }. */
export function verticesOf(shape) {
  return shape.parts.flatMap((part, p) => part.flatMap((ring, r) => ring.map((position, i) => ({ at: [p, r, i], position }))));
}

/** The middle of every side: { after: [part, ring, index], position }. */
export function middlesOf(shape) {
  if (shape.kind === "point" || shape.kind === "circle") return [];
  return shape.parts.flatMap((part, p) =>
    part.flatMap((ring, r) => {
      const closes = shape.kind === "area" && ring.length > 2;
      return ring.slice(0, closes ? undefined : -1).map((position, i) => {
        const next = ring[(i + 1) % ring.length];
        return { after: [p, r, i], position: [(position[0] + next[0]) / 2, (position[1] + next[1]) / 2] };
      });
    }),
  );
}

function withRing(shape, [p, r], change) {
  const parts = shape.parts.map((part, index) => (index === p ? part.map((ring, number) => (number === r ? change(ring) : ring)) : part));
  return { ...shape, parts };
}

export const positionAt = (shape, [p, r, i]) => shape.parts[p]?.[r]?.[i] ?? null;
export const ringAt = (shape, [p, r]) => shape.parts[p]?.[r] ?? [];

export const move = (shape, at, position) => withRing(shape, at, (ring) => ring.map((old, index) => (index === at[2] ? position : old)));
export const insertAfter = (shape, at, position) => withRing(shape, at, (ring) => [...ring.slice(0, at[2] + 1), position, ...ring.slice(at[2] + 1)]);
/** At the end of a ring, as drawing does. */
export const append = (shape, at, position) => withRing(shape, at, (ring) => [...ring, position]);
export const dropLast = (shape, at) => withRing(shape, at, (ring) => ring.slice(0, -1));

/** Without the vertex; a hole that is left with two goes with it, an outer ring or a line keeps what it needs: then the same shape. */
export function removeVertex(shape, at) {
  const [p, r] = at;
  const ring = ringAt(shape, at);
  if (ring.length > LEAST[shape.kind]) return withRing(shape, at, (old) => old.filter((_, index) => index !== at[2]));
  if (shape.kind === "area" && r > 0) return { ...shape, parts: shape.parts.map((part, index) => (index === p ? part.filter((_, number) => number !== r) : part)) };
  if (shape.kind === "area" && shape.parts.length > 1) return { ...shape, parts: shape.parts.filter((_, index) => index !== p) };
  return shape;
}

export const addHole = (shape, p) => ({ ...shape, parts: shape.parts.map((part, index) => (index === p ? [...part, []] : part)) });
export const addPart = (shape) => ({ ...shape, parts: [...shape.parts, [[]]] });
/** Without rings that were begun and not finished. */
export function withoutStubs(shape) {
  if (shape.kind !== "area") return shape;
  const parts = shape.parts.map((part) => part.filter((ring, index) => index === 0 || ring.length >= LEAST.area)).filter((part) => part[0].length >= LEAST.area);
  return { ...shape, parts: parts.length ? parts : [[[]]] };
}

export const moveAll = (shape, [east, north]) => ({
  ...shape,
  parts: shape.parts.map((part) => part.map((ring) => ring.map(([longitude, latitude]) => [round(longitude + east), round(latitude + north)]))),
});

export const withRadius = (shape, radius_m) => ({ ...shape, radius_m });
/** Where the handle of a circle's radius stands: east of its centre. */
export const radiusHandle = (shape) => (circleOf(shape) ? towards(shape.parts[0][0][0], 90, shape.radius_m) : null);
export const radiusTo = (shape, position) => withRadius(shape, Math.max(1, Math.round(distance_m(shape.parts[0][0][0], position))));

/** Seven decimals, about a centimetre: what is stored. */
export const round = (degrees) => Number(degrees.toFixed(7));
