/** Zones as volumes: walls from limit to limit, a floor and a ceiling; over the ground they follow it. Values in, arrays out. */

import { cutBy } from "./folds.js";
import { area2, triangulate } from "./triangulate.js";

/** @import { Scene, SceneLimit, SceneRules, SceneZone } from "../../api_types.d.ts" */
/** @import { Frame, HeightAt, Ring, SurfaceParts, Vector } from "../types.d.ts" */
/** @import { Folds } from "./folds.js" */
/** @import { Ground } from "./ground.js" */

/** @typedef {Pick<SceneZone, "polygons" | "lower" | "upper">} Volume extent of a zone */
/** @typedef {{ level: number, over: number }} Height the higher of a level y and the ground's with so much over it */
/** @typedef {SurfaceParts & { uv: number[], fade: number[] }} WallParts */
/** @typedef {{ x: number, z: number, low: number, high: number, share: number, along: number }} WallCorner */
/** @typedef {{ area: number, middle: [x: number, z: number] }} Largest */
/** @typedef {ReturnType<typeof zoneVolume>} ZoneVolume */

export const WITHIN_M = 0.15; // largest deviation of a floor, ceiling or wall from the surface that it follows
const MAX_BLOCKS = 300_000; // of the ground, under all floors and ceilings of a scene that follow it
const ON_CLIP_DEG = 1e-6;
const LIFT_M = 0.25; // height of such a floor above the ground

/**
 * The permitted deviation of zones from the ground that they follow: WITHIN_M, more where there would be too many triangles.
 *
 * @param {readonly Volume[]} zones
 * @param {Frame} frame
 * @param {Folds} folds
 */
export function withinFor(zones, frame, folds) {
  const following = zones.flatMap((zone) =>
    [zone.lower, zone.upper].filter(({ above }) => above !== "sea").map(() => zone),
  );
  const boxes = following.flatMap(({ polygons }) =>
    polygons.map(([outline]) => boxOf(outline.map((place) => local(frame, place)))),
  );
  let within_m = WITHIN_M;
  while (boxes.reduce((sum, box) => sum + folds.count(box, within_m), 0) > MAX_BLOCKS) within_m *= 2;
  return within_m;
}

/**
 * A limit { above, m } as { level, over }: the higher of a level y and the ground's with so much over it. An open one: the ground below, or the height that open zones are drawn to.
 *
 * @param {SceneLimit} limit
 * @param {"lower" | "upper"} side
 * @param {{ frame: Frame, open_top_agl_m: number }} room
 * @returns {Height}
 */
function surfaceOf(limit, side, { frame, open_top_agl_m }) {
  const limit_m = limit.m ?? 0;
  if (limit.above === "ground") return { level: -Infinity, over: limit_m };
  if (limit.above === "sea") return { level: limit_m - frame.origin.altitude_amsl_m, over: -Infinity };
  return { level: -Infinity, over: side === "upper" ? open_top_agl_m : 0 };
}

/** @param {Height} one @param {Height} other @returns {Height} */
const higherOf = (one, other) => ({ level: Math.max(one.level, other.level), over: Math.max(one.over, other.over) });

/**
 * One zone. Gives { walls: { vertices, uv (metres along, metres up), fade (1, or 0 where it ends without a limit), index }, caps: { vertices, index }, edges: Float32Array of segments
 * (x, y, z, x, y, z), middle: [x, y, z] over its ceiling }. Walls are left out where the scene was cut (`clip`). folds: of the ground.
 *
 * @param {Volume} zone
 * @param {{ frame: Frame, ground: Ground, folds: Folds, clip: Scene["clip"], rules: Pick<SceneRules, "open_top_agl_m">, within_m?: number }} world
 */
export function zoneVolume(zone, { frame, ground, folds, clip, rules, within_m = WITHIN_M }) {
  const room = { frame, open_top_agl_m: rules.open_top_agl_m };
  const floor = higherOf(surfaceOf(zone.lower, "lower", room), { level: -Infinity, over: LIFT_M });
  const ceiling = higherOf(surfaceOf(zone.upper, "upper", room), floor);
  const [low, high] = [floor, ceiling].map(
    ({ level, over }) =>
      /** @type {HeightAt} */
      (x, z) =>
        Math.max(level, ground.heightAt(x, z) + over),
  );
  const isOpen = zone.upper.above === "open";
  /** @type {WallParts} */
  const walls = { vertices: [], uv: [], fade: [], index: [] };
  /** @type {SurfaceParts} */
  const caps = { vertices: [], index: [] };
  /** @type {number[]} */
  const edges = [];
  /** @type {Largest | null} */
  let largest = null;
  for (const rings of zone.polygons) {
    for (const ring of rings.map(facingOut))
      addWalls(ring, {
        frame,
        ground,
        folds,
        clip,
        low,
        high,
        kinks: [floor, ceiling],
        isOpen,
        within_m,
        walls,
        edges,
      });
    const { points, triangles } = triangulate(rings.map((ring) => ring.map((place) => local(frame, place))));
    const parts = Array.from({ length: triangles.length / 3 }, (_, place) =>
      [0, 1, 2].map((corner) => points[triangles[place * 3 + corner]]),
    );
    addCap(caps, parts, floor, low, 1, { ground, folds, within_m });
    if (!isOpen) addCap(caps, parts, ceiling, high, -1, { ground, folds, within_m });
    largest = larger(largest, points, triangles);
  }
  const [x, z] = largest?.middle ?? [0, 0];
  /** @type {Vector} */
  const middle = [x, high(x, z), z];
  return {
    walls: {
      vertices: Float32Array.from(walls.vertices),
      uv: Float32Array.from(walls.uv),
      fade: Float32Array.from(walls.fade),
      index: Uint32Array.from(walls.index),
    },
    caps: { vertices: Float32Array.from(caps.vertices), index: Uint32Array.from(caps.index) },
    edges: Float32Array.from(edges),
    middle,
  };
}

/**
 * The ring so turned that walls along it show their front to the outside: outlines one way round, holes the other.
 *
 * @param {Ring} ring
 * @param {number} number
 */
function facingOut(ring, number) {
  return area2(ring) > 0 === (number === 0) ? ring : [...ring].reverse();
}

/** @param {Frame} frame @param {number[]} place lon, lat */
function local(frame, [lon, lat]) {
  const [x, , z] = frame.toLocal(lon, lat, 0);
  return [x, z];
}

/** @param {Ring} points */
function boxOf(points) {
  return [0, 1]
    .map((axis) => points.reduce((least, point) => Math.min(least, point[axis]), Infinity))
    .concat([0, 1].map((axis) => points.reduce((most, point) => Math.max(most, point[axis]), -Infinity)));
}

/**
 * @param {Ring} ring
 * @param {object} how
 * @param {Frame} how.frame
 * @param {Ground} how.ground
 * @param {Folds} how.folds
 * @param {number[]} how.clip
 * @param {HeightAt} how.low
 * @param {HeightAt} how.high
 * @param {Height[]} how.kinks surfaces that go over from a level to following the ground
 * @param {boolean} how.isOpen
 * @param {number} how.within_m
 * @param {WallParts} how.walls that they are added to
 * @param {number[]} how.edges likewise
 */
function addWalls(ring, { frame, ground, folds, clip, low, high, kinks, isOpen, within_m, walls, edges }) {
  let along_m = 0;
  for (let at = 0; at < ring.length - 1; at += 1) {
    const [start, end] = [local(frame, ring[at]), local(frame, ring[at + 1])];
    const length = Math.hypot(end[0] - start[0], end[1] - start[1]);
    if (length === 0) continue;
    /** @param {number} share */
    const corner = (share) => {
      const [x, z] = [0, 1].map((axis) => start[axis] + (end[axis] - start[axis]) * share);
      return { x, z, low: low(x, z), high: high(x, z), share, along: along_m + length * share };
    };
    if (!liesOn(clip, ring[at], ring[at + 1])) {
      const shares = withKinks(
        [0, ...folds.meeting(start, end), 1],
        (share) => ground.heightAt(start[0] + (end[0] - start[0]) * share, start[1] + (end[1] - start[1]) * share),
        kinks,
      );
      const corners = straightened(shares.map(corner), within_m);
      for (let piece = 1; piece < corners.length; piece += 1)
        addPanel(walls, edges, corners[piece - 1], corners[piece], isOpen);
      const { x, z, low: bottom, high: top } = corners[0];
      if (isCorner(ring, at) && !isOpen) edges.push(x, bottom, z, x, top, z);
    }
    along_m += length;
  }
}

/**
 * The shares, with those where a surface changes between its level and the ground.
 *
 * @param {readonly number[]} shares
 * @param {(share: number) => number} groundAt
 * @param {readonly Height[]} surfaces
 */
function withKinks(shares, groundAt, surfaces) {
  const found = [...shares];
  for (const { level, over } of surfaces) {
    if (!Number.isFinite(level) || !Number.isFinite(over)) continue;
    let before = groundAt(0) + over - level;
    for (let at = 1; at < shares.length; at += 1) {
      const after = groundAt(shares[at]) + over - level;
      if (before * after < 0) found.push(shares[at - 1] + ((shares[at] - shares[at - 1]) * before) / (before - after));
      before = after;
    }
  }
  return found.sort((one, other) => one - other);
}

/**
 * Remove corners on the line between those kept, in both heights.
 *
 * @param {readonly WallCorner[]} corners
 * @param {number} within_m
 */
function straightened(corners, within_m) {
  const kept = [corners[0]];
  const spans = [[0, corners.length - 1]];
  for (let span = spans.pop(); span; span = spans.pop()) {
    const [from, to] = span;
    const [start, end] = [corners[from], corners[to]];
    let [worst, most] = [-1, within_m];
    for (let at = from + 1; at < to; at += 1) {
      const share = (corners[at].share - start.share) / (end.share - start.share || 1);
      /** @param {"low" | "high"} name */
      const strays = (name) => Math.abs(start[name] + share * (end[name] - start[name]) - corners[at][name]);
      const off = Math.max(strays("low"), strays("high"));
      if (off > most) [worst, most] = [at, off];
    }
    if (worst < 0) kept.push(end);
    else spans.push([worst, to], [from, worst]);
  }
  return kept;
}

/**
 * @param {WallParts} walls
 * @param {number[]} edges
 * @param {WallCorner} here
 * @param {WallCorner} there
 * @param {boolean} isOpen
 */
function addPanel({ vertices, uv, fade, index }, edges, here, there, isOpen) {
  const first = vertices.length / 3;
  for (const { x, z, low, high, along } of [here, there]) {
    vertices.push(x, low, z, x, high, z);
    uv.push(along, low, along, high);
    fade.push(1, isOpen ? 0 : 1);
  }
  index.push(first, first + 2, first + 1, first + 1, first + 2, first + 3);
  edges.push(here.x, here.low, here.z, there.x, there.low, there.z);
  if (!isOpen) edges.push(here.x, here.high, here.z, there.x, there.high, there.z);
}

/**
 * Whether the outline turns at the corner by 20 degrees or more: a circle has no upright edges.
 *
 * @param {Ring} ring
 * @param {number} at
 */
function isCorner(ring, at) {
  const last = ring.length - 2;
  const [before, here, after] = [ring[at === 0 ? last : at - 1], ring[at], ring[at + 1]];
  const [a, b] = [
    Math.atan2(here[1] - before[1], here[0] - before[0]),
    Math.atan2(after[1] - here[1], after[0] - here[0]),
  ];
  return Math.abs(Math.atan2(Math.sin(b - a), Math.cos(b - a))) > Math.PI / 9;
}

/**
 * Whether a side of an outline lies on the cut of the scene.
 *
 * @param {number[]} clip
 * @param {number[]} place
 * @param {number[]} next
 */
function liesOn([west, south, east, north], [lon, lat], [nextLon, nextLat]) {
  /** @param {number} value @param {number} next @param {number} edge */
  const on = (value, next, edge) => Math.abs(value - edge) < ON_CLIP_DEG && Math.abs(next - edge) < ON_CLIP_DEG;
  return on(lon, nextLon, west) || on(lon, nextLon, east) || on(lat, nextLat, south) || on(lat, nextLat, north);
}

/**
 * A floor or ceiling of triangles, in pieces over which its surface is level or goes with a face of the ground.
 *
 * @param {SurfaceParts} caps
 * @param {Ring[]} parts
 * @param {Height} surface
 * @param {HeightAt} heightOf
 * @param {1 | -1} turn
 * @param {{ ground: Ground, folds: Folds, within_m: number }} world
 */
function addCap({ vertices, index }, parts, { level, over }, heightOf, turn, { ground, folds, within_m }) {
  /** @type {HeightAt} */
  const aboveLevel = (x, z) => ground.heightAt(x, z) + over - level;
  for (const piece of folds.pieces(parts, within_m, (highest) => highest + over <= level)) {
    for (const part of Number.isFinite(level)
      ? [cutBy(piece, aboveLevel), cutBy(piece, (x, z) => -aboveLevel(x, z))]
      : [piece]) {
      const first = vertices.length / 3;
      for (const [x, z] of part) vertices.push(x, heightOf(x, z), z);
      for (let at = 1; at < part.length - 1; at += 1)
        index.push(first, ...(turn > 0 ? [first + at, first + at + 1] : [first + at + 1, first + at]));
    }
  }
}

/**
 * The middle of the piece with the greatest area, by its triangles.
 *
 * @param {Largest | null} largest
 * @param {Ring} points
 * @param {readonly number[]} triangles
 * @returns {Largest | null}
 */
function larger(largest, points, triangles) {
  let [area, x, z] = [0, 0, 0];
  for (let at = 0; at < triangles.length; at += 3) {
    const [a, b, c] = [points[triangles[at]], points[triangles[at + 1]], points[triangles[at + 2]]];
    const own = Math.abs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
    area += own;
    x += (own * (a[0] + b[0] + c[0])) / 3;
    z += (own * (a[1] + b[1] + c[1])) / 3;
  }
  if (!area || (largest && largest.area >= area)) return largest;
  return { area, middle: [x / area, z / area] };
}
