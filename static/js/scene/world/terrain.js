/** The ground: one surface in the token's colour with a graticule, and contour lines where it is not flat. */

import { BufferAttribute, BufferGeometry, Color, Mesh, MeshLambertMaterial } from "../three.js";
import { groundMesh } from "../geometry/ground.js";

const PARS = /* glsl */ `
  uniform vec3 lineColour;
  uniform vec3 origin; // of the graticule and the contours
  uniform float contour_m;
  varying vec3 vPlace;
  float drawn(float value, float width) {
    float wide = fwidth(value);
    float line = abs(fract(value - 0.5) - 0.5) / max(wide, 1e-6);
    return clamp(width * 0.5 + 0.5 - line, 0.0, 1.0) * (1.0 - smoothstep(0.2, 0.6, wide));
  }`;
const LINES = /* glsl */ `
  {
    vec2 way = (vPlace.xz - origin.xz) / 100.0;
    float fine = max(drawn(way.x, 1.0), drawn(way.y, 1.0));
    float coarse = max(drawn(way.x / 10.0, 1.6), drawn(way.y / 10.0, 1.6));
    float shown = max(fine * 0.45, coarse);
    if (contour_m > 0.0) {
      float up = (vPlace.y - origin.y) / contour_m;
      shown = max(shown * 0.7, max(drawn(up, 1.0) * 0.55, drawn(up / 5.0, 1.5) * 1.0));
    }
    diffuseColor.rgb = mix(diffuseColor.rgb, lineColour, shown);
  }`;

/** Gives { mesh, show(ground), apply(palette), dispose() }. */
export function makeTerrain() {
  const material = new MeshLambertMaterial();
  const uniforms = { lineColour: { value: new Color() }, origin: { value: { x: 0, y: 0, z: 0 } }, contour_m: { value: 0 } };
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
    show(ground, frame) {
      mesh.geometry.dispose();
      const { vertices, normals, index } = groundMesh(ground);
      mesh.geometry = new BufferGeometry();
      mesh.geometry.setAttribute("position", new BufferAttribute(vertices, 3));
      mesh.geometry.setAttribute("normal", new BufferAttribute(normals, 3));
      mesh.geometry.setIndex(new BufferAttribute(index, 1));
      const heights = ground.heights;
      const range_m = heights.reduce((most, height) => Math.max(most, height), -Infinity) - heights.reduce((least, height) => Math.min(least, height), Infinity);
      uniforms.contour_m.value = range_m < 2 ? 0 : range_m < 60 ? 5 : range_m < 250 ? 10 : range_m < 800 ? 20 : 50;
      uniforms.origin.value = { x: 0, y: -frame.origin.altitude_amsl_m, z: 0 };
    },
    apply(palette) {
      material.color.set(palette.ground);
      uniforms.lineColour.value.set(palette.graticule);
    },
    dispose() {
      mesh.geometry.dispose();
      material.dispose();
    },
  };
}
