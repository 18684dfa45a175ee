/** Zones as volumes: walls from limit to limit, a floor and a ceiling; over the ground they follow it. Values in, arrays out. */

import { area2, refined, triangulate } from "./triangulate.js";

const EDGE_M = 60; // no side of a wall or cap that follows the ground is longer, where the ground is finer than that
const FLAT_EDGE_M = 2_000;
const MOST_TRIANGLES = 16_000; // of a floor or ceiling, about
const ON_CLIP_DEG = 1e-6;
const LIFT_M = 0.6; // a floor on the ground lies so far above it

/** y of a limit { above, m } at a place. An open one: the ground below, or the height that open zones are drawn to. */
export function limitHeight(limit, side, x, z, { frame, heightAt, open_top_agl_m }) {
  if (limit.above === "ground") return heightAt(x, z) + limit.m;
  if (limit.above === "sea") return limit.m - frame.origin.altitude_amsl_m;
  return heightAt(x, z) + (side === "upper" ? open_top_agl_m : 0);
}

/**
 * One zone. Gives { walls: { vertices, uv (metres along, metres up), fade (1, or 0 where it ends without a limit), index }, caps: { vertices, index }, edges: Float32Array of segments
 * (x, y, z, x, y, z), middle: [x, y, z] over its ceiling }. Walls are left out where the scene was cut (`clip`).
 */
export function zoneVolume(zone, { frame, ground, clip, rules }) {
  const room = { frame, heightAt: ground.heightAt, open_top_agl_m: rules.open_top_agl_m };
  const step_m = follows(zone) && !isLevel(ground) ? stepOver(zone, frame, ground) : FLAT_EDGE_M;
  const low = (x, z) => Math.max(limitHeight(zone.lower, "lower", x, z, room), ground.heightAt(x, z) + LIFT_M);
  const high = (x, z) => Math.max(limitHeight(zone.upper, "upper", x, z, room), low(x, z));
  const isOpen = zone.upper.above === "open";
  const walls = { vertices: [], uv: [], fade: [], index: [] };
  const caps = { vertices: [], index: [] };
  const edges = [];
  let largest = null;
  for (const rings of zone.polygons) {
    for (const ring of rings.map(facingOut)) addWalls(ring, { frame, clip, step_m, low, high, isOpen, walls, edges });
    const flat = rings.map((ring) => ring.map(([lon, lat]) => local(frame, lon, lat)));
    const { points, triangles } = refined(triangulate(flat), step_m);
    addCap(caps, points, triangles, low, 1);
    if (!isOpen) addCap(caps, points, triangles, high, -1);
    largest = larger(largest, points, triangles);
  }
  const [x, z] = largest?.middle ?? [0, 0];
  return {
    walls: { vertices: Float32Array.from(walls.vertices), uv: Float32Array.from(walls.uv), fade: Float32Array.from(walls.fade), index: Uint32Array.from(walls.index) },
    caps: { vertices: Float32Array.from(caps.vertices), index: Uint32Array.from(caps.index) },
    edges: Float32Array.from(edges),
    middle: [x, high(x, z), z],
  };
}

/** The ring so turned that walls along it show their front to the outside: outlines one way round, holes the other. */
function facingOut(ring, number) {
  return area2(ring) > 0 === (number === 0) ? ring : [...ring].reverse();
}

/** As fine as the ground is known, and EDGE_M at least; coarser for zones of more than some 14 square kilometres. */
function stepOver(zone, frame, ground) {
  const area_m2 = zone.polygons.reduce((sum, [outline]) => sum + Math.abs(area2(outline.map(([lon, lat]) => local(frame, lon, lat)))) / 2, 0);
  return Math.max(EDGE_M, Math.min(ground.stepX, ground.stepZ), Math.sqrt((4 * area_m2) / MOST_TRIANGLES));
}

function follows(zone) {
  return zone.lower.above !== "sea" || zone.upper.above !== "sea";
}

function isLevel({ heights }) {
  return heights.every((height) => height === heights[0]);
}

function local(frame, lon, lat) {
  const [x, , z] = frame.toLocal(lon, lat, 0);
  return [x, z];
}

function addWalls(ring, { frame, clip, step_m, low, high, isOpen, walls, edges }) {
  let along_m = 0;
  for (let at = 0; at < ring.length - 1; at += 1) {
    const [start, end] = [local(frame, ...ring[at]), local(frame, ...ring[at + 1])];
    const length = Math.hypot(end[0] - start[0], end[1] - start[1]);
    if (length === 0) continue;
    const isCut = liesOn(clip, ring[at], ring[at + 1]);
    const pieces = Math.ceil(length / step_m);
    const corners = [];
    for (let piece = 0; piece <= pieces; piece += 1) {
      const [x, z] = [0, 1].map((axis) => start[axis] + ((end[axis] - start[axis]) * piece) / pieces);
      corners.push({ x, z, low: low(x, z), high: high(x, z), along: along_m + (length * piece) / pieces });
    }
    along_m += length;
    if (isCut) continue;
    for (let piece = 0; piece < pieces; piece += 1) addPanel(walls, edges, corners[piece], corners[piece + 1], isOpen);
    const { x, z, low: bottom, high: top } = corners[0];
    if (isCorner(ring, at) && !isOpen) edges.push(x, bottom, z, x, top, z);
  }
}

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

/** Whether the outline turns there by 20 degrees or more: a circle has no upright edges. */
function isCorner(ring, at) {
  const last = ring.length - 2;
  const [before, here, after] = [ring[at === 0 ? last : at - 1], ring[at], ring[at + 1]];
  const [a, b] = [Math.atan2(here[1] - before[1], here[0] - before[0]), Math.atan2(after[1] - here[1], after[0] - here[0])];
  return Math.abs(Math.atan2(Math.sin(b - a), Math.cos(b - a))) > Math.PI / 9;
}

/** Whether a side of an outline is where the scene was cut. */
function liesOn([west, south, east, north], [lon, lat], [nextLon, nextLat]) {
  const on = (value, next, edge) => Math.abs(value - edge) < ON_CLIP_DEG && Math.abs(next - edge) < ON_CLIP_DEG;
  return on(lon, nextLon, west) || on(lon, nextLon, east) || on(lat, nextLat, south) || on(lat, nextLat, north);
}

function addCap({ vertices, index }, points, triangles, heightOf, turn) {
  const first = vertices.length / 3;
  for (const [x, z] of points) vertices.push(x, heightOf(x, z), z);
  for (let at = 0; at < triangles.length; at += 3) {
    const [a, b, c] = [triangles[at], triangles[at + 1], triangles[at + 2]].map((place) => first + place);
    index.push(a, ...(turn > 0 ? [b, c] : [c, b]));
  }
}

/** The middle of the piece with the greatest area, by its triangles. */
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
