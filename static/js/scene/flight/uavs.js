/** UAVs of a moment: measured ones solid, estimated ones hollow in the ellipsoid that they are in, lost ones grey; rotors, camera cones. */

import { RADIANS } from "../cameras/vectors.js";
import { ESTIMATED, LOST, MEASURED, PLANNED } from "../sources/pieces.js";
import {
  AdditiveBlending,
  Color,
  ConeGeometry,
  DoubleSide,
  Euler,
  Group,
  InstancedMesh,
  Matrix4,
  MeshBasicMaterial,
  MeshStandardMaterial,
  NormalBlending,
  Quaternion,
  ShaderMaterial,
  SphereGeometry,
  Vector3,
} from "../three.js";
import { bodyShape, ROTORS, rotorShape, SPAN_M, TURNS } from "./uav_shape.js";

/** @import { BufferGeometry, Material } from "../three.js" */
/** @import { Bound, DrawnUav, SampleKind, ScenePalette } from "../types.d.ts" */
/** @import { MetresPerPixel } from "./marks.js" */

/** @typedef {ReturnType<typeof createUavs>} Uavs */

const MIN_PX = 40; // across: drawn larger from far away
const CONE_M = 14;
const GLOW = 0.4;
const MAX_CONE = 1.6; // factor of that, from far away
const CONE_HALF_DEG = 22; // half the width that an inspection camera sees
const LIT_DARK = "#66727a"; // what shines of it where all else is dark
const ROTOR_LIGHT = 5; // times its own colour, there
const GHOST_LIGHT = 0.4; // towards white, there
const MIN_BOUND_M = 1.5;
const MIN_BOUND_PX = 14; // radius

const RIM_VERTEX = `
  varying vec3 vNormal; varying vec3 vView; varying vec3 vTint;
  void main() {
    mat4 whole = modelViewMatrix * instanceMatrix;
    vec4 seen = whole * vec4(position, 1.0);
    vec3 scale2 = vec3(dot(instanceMatrix[0].xyz, instanceMatrix[0].xyz), dot(instanceMatrix[1].xyz, instanceMatrix[1].xyz), dot(instanceMatrix[2].xyz, instanceMatrix[2].xyz));
    vNormal = normalize((whole * vec4(normal / scale2, 0.0)).xyz);
    vView = normalize(-seen.xyz);
    vTint = instanceColor;
    gl_Position = projectionMatrix * seen;
  }`;
const RIM_FRAGMENT = `
  uniform float inner; uniform float rim;
  varying vec3 vNormal; varying vec3 vView; varying vec3 vTint;
  void main() {
    float edge = 1.0 - abs(dot(normalize(vNormal), normalize(vView)));
    gl_FragColor = vec4(vTint, inner + (rim - inner) * smoothstep(0.35, 0.95, edge));
    #include <colorspace_fragment>
  }`;

/** A transparent material with a clear edge, for hollow UAVs. @param {number} inner @param {number} rim */
const hollow = (inner, rim) =>
  new ShaderMaterial({
    vertexShader: RIM_VERTEX,
    fragmentShader: RIM_FRAGMENT,
    uniforms: { inner: { value: inner }, rim: { value: rim } },
    transparent: true,
    depthWrite: false,
    side: DoubleSide,
  });

/** Add some emission of its own colour, so that it is never as dark as the night. @param {MeshStandardMaterial} material */
function litFromWithin(material) {
  material.onBeforeCompile = (shader) => {
    shader.fragmentShader = shader.fragmentShader.replace(
      "#include <emissivemap_fragment>",
      `#include <emissivemap_fragment>\n  totalEmissiveRadiance += diffuseColor.rgb * ${GLOW.toFixed(2)};`,
    );
  };
  return material;
}

const WHITE = new Color(1, 1, 1);
const BRIGHT = new Color(ROTOR_LIGHT, ROTOR_LIGHT, ROTOR_LIGHT);

/** @param {SampleKind} kind */
export const isSolid = (kind) => kind === MEASURED;

/**
 * @template {Material} Look
 * @param {BufferGeometry} geometry
 * @param {Look} material
 * @param {number} count at most
 */
function many(geometry, material, count) {
  const mesh = new InstancedMesh(geometry, material, count);
  mesh.frustumCulled = false; // few, and everywhere
  mesh.count = 0;
  mesh.setColorAt(0, new Color(1, 1, 1)); // makes room for colours
  return mesh;
}

/** All meshes of UAVs. @param {number} count of UAVs at most */
function meshesOf(count) {
  const body = bodyShape();
  const cone = new ConeGeometry(Math.tan(CONE_HALF_DEG * RADIANS) * CONE_M, CONE_M, 4, 1, true)
    .rotateY(Math.PI / 4)
    .translate(0, -CONE_M / 2, 0); // its top at 0, opening downwards
  const solidLook = new MeshStandardMaterial({ vertexColors: true, roughness: 0.55, metalness: 0.05 });
  const sheer = { transparent: true, depthWrite: false, side: DoubleSide };
  const meshes = {
    solid: many(body, litFromWithin(solidLook), count),
    ghosts: many(body, hollow(0.1, 0.95), count),
    rotors: many(rotorShape(), new MeshBasicMaterial({ vertexColors: true, ...sheer }), count * 4),
    cones: many(cone, new MeshBasicMaterial({ opacity: 0.1, blending: AdditiveBlending, ...sheer }), count),
    bounds: many(new SphereGeometry(1, 32, 16), hollow(0.09, 0.6), count),
  };
  meshes.solid.castShadow = true;
  meshes.ghosts.renderOrder = 4;
  meshes.bounds.renderOrder = 3;
  meshes.cones.renderOrder = 5;
  return meshes;
}

/** @param {number} count of UAVs at most */
export function createUavs(count) {
  const group = new Group();
  const meshes = meshesOf(count);
  const all = Object.values(meshes);
  group.add(...all);
  const [turn, tilt, at, size, matrix] = [new Quaternion(), new Euler(), new Vector3(), new Vector3(), new Matrix4()];
  const [rotor, own, colour, aim] = [new Matrix4(), new Matrix4(), new Color(), new Vector3()];
  const down = new Vector3(0, -1, 0);
  let spin = 0; // radians

  /** Draws one more at `matrix`. @param {InstancedMesh} mesh @param {Color | string} tint */
  function put(mesh, tint) {
    mesh.setMatrixAt(mesh.count, matrix);
    mesh.setColorAt(mesh.count, colour.set(tint));
    mesh.count += 1;
  }

  /**
   * The body, hollow where it is not measured, and its rotors.
   *
   * @param {DrawnUav} uav
   * @param {number} scale
   * @param {ScenePalette} palette
   * @param {boolean} isDark
   */
  function putBody(uav, scale, palette, isDark) {
    const { kind } = uav.moment;
    matrix.compose(at, turn.setFromEuler(tilt), size.setScalar(scale));
    const tint = kind === LOST ? palette.inkSecond : uav.colour;
    if (isSolid(kind)) put(meshes.solid, tint);
    else put(meshes.ghosts, isDark ? colour.set(tint).lerp(WHITE, GHOST_LIGHT) : tint);
    if (kind === LOST) return;
    own.copy(matrix);
    ROTORS.forEach((place, index) => {
      rotor.makeTranslation(place[0], place[1], place[2]);
      matrix
        .makeRotationY(uav.isInAir ? spin * TURNS[index] + index : index)
        .premultiply(rotor)
        .premultiply(own);
      put(meshes.rotors, isDark ? BRIGHT : WHITE);
    });
  }

  /** What its camera sees. @param {DrawnUav} uav @param {number} scale */
  function putCone(uav, scale) {
    turn.setFromUnitVectors(down, aim.set(...uav.camera));
    matrix.compose(at, turn, size.setScalar(Math.min(scale, MAX_CONE)));
    put(meshes.cones, uav.colour);
  }

  /** The ellipsoid that an estimated one is in. @param {DrawnUav} uav @param {Bound} bound @param {number} least_m */
  function putBound(uav, { bearing_deg, across_m, along_m, height_m }, least_m) {
    turn.setFromEuler(tilt.set(0, -bearing_deg * RADIANS, 0));
    const [across, along] = [Math.max(across_m, least_m), Math.max(along_m, least_m)];
    matrix.compose(at, turn, size.set(across, Math.max(height_m ?? 0, least_m * 0.5), along));
    put(meshes.bounds, uav.colour);
  }

  return {
    group,
    /**
     * @param {readonly DrawnUav[]} drawn
     * @param {object} how
     * @param {ScenePalette} how.palette
     * @param {MetresPerPixel} how.metresPerPixel
     * @param {boolean} [how.isDark] by theme or night
     * @param {number} [how.dt_s] how far rotors turn
     * @param {number | null} [how.hidden] the one whose camera is used
     */
    show(drawn, { palette, metresPerPixel, isDark = palette.isDark, dt_s = 0, hidden = null }) {
      spin += dt_s * 23; // seen turning, not as fast as they do
      meshes.solid.material.emissive.set(isDark ? LIT_DARK : "#000000");
      meshes.cones.material.opacity = isDark ? 0.06 : 0.1;
      meshes.cones.material.blending = isDark ? AdditiveBlending : NormalBlending;
      for (const mesh of all) mesh.count = 0;
      for (const uav of drawn) {
        if (uav.route === hidden) continue;
        const { kind, bound } = uav.moment;
        const per_px = metresPerPixel(uav.place);
        const scale = Math.max(1, (MIN_PX * per_px) / SPAN_M);
        tilt.set(uav.pitch_deg * RADIANS, -uav.heading_deg * RADIANS, -uav.roll_deg * RADIANS, "YXZ");
        at.set(uav.place[0], uav.place[1] + 0.06 * (scale - 1), uav.place[2]);
        putBody(uav, scale, palette, isDark);
        if (uav.isInAir && (kind === MEASURED || kind === PLANNED)) putCone(uav, scale);
        if (kind === ESTIMATED && bound) putBound(uav, bound, Math.max(MIN_BOUND_M, MIN_BOUND_PX * per_px));
      }
      for (const mesh of all) {
        mesh.visible = mesh.count > 0;
        mesh.instanceMatrix.needsUpdate = true;
        if (mesh.instanceColor) mesh.instanceColor.needsUpdate = true;
      }
    },
    dispose() {
      for (const mesh of all) {
        mesh.geometry.dispose();
        mesh.material.dispose();
        mesh.dispose();
      }
    },
  };
}
