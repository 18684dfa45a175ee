/** The sky: one colour above, fading into the ground's at the horizon. No picture. */

import { BackSide, Color, Mesh, ShaderMaterial, SphereGeometry } from "../three.js";

/** @import { Mood } from "./lighting.js" */

const VERTEX = /* glsl */ `
  varying float vUp;
  void main() {
    vUp = normalize(position).y;
    vec4 place = projectionMatrix * vec4(mat3(modelViewMatrix) * position, 1.0);
    gl_Position = place.xyww;
  }`;
const FRAGMENT = /* glsl */ `
  uniform vec3 sky;
  uniform vec3 horizon;
  uniform vec3 glow;
  varying float vUp;
  void main() {
    vec3 low = mix(horizon, glow, smoothstep(-0.01, 0.06, vUp));
    gl_FragColor = vec4(mix(low, sky, smoothstep(0.0, 0.6, vUp)), 1.0);
    #include <colorspace_fragment>
    float grain = fract(sin(dot(gl_FragCoord.xy, vec2(12.9898, 78.233))) * 43758.5453);
    gl_FragColor.rgb += (grain - 0.5) / 255.0; // no bands
  }`;

export function makeSky() {
  const uniforms = { sky: { value: new Color() }, horizon: { value: new Color() }, glow: { value: new Color() } };
  const material = new ShaderMaterial({
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    uniforms,
    side: BackSide,
    depthWrite: false,
    depthTest: false,
    fog: false,
  });
  const mesh = new Mesh(new SphereGeometry(1, 24, 32), material);
  mesh.frustumCulled = false;
  mesh.renderOrder = -10;
  return {
    mesh,
    /** @param {Pick<Mood, "sky" | "horizon" | "glow">} mood */
    apply(mood) {
      uniforms.sky.value.copy(mood.sky);
      uniforms.horizon.value.copy(mood.horizon);
      uniforms.glow.value.copy(mood.glow);
    },
    dispose() {
      mesh.geometry.dispose();
      material.dispose();
    },
  };
}
