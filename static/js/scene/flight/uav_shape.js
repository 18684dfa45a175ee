/** A multirotor made of boxes, tubes and balls: metres, its nose to the north (−z), its middle at 0. */

import {
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  Color,
  CylinderGeometry,
  Matrix4,
  SphereGeometry,
} from "../three.js";

/** @import { Vector } from "../types.d.ts" */

/** @typedef {{ geometry: BufferGeometry, color: string }} ColouredPart color: sRGB hex */

export const SPAN_M = 1.05; // from rotor tip to rotor tip
export const ROTOR_M = 0.19; // radius
/** @type {Vector[]} */
export const ROTORS = [
  [-0.27, -0.25],
  [0.27, -0.25],
  [-0.27, 0.27],
  [0.27, 0.27],
].map(([x, z]) => [x, 0.085, z]);
/** A rotor turns against its neighbours. */
export const TURNS = [1, -1, -1, 1];

const TINTED = "#ffffff"; // takes the colour of its route
const DARK = "#2b3033";
const LENS = "#0c1216";
const NOSE = "#f4f2ec";

/** @param {BufferGeometry} geometry @param {Vector} place @param {Matrix4 | null} [turn] */
const moved = (geometry, [x, y, z], turn = null) =>
  geometry.applyMatrix4(turn ?? new Matrix4()).applyMatrix4(new Matrix4().makeTranslation(x, y, z));

/** One geometry of several, each in its own colour: drawn at once. @param {readonly ColouredPart[]} parts */
export function merged(parts) {
  const plain = parts.map(({ geometry }) => (geometry.index ? geometry.toNonIndexed() : geometry));
  const count = plain.reduce((sum, { attributes }) => sum + attributes.position.count, 0);
  const [position, normal, color] = [0, 0, 0].map(() => new Float32Array(count * 3));
  let at = 0;
  plain.forEach((geometry, index) => {
    const { r, g, b } = new Color(parts[index].color);
    position.set(geometry.attributes.position.array, at * 3);
    normal.set(geometry.attributes.normal.array, at * 3);
    for (let vertex = 0; vertex < geometry.attributes.position.count; vertex += 1)
      color.set([r, g, b], (at + vertex) * 3);
    at += geometry.attributes.position.count;
    geometry.dispose();
    parts[index].geometry.dispose();
  });
  const whole = new BufferGeometry();
  whole.setAttribute("position", new BufferAttribute(position, 3));
  whole.setAttribute("normal", new BufferAttribute(normal, 3));
  whole.setAttribute("color", new BufferAttribute(color, 3));
  return whole;
}

/** Body, arms, motors, legs, the camera under the nose, and a light stripe that marks the front. */
export function bodyShape() {
  const arms = ROTORS.flatMap(([x, , z]) => {
    const length = Math.hypot(x, z);
    const turn = new Matrix4().makeRotationY(Math.atan2(x, z)).multiply(new Matrix4().makeRotationX(Math.PI / 2));
    return [
      { geometry: moved(new CylinderGeometry(0.017, 0.022, length, 6), [x / 2, 0.03, z / 2], turn), color: DARK },
      { geometry: moved(new CylinderGeometry(0.034, 0.03, 0.07, 10), [x, 0.05, z]), color: DARK },
    ];
  });
  const legs = [-0.13, 0.13].flatMap((x) => [
    {
      geometry: moved(
        new CylinderGeometry(0.008, 0.008, 0.4, 6),
        [x, -0.12, 0.01],
        new Matrix4().makeRotationX(Math.PI / 2),
      ),
      color: DARK,
    },
    ...[-0.1, 0.12].map((z) => ({
      geometry: moved(new CylinderGeometry(0.008, 0.008, 0.11, 6), [x * 0.9, -0.07, z]),
      color: DARK,
    })),
  ]);
  return merged([
    {
      geometry: moved(new SphereGeometry(0.5, 20, 12), [0, 0.01, 0], new Matrix4().makeScale(0.26, 0.13, 0.4)),
      color: TINTED,
    },
    { geometry: moved(new BoxGeometry(0.12, 0.045, 0.2), [0, 0.075, 0.03]), color: TINTED },
    { geometry: moved(new BoxGeometry(0.07, 0.022, 0.05), [0, 0.045, -0.172]), color: NOSE },
    { geometry: moved(new SphereGeometry(0.048, 12, 8), [0, -0.075, -0.14]), color: DARK },
    {
      geometry: moved(
        new CylinderGeometry(0.022, 0.026, 0.03, 10),
        [0, -0.075, -0.19],
        new Matrix4().makeRotationX(Math.PI / 2),
      ),
      color: LENS,
    },
    ...arms,
    ...legs,
  ]);
}

/** Two blades, and the disc that they are in flight: alpha in the colours. */
export function rotorShape() {
  const blades = merged([
    { geometry: moved(new BoxGeometry(ROTOR_M * 1.96, 0.006, 0.024), [0, 0.012, 0]), color: DARK },
    { geometry: moved(new CylinderGeometry(0.014, 0.014, 0.024, 8), [0, 0.012, 0]), color: DARK },
  ]);
  const disc = merged([
    { geometry: moved(new CylinderGeometry(ROTOR_M, ROTOR_M, 0.002, 28), [0, 0.012, 0]), color: DARK },
  ]);
  const [solid, sheer] = [blades, disc].map(({ attributes }) => attributes);
  const count = solid.position.count + sheer.position.count;
  const whole = new BufferGeometry();
  for (const name of /** @type {const} */ (["position", "normal"])) {
    const values = new Float32Array(count * 3);
    values.set(solid[name].array);
    values.set(sheer[name].array, solid.position.count * 3);
    whole.setAttribute(name, new BufferAttribute(values, 3));
  }
  const color = new Float32Array(count * 4);
  for (let vertex = 0; vertex < count; vertex += 1) {
    const own = vertex < solid.position.count ? solid : sheer;
    const from = (own === solid ? vertex : vertex - solid.position.count) * 3;
    color.set([...own.color.array.slice(from, from + 3), own === solid ? 0.85 : 0.2], vertex * 4);
  }
  whole.setAttribute("color", new BufferAttribute(color, 4));
  blades.dispose();
  disc.dispose();
  return whole;
}
