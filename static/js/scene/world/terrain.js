/** The ground: one surface in the token's colour with a graticule, and contour lines where it is not flat. */

import { groundMesh } from "../geometry/ground.js";
import { BufferAttribute, BufferGeometry, Color, Mesh, MeshLambertMaterial } from "../three.js";

/** @import { Ground } from "../geometry/ground.js" */
/** @import { Frame } from "../types.d.ts" */

const RELIEF = 2.2;
const PARS = /* glsl */ `
  uniform vec3 lineColour;
  uniform vec3 contourColour;
  uniform vec3 origin; // of the graticule and the contours
  uniform float contour_m;
  varying vec3 vPlace;
  float drawn(float value, float width) {
    float wide = fwidth(value);
    float line = abs(fract(value - 0.5) - 0.5) / max(wide, 1e-6);
    return clamp(width * 0.5 + 0.5 - line, 0.0, 1.0) * (1.0 - smoothstep(0.1, 0.4, wide));
  }`;
const LINES = /* glsl */ `
  {
    vec2 way = (vPlace.xz - origin.xz) / 100.0;
    float fine = max(drawn(way.x, 1.0), drawn(way.y, 1.0));
    float coarse = max(drawn(way.x / 10.0, 1.6), drawn(way.y / 10.0, 1.6));
    diffuseColor.rgb = mix(diffuseColor.rgb, lineColour, max(fine * 0.45, coarse));
    if (contour_m > 0.0) {
      float up = (vPlace.y - origin.y) / contour_m;
      diffuseColor.rgb = mix(diffuseColor.rgb, contourColour, max(drawn(up, 1.0) * 0.6, drawn(up / 5.0, 1.6)));
    }
  }`;

export function makeTerrain() {
  const material = new MeshLambertMaterial();
  const uniforms = {
    lineColour: { value: new Color() },
    contourColour: { value: new Color() },
    origin: { value: { x: 0, y: 0, z: 0 } },
    contour_m: { value: 0 },
  };
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, uniforms);
    shader.vertexShader = shader.vertexShader
      .replace("#include <common>", "#include <common>\nvarying vec3 vPlace;")
      .replace("#include <begin_vertex>", "#include <begin_vertex>\nvPlace = position;");
    shader.fragmentShader = shader.fragmentShader
      .replace("#include <common>", `#include <common>\n${PARS}`)
      .replace("#include <color_fragment>", `#include <color_fragment>\n${LINES}`);
  };
  const mesh = new Mesh(new BufferGeometry(), material);
  mesh.receiveShadow = true;
  mesh.frustumCulled = false;
  return {
    mesh,
    /** @param {Ground} ground @param {Frame} frame */
    show(ground, frame) {
      mesh.geometry.dispose();
      const { vertices, normals, index } = groundMesh(ground);
      mesh.geometry = new BufferGeometry();
      mesh.geometry.setAttribute("position", new BufferAttribute(vertices, 3));
      mesh.geometry.setAttribute("normal", new BufferAttribute(steeper(normals), 3));
      mesh.geometry.setIndex(new BufferAttribute(index, 1));
      const heights = ground.heights;
      const range_m =
        heights.reduce((most, height) => Math.max(most, height), -Infinity) -
        heights.reduce((least, height) => Math.min(least, height), Infinity);
      uniforms.contour_m.value = range_m < 2 ? 0 : range_m < 60 ? 5 : range_m < 250 ? 10 : range_m < 800 ? 20 : 50;
      uniforms.origin.value = { x: 0, y: -frame.origin.altitude_amsl_m, z: 0 };
    },
    /** @param {{ ground: Color, graticule: Color, contour: Color }} colours */
    apply({ ground, graticule, contour }) {
      material.color.copy(ground);
      uniforms.lineColour.value.copy(graticule);
      uniforms.contourColour.value.copy(contour);
    },
    dispose() {
      mesh.geometry.dispose();
      material.dispose();
    },
  };
}

/**
 * Slopes are lit as if they were steeper, so that gentle hills show; the surface stays as it is.
 *
 * @param {Float32Array} normals
 */
function steeper(normals) {
  const lit = new Float32Array(normals.length);
  for (let at = 0; at < normals.length; at += 3) {
    const [x, y, z] = [normals[at] * RELIEF, normals[at + 1], normals[at + 2] * RELIEF];
    const length = Math.hypot(x, y, z) || 1;
    lit.set([x / length, y / length, z / length], at);
  }
  return lit;
}
