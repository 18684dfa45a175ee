/** The ground as a grid of triangles in the frame: its height anywhere, and its mesh. Values in, arrays out. */

/** @import { GroundGrid } from "../../api_types.d.ts" */
/** @import { Frame } from "../types.d.ts" */

/** @typedef {ReturnType<typeof makeGround>} Ground */

const SKIRT_M = 100_000; // the terrain continues so far beyond the grid, at the mean height of its edge

/**
 * heights: y, row by row from the north-west; edge: mean y of the edge; heightAt is exact on the mesh's triangles. See docs/scene.md.
 *
 * @param {Omit<GroundGrid, "kind">} ground
 * @param {Frame} frame
 */
export function makeGround(ground, frame) {
  const { columns, rows } = ground;
  const [west, , north] = frame.toLocal(ground.west_deg, ground.north_deg, 0);
  const stepX = ground.step_lon_deg * frame.metresPerDegree[0];
  const stepZ = ground.step_lat_deg * frame.metresPerDegree[1];
  const heights = Float32Array.from(ground.altitude_amsl_m, (altitude) => altitude - frame.origin.altitude_amsl_m);
  const edge = meanOfEdge(heights, columns, rows);

  /** @param {number} x @param {number} z */
  function heightAt(x, z) {
    const [u, v] = [(x - west) / stepX, (z - north) / stepZ];
    const [inU, inV] = [clamp(u, 0, columns - 1), clamp(v, 0, rows - 1)];
    const [column, row] = [Math.min(Math.floor(inU), columns - 2), Math.min(Math.floor(inV), rows - 2)];
    const [east, south] = [inU - column, inV - row];
    const at = row * columns + column;
    const [northWest, northEast, southWest, southEast] = [
      heights[at],
      heights[at + 1],
      heights[at + columns],
      heights[at + columns + 1],
    ];
    const inside =
      south > east
        ? northWest + south * (southWest - northWest) + east * (southEast - southWest)
        : northWest + east * (northEast - northWest) + south * (southEast - northEast);
    const away = Math.max(Math.abs(u - inU) * stepX, Math.abs(v - inV) * stepZ) / SKIRT_M;
    return away > 0 ? inside + (edge - inside) * Math.min(away, 1) : inside;
  }
  return { columns, rows, west, north, stepX, stepZ, heights, edge, heightAt };
}

/** { vertices, normals, index }: the grid, and around it the skirt. @param {Ground} ground */
export function groundMesh(ground) {
  const { columns, rows, west, north, stepX, stepZ, heights, edge } = ground;
  const inner = columns * rows;
  const ring = edgePlaces(columns, rows);
  const vertices = new Float32Array((inner + ring.length) * 3);
  /** @type {number[]} */
  const index = [];
  for (let row = 0; row < rows; row += 1) {
    for (let column = 0; column < columns; column += 1) {
      const place = row * columns + column;
      vertices.set([west + column * stepX, heights[place], north + row * stepZ], place * 3);
      if (row < rows - 1 && column < columns - 1) {
        const south = place + columns;
        index.push(place, south, south + 1, place, south + 1, place + 1);
      }
    }
  }
  ring.forEach(([column, row], number) => {
    const out_x = column === 0 ? -1 : column === columns - 1 ? 1 : 0;
    const out_z = row === 0 ? -1 : row === rows - 1 ? 1 : 0;
    vertices.set(
      [west + column * stepX + out_x * SKIRT_M, edge, north + row * stepZ + out_z * SKIRT_M],
      (inner + number) * 3,
    );
    const next = (number + 1) % ring.length;
    const [here, there] = [row * columns + column, ring[next][1] * columns + ring[next][0]];
    index.push(here, there, inner + next, here, inner + next, inner + number);
  });
  return { vertices, normals: normalsOf(vertices, index), index: Uint32Array.from(index) };
}

/**
 * Places of the grid's edge as [column, row], against the clock seen from above: west side down, south side, east side up, north side.
 *
 * @param {number} columns
 * @param {number} rows
 */
function edgePlaces(columns, rows) {
  /** @type {[column: number, row: number][]} */
  const places = [];
  for (let row = 0; row < rows - 1; row += 1) places.push([0, row]);
  for (let column = 0; column < columns - 1; column += 1) places.push([column, rows - 1]);
  for (let row = rows - 1; row > 0; row -= 1) places.push([columns - 1, row]);
  for (let column = columns - 1; column > 0; column -= 1) places.push([column, 0]);
  return places.reverse();
}

/** @param {Float32Array} heights @param {number} columns @param {number} rows */
function meanOfEdge(heights, columns, rows) {
  const places = edgePlaces(columns, rows);
  return places.reduce((sum, [column, row]) => sum + heights[row * columns + column], 0) / places.length;
}

/**
 * Normal of each vertex, weighted by the area of its triangles.
 *
 * @param {Float32Array} vertices
 * @param {readonly number[]} index
 */
export function normalsOf(vertices, index) {
  const normals = new Float32Array(vertices.length);
  for (let at = 0; at < index.length; at += 3) {
    const [a, b, c] = [index[at] * 3, index[at + 1] * 3, index[at + 2] * 3];
    const [ux, uy, uz] = [
      vertices[b] - vertices[a],
      vertices[b + 1] - vertices[a + 1],
      vertices[b + 2] - vertices[a + 2],
    ];
    const [vx, vy, vz] = [
      vertices[c] - vertices[a],
      vertices[c + 1] - vertices[a + 1],
      vertices[c + 2] - vertices[a + 2],
    ];
    const normal = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
    for (const corner of [a, b, c]) for (let axis = 0; axis < 3; axis += 1) normals[corner + axis] += normal[axis];
  }
  for (let at = 0; at < normals.length; at += 3) {
    const length = Math.hypot(normals[at], normals[at + 1], normals[at + 2]) || 1;
    for (let axis = 0; axis < 3; axis += 1) normals[at + axis] /= length;
  }
  return normals;
}

/** @param {number} value @param {number} low @param {number} high */
function clamp(value, low, high) {
  return Math.min(Math.max(value, low), high);
}
