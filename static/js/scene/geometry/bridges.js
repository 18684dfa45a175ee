/** Bridges: a slab with its deck at the scene's height, and piers down to the ground. Values in, arrays out. */

import { triangulate } from "./triangulate.js";

/** @import { SceneBridge } from "../../api_types.d.ts" */
/** @import { Frame, Ring, SurfaceParts } from "../types.d.ts" */
/** @import { Ground } from "./ground.js" */

const SLAB_M = 1.4;
const PIER_EVERY_M = 30;
const PIER_M = 1.4; // along the bridge
const INSET_M = 1.5; // of abutments
const MIN_ROOM_M = 0.5; // below the slab, for a pier to be seen

/**
 * Gives { vertices, index } without normals: faces are flat.
 *
 * @param {Pick<SceneBridge, "deck_amsl_m" | "polygons">} bridge
 * @param {{ frame: Frame, ground: Pick<Ground, "heightAt"> }} world
 */
export function bridgeSolid(bridge, { frame, ground }) {
  /** @type {SurfaceParts} */
  const solid = { vertices: [], index: [] };
  const deck = bridge.deck_amsl_m - frame.origin.altitude_amsl_m + 0.15;
  for (const rings of bridge.polygons) {
    const flat = rings.map((ring) => ring.map(([lon, lat]) => frame.toLocal(lon, lat, 0)).map(([x, , z]) => [x, z]));
    const { points, triangles } = triangulate(flat);
    addFace(solid, points, triangles, deck, -1);
    addFace(solid, points, triangles, deck - SLAB_M, 1);
    for (const ring of flat) addSides(solid, ring, deck - SLAB_M, deck);
    for (const wall of supportsOf(flat[0])) {
      const foot = Math.min(...wall.map(([x, z]) => ground.heightAt(x, z)));
      if (deck - SLAB_M - foot > MIN_ROOM_M) addSides(solid, wall, foot - 1, deck - SLAB_M);
    }
  }
  return { vertices: Float32Array.from(solid.vertices), index: Uint32Array.from(solid.index) };
}

/**
 * @param {SurfaceParts} solid
 * @param {Ring} points
 * @param {readonly number[]} triangles
 * @param {number} y
 * @param {1 | -1} turn
 */
function addFace({ vertices, index }, points, triangles, y, turn) {
  const first = vertices.length / 3;
  for (const [x, z] of points) vertices.push(x, y, z);
  for (let at = 0; at < triangles.length; at += 3) {
    const [a, b, c] = [triangles[at], triangles[at + 1], triangles[at + 2]].map((place) => first + place);
    index.push(a, ...(turn > 0 ? [b, c] : [c, b]));
  }
}

/** @param {SurfaceParts} solid @param {Ring} ring @param {number} low @param {number} high */
function addSides({ vertices, index }, ring, low, high) {
  for (let at = 0; at < ring.length - 1; at += 1) {
    const first = vertices.length / 3;
    for (const [x, z] of [ring[at], ring[at + 1]]) vertices.push(x, low, z, x, high, z);
    index.push(first, first + 1, first + 2, first + 1, first + 3, first + 2);
  }
}

/**
 * Abutments at both ends and piers between them, evenly along the longest line through the outline: rings of four corners, closed.
 *
 * @param {Ring} ring
 */
function supportsOf(ring) {
  const [x0, z0] = [0, 1].map((axis) => ring.reduce((sum, point) => sum + point[axis], 0) / ring.length);
  let [xx, xz, zz] = [0, 0, 0];
  for (const [x, z] of ring) [xx, xz, zz] = [xx + (x - x0) ** 2, xz + (x - x0) * (z - z0), zz + (z - z0) ** 2];
  const angle = Math.atan2(2 * xz, xx - zz) / 2;
  const [along_x, along_z] = [Math.cos(angle), Math.sin(angle)];
  const reach = ring.map(([x, z]) => (x - x0) * along_x + (z - z0) * along_z);
  const [from, to] = [Math.min(...reach) + INSET_M, Math.max(...reach) - INSET_M];
  if (to - from < 4 * INSET_M) return [];
  const fields = Math.max(Math.round((to - from) / PIER_EVERY_M), 1);
  /** @type {Ring[]} */
  const walls = [];
  for (let field = 0; field <= fields; field += 1) {
    const along = from + ((to - from) * field) / fields;
    const across = widthAt(ring, [x0, z0], [along_x, along_z], along);
    if (across === null) continue;
    const isEnd = field === 0 || field === fields;
    const [middle, half] = [(across[0] + across[1]) / 2, (across[1] - across[0]) / 2 - (isEnd ? 0.3 : 0)];
    const wide = isEnd ? half : Math.min(half * 0.55, 6);
    const corners = [
      [-1, -1],
      [1, -1],
      [1, 1],
      [-1, 1],
      [-1, -1],
    ];
    walls.push(
      corners.map(([u, v]) => {
        const [far, side] = [along + (u * PIER_M) / 2, middle + v * wide];
        return [x0 + far * along_x - side * along_z, z0 + far * along_z + side * along_x];
      }),
    );
  }
  return walls;
}

/**
 * Between the outermost crossings of the outline with the line across at `along`; null where it does not cross.
 *
 * @param {Ring} ring
 * @param {number[]} middle
 * @param {number[]} way its direction
 * @param {number} along
 */
function widthAt(ring, [x0, z0], [along_x, along_z], along) {
  /** @type {number[]} */
  const crossings = [];
  for (let at = 0; at < ring.length - 1; at += 1) {
    const [here, there] = [ring[at], ring[at + 1]].map(([x, z]) => [
      (x - x0) * along_x + (z - z0) * along_z - along,
      (z - z0) * along_x - (x - x0) * along_z,
    ]);
    if (here[0] * there[0] < 0) crossings.push(here[1] + ((there[1] - here[1]) * -here[0]) / (there[0] - here[0]));
  }
  return crossings.length ? [Math.min(...crossings), Math.max(...crossings)] : null;
}
