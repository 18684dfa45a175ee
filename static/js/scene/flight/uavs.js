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

const LEAST_PX = 40; // across: from far away it is drawn larger than it is
const CONE_M = 14;
const GLOW = 0.4;
const MOST_CONE = 1.6; // times that, from far away
const CONE_HALF_DEG = 22; // half of what an inspection camera sees across
const LIT_DARK = "#66727a"; // what shines of it where all else is dark
const ROTOR_LIGHT = 5; // times its own colour, there
const GHOST_LIGHT = 0.4; // towards white, there
const LEAST_BOUND_M = 1.5;
const LEAST_BOUND_PX = 14; // radius

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

/** See-through with a clear edge: what is hollow. */
const hollow = (inner, rim) =>
  new ShaderMaterial({
    vertexShader: RIM_VERTEX,
    fragmentShader: RIM_FRAGMENT,
    uniforms: { inner: { value: inner }, rim: { value: rim } },
    transparent: true,
    depthWrite: false,
    side: DoubleSide,
  });

/** It is never as dark as the night: some of its own colour shines. */
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

export const isSolid = (kind) => kind === MEASURED;

/** count: of UAVs at most. */
export function createUavs(count) {
  const group = new Group();
  const many = (geometry, material, number = count) => {
    const mesh = new InstancedMesh(geometry, material, number);
    mesh.frustumCulled = false; // few, and everywhere
    mesh.count = 0;
    mesh.setColorAt(0, new Color(1, 1, 1)); // makes room for colours
    group.add(mesh);
    return mesh;
  };
  const body = bodyShape();
  const solid = many(
    body,
    litFromWithin(new MeshStandardMaterial({ vertexColors: true, roughness: 0.55, metalness: 0.05 })),
  );
  solid.castShadow = true;
  const ghosts = many(body, hollow(0.1, 0.95));
  const rotors = many(
    rotorShape(),
    new MeshBasicMaterial({ vertexColors: true, transparent: true, depthWrite: false, side: DoubleSide }),
    count * 4,
  );
  const cone = new ConeGeometry(Math.tan(CONE_HALF_DEG * RADIANS) * CONE_M, CONE_M, 4, 1, true)
    .rotateY(Math.PI / 4)
    .translate(0, -CONE_M / 2, 0); // its top at 0, opening downwards
  const cones = many(
    cone,
    new MeshBasicMaterial({
      transparent: true,
      opacity: 0.1,
      depthWrite: false,
      side: DoubleSide,
      blending: AdditiveBlending,
    }),
  );
  const bounds = many(new SphereGeometry(1, 32, 16), hollow(0.09, 0.6));
  ghosts.renderOrder = 4;
  bounds.renderOrder = 3;
  cones.renderOrder = 5;

  const [turn, tilt, at, size, matrix] = [new Quaternion(), new Euler(), new Vector3(), new Vector3(), new Matrix4()];
  const [rotor, own, down, colour, aim] = [
    new Matrix4(),
    new Matrix4(),
    new Vector3(0, -1, 0),
    new Color(),
    new Vector3(),
  ];
  let spin = 0; // radians

  function put(mesh, number, tint) {
    mesh.setMatrixAt(number, matrix);
    mesh.setColorAt(number, tint.isColor ? tint : colour.set(tint));
  }

  return {
    group,
    /** drawn: moments of drawn_flight.js with { colour, isChosen }; palette; metresPerPixel(place); dt_s: how far rotors turn. isDark: by theme or night. hidden: the one whose camera looks. */
    show(drawn, { palette, metresPerPixel, isDark = palette.isDark, dt_s = 0, hidden = null }) {
      spin += dt_s * 23; // seen turning, not as fast as they do
      const numbers = { solid: 0, ghosts: 0, rotors: 0, cones: 0, bounds: 0 };
      solid.material.emissive.set(isDark ? LIT_DARK : "#000000");
      cones.material.opacity = isDark ? 0.06 : 0.1;
      cones.material.blending = isDark ? AdditiveBlending : NormalBlending;
      for (const uav of drawn) {
        if (uav.route === hidden) continue;
        const { kind, bound } = uav.moment;
        const per_px = metresPerPixel(uav.place);
        const scale = Math.max(1, (LEAST_PX * per_px) / SPAN_M);
        tilt.set(uav.pitch_deg * RADIANS, -uav.heading_deg * RADIANS, -uav.roll_deg * RADIANS, "YXZ");
        at.set(uav.place[0], uav.place[1] + 0.06 * (scale - 1), uav.place[2]);
        matrix.compose(at, turn.setFromEuler(tilt), size.setScalar(scale));
        const tint = kind === LOST ? palette.inkSecond : uav.colour;
        if (isSolid(kind)) put(solid, numbers.solid++, tint);
        else put(ghosts, numbers.ghosts++, isDark ? colour.set(tint).lerp(WHITE, GHOST_LIGHT) : tint);
        if (kind !== LOST) {
          own.copy(matrix);
          ROTORS.forEach((place, index) => {
            rotor.makeTranslation(place[0], place[1], place[2]);
            matrix
              .makeRotationY(uav.isInAir ? spin * TURNS[index] + index : index)
              .premultiply(rotor)
              .premultiply(own);
            put(rotors, numbers.rotors++, isDark ? BRIGHT : WHITE);
          });
        }
        if (uav.isInAir && (kind === MEASURED || kind === PLANNED)) {
          turn.setFromUnitVectors(down, aim.set(...uav.camera));
          matrix.compose(at, turn, size.setScalar(Math.min(scale, MOST_CONE)));
          put(cones, numbers.cones++, uav.colour);
        }
        if (kind === ESTIMATED && bound) {
          const least = Math.max(LEAST_BOUND_M, LEAST_BOUND_PX * per_px);
          turn.setFromEuler(tilt.set(0, -bound.bearing_deg * RADIANS, 0));
          matrix.compose(
            at,
            turn,
            size.set(
              Math.max(bound.across_m, least),
              Math.max(bound.height_m ?? 0, least * 0.5),
              Math.max(bound.along_m, least),
            ),
          );
          put(bounds, numbers.bounds++, uav.colour);
        }
      }
      for (const [name, mesh] of Object.entries({ solid, ghosts, rotors, cones, bounds })) {
        mesh.count = numbers[name];
        mesh.visible = numbers[name] > 0;
        mesh.instanceMatrix.needsUpdate = true;
        mesh.instanceColor.needsUpdate = true;
      }
    },
    dispose() {
      for (const mesh of [solid, ghosts, rotors, cones, bounds]) {
        mesh.geometry.dispose();
        mesh.material.dispose();
        mesh.dispose();
      }
    },
  };
}
