/** What is wrong with a shape while it is being drawn: said at once; the server has the last word before anything is stored. */

import { leastOf } from "./shape.js";

export const MOST_CHECKED = 2_000; // vertices; of more the server says whether they cross
const MOST_FAULTS = 20;
const WORDS = {
  point: "Click where it stands.",
  line: "A line needs two points.",
  area: "An area needs three points.",
  circle: "Click the centre, then how far it reaches.",
};

/** [{ message, position, sides: [[from, to], …] }]; an empty list where nothing is wrong. */
export function faultsOf(shape) {
  if (shape.kind === "circle") return shape.parts[0][0].length && shape.radius_m > 0 ? [] : [{ message: WORDS.circle, position: null, sides: [] }];
  if (shape.parts.some(([outer]) => outer.length < leastOf(shape.kind))) return [{ message: WORDS[shape.kind], position: null, sides: [] }];
  const faults = [...repeated(shape), ...acrossTheDateLine(shape)];
  if (shape.kind !== "area" || faults.length) return faults;
  const sides = sidesOf(shape);
  if (sides.length > MOST_CHECKED) return [];
  faults.push(...crossings(sides));
  if (!faults.length) faults.push(...strayHoles(shape));
  return faults;
}

function repeated(shape) {
  const isSame = (a, b) => a[0] === b[0] && a[1] === b[1];
  const found = [];
  for (const ring of shape.parts.flat()) {
    ring.forEach((position, index) => {
      if (index && isSame(position, ring[index - 1])) found.push({ message: "Two points lie in one place.", position, sides: [] });
    });
  }
  return found;
}

function acrossTheDateLine(shape) {
  if (shape.kind !== "line") return [];
  const [path] = shape.parts[0];
  const index = path.findIndex((position, at) => at && Math.abs(position[0] - path[at - 1][0]) > 180);
  return index > 0 ? [{ message: "A line cannot cross the 180th meridian: draw it as two.", position: path[index], sides: [[path[index - 1], path[index]]] }] : [];
}

/** Sides of all rings: { from, to, ring, index, size, low, high }, where ring tells rings apart. */
function sidesOf(shape) {
  const sides = [];
  let number = 0;
  for (const ring of shape.parts.flat()) {
    ring.forEach((from, index) => {
      const to = ring[(index + 1) % ring.length];
      sides.push({ from, to, ring: number, index, size: ring.length, low: Math.min(from[0], to[0]), high: Math.max(from[0], to[0]) });
    });
    number += 1;
  }
  return sides;
}

/** Sweeps from west to east: only sides whose longitudes overlap are compared. */
function crossings(sides) {
  const found = [];
  const sorted = [...sides].sort((a, b) => a.low - b.low);
  let alive = [];
  for (const side of sorted) {
    alive = alive.filter((other) => other.high >= side.low);
    for (const other of alive) {
      const position = areNeighbours(side, other) ? overlapOf(side, other) : meetingOf(side, other);
      if (!position) continue;
      found.push({ message: "The border crosses itself.", position, sides: [[side.from, side.to], [other.from, other.to]] });
      if (found.length >= MOST_FAULTS) return found;
    }
    alive.push(side);
  }
  return found;
}

function areNeighbours(a, b) {
  if (a.ring !== b.ring) return false;
  const gap = Math.abs(a.index - b.index);
  return gap === 1 || gap === a.size - 1;
}

const cross = (o, a, b) => (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
const isBetween = (p, a, b) => Math.min(a[0], b[0]) <= p[0] && p[0] <= Math.max(a[0], b[0]) && Math.min(a[1], b[1]) <= p[1] && p[1] <= Math.max(a[1], b[1]);

/** Where two sides meet, touching included; null where they do not. */
export function meetingOf({ from: a, to: b }, { from: c, to: d }) {
  const [abc, abd, cda, cdb] = [cross(a, b, c), cross(a, b, d), cross(c, d, a), cross(c, d, b)];
  if (((abc > 0 && abd < 0) || (abc < 0 && abd > 0)) && ((cda > 0 && cdb < 0) || (cda < 0 && cdb > 0))) {
    const share = cda / (cda - cdb);
    return [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])];
  }
  if (abc === 0 && isBetween(c, a, b)) return c;
  if (abd === 0 && isBetween(d, a, b)) return d;
  if (cda === 0 && isBetween(a, c, d)) return a;
  if (cdb === 0 && isBetween(b, c, d)) return b;
  return null;
}

/** Neighbours share a point; they may not lie on each other. */
function overlapOf(a, b) {
  const shared = [a.from, a.to].find((end) => [b.from, b.to].some((other) => other[0] === end[0] && other[1] === end[1]));
  if (!shared) return meetingOf(a, b);
  const far = (side) => (side.from[0] === shared[0] && side.from[1] === shared[1] ? side.to : side.from);
  const [p, q] = [far(a), far(b)];
  if (cross(shared, p, q) !== 0) return null;
  const isSameWay = (p[0] - shared[0]) * (q[0] - shared[0]) + (p[1] - shared[1]) * (q[1] - shared[1]) > 0;
  return isSameWay ? shared : null;
}

function strayHoles(shape) {
  return shape.parts.flatMap(([outer, ...holes]) =>
    holes.filter((hole) => hole.length >= 3 && !isInside(hole[0], outer)).map((hole) => ({ message: "A hole lies outside of the area.", position: hole[0], sides: [] })),
  );
}

export function isInside([x, y], ring) {
  let inside = false;
  ring.forEach(([ax, ay], index) => {
    const [bx, by] = ring[(index + 1) % ring.length];
    if (ay > y !== by > y && x < ((bx - ax) * (y - ay)) / (by - ay) + ax) inside = !inside;
  });
  return inside;
}
