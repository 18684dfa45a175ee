/**
 * What is being drawn, and every step that changes it. A shape is a value: steps give a new one.
 *
 * { kind: "point" | "line" | "area" | "circle", parts: [[ring, …], …], radius_m }
 * A ring is a list of positions [lon, lat]; a point has one ring of one position, a line one ring, an area its outer ring first and then
 * its holes, none of them repeating the first position; a circle has its centre and `radius_m`.
 */

import { beside, distance_m, towards } from "../domain/geodesy.js";

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
  const parts = shape.parts
    .map((rings) => rings.filter((ring, index) => index === 0 || ring.length >= LEAST.area))
    .filter((rings) => rings[0].length >= LEAST[shape.kind]);
  if (!parts.length) return null;
  if (shape.kind === "point") return { type: "Point", coordinates: parts[0][0][0] };
  if (shape.kind === "line") return { type: "LineString", coordinates: parts[0][0] };
  const closed = parts.map((rings) => rings.map((ring) => [...ring, ring[0]]));
  return closed.length === 1
    ? { type: "Polygon", coordinates: closed[0] }
    : { type: "MultiPolygon", coordinates: closed };
}

export function circleOf(shape) {
  const centre = shape.parts[0][0][0];
  return shape.kind === "circle" && centre && shape.radius_m > 0 ? { centre, radius_m: shape.radius_m } : null;
}

/** Every vertex: { at: [part, ring, index], position }. */
export function verticesOf(shape) {
  return shape.parts.flatMap((part, p) =>
    part.flatMap((ring, r) => ring.map((position, i) => ({ at: [p, r, i], position }))),
  );
}

/** The middle of every side: { after: [part, ring, index], position }. */
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

function withRing(shape, [p, r], change) {
  const parts = shape.parts.map((part, index) =>
    index === p ? part.map((ring, number) => (number === r ? change(ring) : ring)) : part,
  );
  return { ...shape, parts };
}

export const positionAt = (shape, [p, r, i]) => shape.parts[p]?.[r]?.[i] ?? null;
export const ringAt = (shape, [p, r]) => shape.parts[p]?.[r] ?? [];

export const move = (shape, at, position) =>
  withRing(shape, at, (ring) => ring.map((old, index) => (index === at[2] ? position : old)));
export const insertAfter = (shape, at, position) =>
  withRing(shape, at, (ring) => [...ring.slice(0, at[2] + 1), position, ...ring.slice(at[2] + 1)]);
/** At the end of a ring, as drawing does. */
export const append = (shape, at, position) => withRing(shape, at, (ring) => [...ring, position]);
export const dropLast = (shape, at) => withRing(shape, at, (ring) => ring.slice(0, -1));

/** Without the vertex; a ring that is left with too few goes with it, except the last of all: then it is the same shape. */
export function removeVertex(shape, at) {
  if (ringAt(shape, at).length > LEAST[shape.kind])
    return withRing(shape, at, (old) => old.filter((_, index) => index !== at[2]));
  return removeRing(shape, at);
}

/** Without a hole, or without a part where there are others. */
export function removeRing(shape, [p, r]) {
  if (shape.kind !== "area") return shape;
  if (r > 0)
    return {
      ...shape,
      parts: shape.parts.map((part, index) => (index === p ? part.filter((_, number) => number !== r) : part)),
    };
  return shape.parts.length > 1 ? { ...shape, parts: shape.parts.filter((_, index) => index !== p) } : shape;
}

export const addHole = (shape, p) => ({
  ...shape,
  parts: shape.parts.map((part, index) => (index === p ? [...part, []] : part)),
});
export const addPart = (shape) => ({ ...shape, parts: [...shape.parts, [[]]] });
/** [part, ring] of a ring that has too few positions yet, or null. */
export function stubOf(shape) {
  if (shape.kind === "circle") return shape.parts[0][0].length && shape.radius_m > 0 ? null : [0, 0];
  for (const [p, part] of shape.parts.entries())
    for (const [r, ring] of part.entries()) if (ring.length < LEAST[shape.kind]) return [p, r];
  return null;
}

/** Without rings that were begun and not finished. */
export function withoutStubs(shape) {
  if (shape.kind !== "area") return shape;
  const parts = shape.parts
    .map((part) => part.filter((ring, index) => index === 0 || ring.length >= LEAST.area))
    .filter((part) => part[0].length >= LEAST.area);
  return { ...shape, parts: parts.length ? parts : [[[]]] };
}

/** A hole that was drawn in another part than it began from belongs to that part. */
export function seated(shape) {
  if (shape.kind !== "area" || shape.parts.length < 2) return shape;
  const homes = shape.parts.map(([outer]) => [outer]);
  shape.parts.forEach(([outer, ...holes], index) =>
    holes.forEach((hole) => {
      const home = isInside(hole[0], outer) ? index : shape.parts.findIndex(([other]) => isInside(hole[0], other));
      homes[home < 0 ? index : home].push(hole);
    }),
  );
  return { ...shape, parts: homes };
}

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

/** The whole shape, by degrees. */
export const moveAll = (shape, [east, north]) => ({
  ...shape,
  parts: shape.parts.map((part) =>
    part.map((ring) => ring.map(([longitude, latitude]) => rounded([longitude + east, latitude + north]))),
  ),
});

export const withRadius = (shape, radius_m) => ({ ...shape, radius_m });
/** Where the handle of a circle's radius stands: east of its centre. */
export const radiusHandle = (shape) => (circleOf(shape) ? towards(shape.parts[0][0][0], 90, shape.radius_m) : null);
export const radiusTo = (shape, position) =>
  withRadius(shape, Math.max(1, Math.round(distance_m(shape.parts[0][0][0], position))));

const wrap = (longitude) => (Math.abs(longitude) <= 180 ? longitude : longitude - 360 * Math.round(longitude / 360));
/** Seven decimals, about a centimetre: what is stored; longitudes of a map that goes on round the earth come back to ±180. */
export const round = (degrees) => Number(wrap(degrees).toFixed(7));
export const rounded = ([longitude, latitude]) => [round(longitude), round(Math.max(-90, Math.min(90, latitude)))];
