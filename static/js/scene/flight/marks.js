/** Lines and arrows round the UAVs of a moment: the pole to the ground, the path since the last report, the wind. */

import { between, towards } from "../cameras/vectors.js";
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  Vector3,
} from "../three.js";

/** @import { DrawnUav, ScenePalette, Vector, Wind } from "../types.d.ts" */

/** @typedef {ReturnType<typeof createMarks>} Marks */
/** @typedef {(place: Vector) => number} MetresPerPixel */

const WIND_ABOVE_M = 0.4; // the arrow's height over the UAV
const WIND_BESIDE_M = 0.9; // of its tip from the UAV: it points at the UAV from where the wind comes
const WIND_AT_NIGHT = "#d3dfe8";
const FULL_WIND_MPS = 12; // an arrow of full length
const DASHES = 24;

/** A flat arrow towards the north, 1 m long, its middle at 0. */
function arrowShape() {
  const outline = [
    [-0.05, 0.5],
    [0.05, 0.5],
    [0.05, -0.1],
    [-0.05, -0.1],
  ];
  const head = [
    [-0.17, -0.1],
    [0.17, -0.1],
    [0, -0.5],
  ];
  const corners = [outline[0], outline[1], outline[2], outline[0], outline[2], outline[3], ...head];
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(corners.flatMap(([x, z]) => [x, 0, z])), 3));
  return geometry;
}

/** @param {number} count of UAVs at most */
export function createMarks(count) {
  const group = new Group();
  const position = new BufferAttribute(new Float32Array(count * (DASHES + 1) * 6), 3);
  const colours = new BufferAttribute(new Float32Array(count * (DASHES + 1) * 6), 3);
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", position);
  geometry.setAttribute("color", colours);
  const lines = new LineSegments(
    geometry,
    new LineBasicMaterial({ vertexColors: true, transparent: true, opacity: 0.85 }),
  );
  lines.frustumCulled = false;
  const arrow = new Mesh(arrowShape(), new MeshBasicMaterial({ side: DoubleSide, transparent: true, opacity: 0.9 }));
  arrow.visible = false;
  arrow.renderOrder = 6;
  group.add(lines, arrow);
  const colour = new Color();
  let used = 0;

  /** @param {Vector} from @param {Vector} to @param {Color} colour */
  function segment(from, to, { r, g, b }) {
    for (const end of [from, to]) {
      position.setXYZ(used, ...end);
      colours.setXYZ(used, r, g, b);
      used += 1;
    }
  }

  return {
    group,
    /**
     * @param {readonly DrawnUav[]} drawn
     * @param {object} how
     * @param {Wind | null} how.wind at the chosen one
     * @param {number | null} how.chosen
     * @param {ScenePalette} how.palette
     * @param {MetresPerPixel} how.metresPerPixel
     * @param {boolean} [how.isNight]
     */
    show(drawn, { wind, chosen, palette, metresPerPixel, isNight = false }) {
      used = 0;
      for (const { place, ground, colour: hex, report } of drawn) {
        colour.set(hex);
        if (place[1] - ground > 0.5) segment(place, [place[0], ground, place[2]], colour);
        if (report) {
          for (let dash = 0; dash < DASHES; dash += 2) {
            segment(between(report, place, dash / DASHES), between(report, place, (dash + 1) / DASHES), colour);
          }
        }
      }
      geometry.setDrawRange(0, used);
      position.needsUpdate = true;
      colours.needsUpdate = true;
      lines.visible = used > 0;
      const uav = drawn.find(({ route }) => route === chosen);
      arrow.visible = false;
      if (!uav || !wind || wind.speed_mps <= 0.2) return;
      arrow.visible = true;
      const scale = Math.max(1, 40 * metresPerPixel(uav.place));
      const long_m = scale * (0.5 + 1.5 * Math.min(1, wind.speed_mps / FULL_WIND_MPS));
      const from = new Vector3(...towards(wind.from_deg));
      arrow.position
        .set(uav.place[0], uav.place[1] + WIND_ABOVE_M * scale, uav.place[2])
        .addScaledVector(from, WIND_BESIDE_M * scale + long_m / 2);
      arrow.lookAt(from.add(arrow.position)); // its tail, at +z, is where the wind comes from
      arrow.scale.setScalar(long_m);
      arrow.material.color.set(isNight ? WIND_AT_NIGHT : palette.inkSecond);
    },
    dispose() {
      geometry.dispose();
      lines.material.dispose();
      arrow.geometry.dispose();
      arrow.material.dispose();
    },
  };
}
