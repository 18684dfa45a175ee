/** Zones as translucent volumes: walls with hatching, faint floors and ceilings; their edges are lines of world.js. */

import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  Mesh,
  ShaderMaterial,
  UniformsLib,
  UniformsUtils,
} from "../three.js";
import { merged } from "./solids.js";

/** @import { ZoneVolume } from "../geometry/zones.js" */
/** @import { ScenePalette } from "../types.d.ts" */

/** @typedef {ZoneVolume & { isInForce: boolean }} ShownVolume */

const VERTEX = /* glsl */ `
  attribute vec2 uv2;
  attribute vec2 look; // how strong, hatching
  varying vec2 vWall;
  varying vec2 vLook;
  #include <fog_pars_vertex>
  void main() {
    vWall = uv2;
    vLook = look;
    vec4 mvPosition = modelViewMatrix * vec4(position, 1.0);
    gl_Position = projectionMatrix * mvPosition;
    #include <fog_vertex>
  }`;
const FRAGMENT = /* glsl */ `
  uniform vec3 colour;
  uniform float strength;
  varying vec2 vWall;
  varying vec2 vLook;
  #include <common>
  #include <fog_pars_fragment>
  void main() {
    float way = (vWall.x + vWall.y) / 14.0;
    float wide = fwidth(way);
    float line = clamp(0.9 - abs(fract(way) - 0.5) / max(wide, 1e-5), 0.0, 1.0) * (1.0 - smoothstep(0.15, 0.5, wide));
    gl_FragColor = vec4(colour, clamp(strength * vLook.x + 0.34 * line * vLook.y * vLook.x * (gl_FrontFacing ? 1.0 : 0.0), 0.0, 1.0));
    #include <colorspace_fragment>
    #include <fog_fragment>
  }`;

export function makeZones() {
  const uniforms = UniformsUtils.merge([
    UniformsLib.fog,
    { colour: { value: new Color() }, strength: { value: 0.12 } },
  ]);
  const material = new ShaderMaterial({
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    uniforms,
    transparent: true,
    depthWrite: false,
    side: DoubleSide,
    fog: true,
    polygonOffset: true,
    polygonOffsetFactor: -1,
    polygonOffsetUnits: -2,
  }); // a floor lies close over the ground
  const mesh = new Mesh(new BufferGeometry(), material);
  mesh.renderOrder = 3;
  mesh.frustumCulled = false;
  mesh.visible = false;
  return {
    mesh,
    /** @param {readonly ShownVolume[]} volumes */
    show(volumes) {
      mesh.geometry.dispose();
      mesh.geometry = new BufferGeometry();
      const pieces = volumes.flatMap(({ walls, caps }) => [
        walls,
        { ...caps, uv: new Float32Array((caps.vertices.length / 3) * 2) },
      ]);
      const { vertices, uv, index } = merged(pieces);
      mesh.geometry.setAttribute("position", new BufferAttribute(vertices, 3));
      mesh.geometry.setAttribute("uv2", new BufferAttribute(uv, 2));
      mesh.geometry.setAttribute("look", new BufferAttribute(looks(volumes), 2));
      mesh.geometry.setIndex(new BufferAttribute(index, 1));
      mesh.visible = index.length > 0;
    },
    /** @param {Pick<ScenePalette, "zone" | "isDark">} palette */
    apply(palette) {
      uniforms.colour.value.set(palette.zone);
      uniforms.strength.value = palette.isDark ? 0.13 : 0.1;
    },
    dispose() {
      mesh.geometry.dispose();
      material.dispose();
    },
  };
}

/**
 * A zone that is not in force has no hatching and half the colour; walls up to no limit fade out.
 *
 * @param {readonly ShownVolume[]} volumes
 */
function looks(volumes) {
  /** @type {number[]} */
  const values = [];
  for (const { walls, caps, isInForce } of volumes) {
    const strength = isInForce ? 1 : 0.5;
    for (let at = 0; at < walls.fade.length; at += 1) values.push(strength * walls.fade[at], isInForce ? 1 : 0);
    for (let at = 0; at < caps.vertices.length / 3; at += 1) values.push(strength * 0.8, 0);
  }
  return Float32Array.from(values);
}
