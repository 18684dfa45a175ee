/** Bridges and the beds of railways: merged surfaces, one draw call each. */

import { BufferAttribute, BufferGeometry, Color, DoubleSide, Mesh, MeshLambertMaterial } from "../three.js";

/** @import { Surface } from "../types.d.ts" */

/** Many pieces as one. @param {readonly Surface[]} pieces */
export function merged(pieces) {
  /** @param {"vertices" | "uv" | "index"} of */
  const count = (of) => pieces.reduce((sum, piece) => sum + (piece[of]?.length ?? 0), 0);
  const [vertices, uv, index] = [
    new Float32Array(count("vertices")),
    new Float32Array(count("uv")),
    new Uint32Array(count("index")),
  ];
  let [vertex, atUv, atIndex] = [0, 0, 0];
  for (const piece of pieces) {
    vertices.set(piece.vertices, vertex);
    if (piece.uv) uv.set(piece.uv, atUv);
    for (let at = 0; at < piece.index.length; at += 1) index[atIndex + at] = piece.index[at] + vertex / 3;
    vertex += piece.vertices.length;
    atUv += piece.uv?.length ?? 0;
    atIndex += piece.index.length;
  }
  return { vertices, uv, index };
}

/** Create a geometry of arrays; faces are flat unless normals are given. @param {Surface} surface */
export function geometryOf({ vertices, uv, index }) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(vertices, 3));
  if (uv?.length) geometry.setAttribute("uv", new BufferAttribute(uv, 2));
  geometry.setIndex(new BufferAttribute(index, 1));
  return geometry;
}

export function makeBridges() {
  const material = new MeshLambertMaterial({ flatShading: true, side: DoubleSide });
  const mesh = new Mesh(new BufferGeometry(), material);
  mesh.castShadow = true;
  mesh.receiveShadow = true;
  return solid(mesh, material);
}

const SLEEPERS = /* glsl */ `
  {
    float way = vUv.y / 1.3;
    float wide = fwidth(way);
    float tie = smoothstep(0.5 - wide, 0.5 + wide, abs(fract(way) - 0.5) * 2.0) * (1.0 - smoothstep(0.25, 0.7, wide)) + 0.5 * smoothstep(0.25, 0.7, wide);
    float inside = step(0.18, vUv.x) * step(vUv.x, 0.82); // dams have -1 to 0 and 1 to 2
    diffuseColor.rgb = mix(diffuseColor.rgb, tieColour, tie * inside);
    if (vUv.x < 0.0 || vUv.x > 1.0) diffuseColor.rgb = damColour;
  }`;

/** The beds, with sleepers across, and their dams; `ties` and `dams` are their colours. */
export function makeBeds() {
  const material = new MeshLambertMaterial({
    side: DoubleSide,
    polygonOffset: true,
    polygonOffsetFactor: -2,
    polygonOffsetUnits: -4,
  });
  const uniforms = { tieColour: { value: new Color() }, damColour: { value: new Color() } };
  material.defines = { USE_UV: "" };
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, uniforms);
    shader.fragmentShader = shader.fragmentShader
      .replace("#include <common>", "#include <common>\nuniform vec3 tieColour;\nuniform vec3 damColour;")
      .replace("#include <color_fragment>", `#include <color_fragment>\n${SLEEPERS}`);
  };
  const mesh = new Mesh(new BufferGeometry(), material);
  mesh.receiveShadow = true;
  return { ...solid(mesh, material), ties: uniforms.tieColour.value, dams: uniforms.damColour.value };
}

/** @param {Mesh<BufferGeometry, MeshLambertMaterial>} mesh @param {MeshLambertMaterial} material */
function solid(mesh, material) {
  mesh.visible = false;
  return {
    mesh,
    /** @param {readonly Surface[]} pieces */
    show(pieces) {
      mesh.geometry.dispose();
      mesh.geometry = geometryOf(merged(pieces));
      mesh.geometry.computeVertexNormals();
      mesh.visible = pieces.length > 0;
    },
    /** @param {Color} colour */
    apply(colour) {
      material.color.copy(colour);
    },
    dispose() {
      mesh.geometry.dispose();
      material.dispose();
    },
  };
}
