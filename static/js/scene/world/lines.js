/** Lines of a width in pixels, or in metres where that is more: wires, rails, edges of zones; one draw call for all of a kind. */

import {
  BufferAttribute,
  DoubleSide,
  DynamicDrawUsage,
  InstancedBufferAttribute,
  InstancedBufferGeometry,
  Mesh,
  ShaderMaterial,
  StaticDrawUsage,
  UniformsLib,
  UniformsUtils,
  Vector4,
} from "../three.js";

const VERTEX = /* glsl */ `
  attribute vec3 start;
  attribute vec3 end;
  attribute vec4 tint; // red, green, blue, dash in metres or 0
  attribute vec2 size; // pixels, metres
  uniform vec4 viewport;
  uniform float pixelRatio;
  uniform vec2 fade;
  varying vec3 vTint;
  varying float vAlpha;
  varying float vAcross;
  varying float vAlong;
  varying float vDash;
  varying float vHalf;
  #include <fog_pars_vertex>
  void main() {
    vec4 a = modelViewMatrix * vec4(start, 1.0);
    vec4 b = modelViewMatrix * vec4(end, 1.0);
    float near = -1.01 * projectionMatrix[3][2] / (projectionMatrix[2][2] - 1.0); // the camera's: what is cut there leaves nothing to be clipped
    if (a.z > near && b.z < near) a = mix(a, b, (a.z - near) / (a.z - b.z));
    else if (b.z > near && a.z < near) b = mix(b, a, (b.z - near) / (b.z - a.z));
    vec4 ca = projectionMatrix * a;
    vec4 cb = projectionMatrix * b;
    vec2 pa = ca.xy / ca.w * viewport.zw * 0.5;
    vec2 pb = cb.xy / cb.w * viewport.zw * 0.5;
    vec2 way = pb - pa;
    float way_px = length(way);
    vec2 side = way_px > 1e-4 ? vec2(-way.y, way.x) / way_px : vec2(0.0, 1.0);
    float share = position.y;
    vec4 own = share < 0.5 ? ca : cb;
    vec4 mvPosition = share < 0.5 ? a : b;
    float far = length(mvPosition.xyz);
    float wide = max(size.x * pixelRatio, size.y * projectionMatrix[1][1] * viewport.w * 0.5 / max(own.w, 0.05));
    vAlpha = mix(1.0, fade.y, smoothstep(fade.x * 0.1, fade.x, far));
    vTint = tint.rgb;
    vDash = tint.a;
    vAlong = share * distance(start, end);
    vHalf = wide * 0.5;
    vAcross = position.x * (vHalf + 0.75);
    own.xy += side * vAcross / (viewport.zw * 0.5) * own.w;
    gl_Position = own;
    #include <fog_vertex>
  }`;
const FRAGMENT = /* glsl */ `
  varying vec3 vTint;
  varying float vAlpha;
  varying float vAcross;
  varying float vAlong;
  varying float vDash;
  varying float vHalf;
  #include <common>
  #include <fog_pars_fragment>
  void main() {
    if (vDash > 0.0 && mod(vAlong, vDash * 1.8) > vDash) discard;
    float cover = clamp(vHalf + 0.5 - abs(vAcross), 0.0, 1.0) * min(vHalf * 2.0, 1.0);
    if (cover < 0.01) discard;
    gl_FragColor = vec4(vTint, cover * vAlpha);
    #include <colorspace_fragment>
    #include <fog_fragment>
  }`;

const CORNERS = new Float32Array([-1, 0, 0, 1, 0, 0, -1, 1, 0, 1, 1, 0]);

/**
 * Lines of 6 figures (ends), 4 (colour in the working space, dash) and 2 (pixels, metres) for each segment.
 *
 * @param {{ fade?: [from_m: number, share: number], order?: number }} [how] fade: from where on lines are faint, and how faint
 */
export function screenLines({ fade = [6_000, 0.4], order = 2 } = {}) {
  const material = new ShaderMaterial({
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    uniforms: UniformsUtils.merge([
      UniformsLib.fog,
      { viewport: { value: new Vector4(0, 0, 1, 1) }, pixelRatio: { value: 1 }, fade: { value: fade } },
    ]),
    transparent: true,
    side: DoubleSide,
    depthWrite: false,
    fog: true,
  });
  const mesh = new Mesh(empty(), material);
  mesh.frustumCulled = false;
  mesh.renderOrder = order;
  mesh.onBeforeRender = (renderer) => {
    renderer.getCurrentViewport(material.uniforms.viewport.value);
    material.uniforms.pixelRatio.value = renderer.getPixelRatio();
    material.uniformsNeedUpdate = true;
  };
  return {
    mesh,
    /** Set the factor of the usual distance at which lines become faint; at least 1. @param {number} times */
    reach(times) {
      material.uniforms.fade.value = [fade[0] * Math.max(times, 1), fade[1]];
    },
    /** @param {Float32Array} segments @param {Float32Array} tints @param {Float32Array} sizes */
    set(segments, tints, sizes) {
      mesh.geometry.dispose();
      const geometry = empty();
      const count = segments.length / 6;
      const ends = interleavedEnds(segments);
      geometry.setAttribute("start", new InstancedBufferAttribute(ends.start, 3));
      geometry.setAttribute("end", new InstancedBufferAttribute(ends.end, 3));
      geometry.setAttribute("tint", new InstancedBufferAttribute(tints, 4).setUsage(DynamicDrawUsage));
      geometry.setAttribute("size", new InstancedBufferAttribute(sizes, 2).setUsage(StaticDrawUsage));
      geometry.instanceCount = count;
      mesh.geometry = geometry;
      mesh.visible = count > 0;
    },
    /** @param {Float32Array} tints */
    recolour(tints) {
      const attribute = mesh.geometry.getAttribute("tint");
      if (!attribute) return;
      attribute.array.set(tints);
      attribute.needsUpdate = true;
    },
    dispose() {
      mesh.geometry.dispose();
      material.dispose();
    },
  };
}

function empty() {
  const geometry = new InstancedBufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(CORNERS, 3));
  geometry.setIndex([0, 1, 2, 1, 3, 2]);
  geometry.instanceCount = 0;
  return geometry;
}

/** @param {Float32Array} segments */
function interleavedEnds(segments) {
  const count = segments.length / 6;
  const [start, end] = [new Float32Array(count * 3), new Float32Array(count * 3)];
  for (let segment = 0; segment < count; segment += 1) {
    start.set(segments.subarray(segment * 6, segment * 6 + 3), segment * 3);
    end.set(segments.subarray(segment * 6 + 3, segment * 6 + 6), segment * 3);
  }
  return { start, end };
}
