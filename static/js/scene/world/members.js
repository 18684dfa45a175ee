/** Members of supports: one draw call for the outlines of all, one for the bracing of those near by. */

import { memberMatrices } from "../geometry/struts.js";
import {
  Color,
  CylinderGeometry,
  DynamicDrawUsage,
  InstancedMesh,
  MeshDepthMaterial,
  MeshLambertMaterial,
  PerspectiveCamera,
  Vector2,
} from "../three.js";

/** @import { Members } from "../types.d.ts" */

const MIN_PX = 0.9; // minimum width of an outline on the screen
const MIN_SHADOW_PX = 2.4; // minimum width of its shadow in the shadow map
const SIZE = new Vector2();

/** fog and light as every Lambert surface; far members are made as wide as a pixel. @param {number} leastPx */
function memberMaterial(leastPx) {
  const material = new MeshLambertMaterial();
  const uniforms = { leastPx: { value: leastPx }, tanPerPx: { value: 0.001 } };
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, uniforms);
    shader.vertexShader = shader.vertexShader
      .replace("#include <common>", "#include <common>\nuniform float leastPx;\nuniform float tanPerPx;")
      .replace(
        "#include <begin_vertex>",
        `#include <begin_vertex>
        {
          float wide = length(instanceMatrix[0].xyz);
          vec4 place = modelViewMatrix * (instanceMatrix * vec4(0.0, position.y, 0.0, 1.0));
          transformed.xz *= max(1.0, leastPx * tanPerPx * max(-place.z, 0.0) / wide);
        }`,
      );
  };
  return { material, uniforms };
}

/** What shadows are made of. @param {{ value: number }} leastShadow */
function shadowMaterial(leastShadow) {
  const material = new MeshDepthMaterial();
  material.onBeforeCompile = (shader) => {
    shader.uniforms.leastShadow = leastShadow;
    shader.vertexShader = shader.vertexShader
      .replace("#include <common>", "#include <common>\nuniform float leastShadow;")
      .replace(
        "#include <begin_vertex>",
        "#include <begin_vertex>\ntransformed.xz *= max(1.0, leastShadow / length(instanceMatrix[0].xyz));",
      );
  };
  return material;
}

/**
 * Colours are Float32Arrays of 3 for each member, in the working space.
 *
 * @param {{ leastPx?: number, castShadow?: boolean }} [how]
 */
export function memberMesh({ leastPx = MIN_PX, castShadow = true } = {}) {
  const prism = new CylinderGeometry(0.5, 0.5, 1, 4, 1, true);
  const { material, uniforms } = memberMaterial(leastPx);
  const leastShadow = { value: 0.2 };
  const depth = shadowMaterial(leastShadow);
  const holder = { mesh: new InstancedMesh(prism, material, 1) };

  /** @param {number} capacity */
  function reserve(capacity) {
    if (capacity <= holder.mesh.instanceMatrix.count) return;
    const next = new InstancedMesh(prism, material, capacity);
    next.instanceMatrix.setUsage(DynamicDrawUsage);
    next.setColorAt(0, new Color());
    const { parent } = holder.mesh;
    if (parent) parent.add(next);
    holder.mesh.removeFromParent();
    holder.mesh.dispose();
    holder.mesh = next;
    dress(next);
  }
  /** @param {InstancedMesh} own */
  function dress(own) {
    own.frustumCulled = false;
    own.castShadow = castShadow;
    own.customDepthMaterial = depth;
    own.onBeforeRender = (renderer, _scene, camera) => {
      const height = renderer.getDrawingBufferSize(SIZE).y;
      uniforms.tanPerPx.value =
        (2 *
          Math.tan(((camera instanceof PerspectiveCamera ? camera.fov : 50) * Math.PI) / 360) *
          renderer.getPixelRatio()) /
        Math.max(height, 1);
    };
  }
  /** @param {Float32Array} colours */
  function recolour(colours) {
    const { instanceColor } = holder.mesh;
    if (!instanceColor) return;
    instanceColor.array.set(colours);
    instanceColor.needsUpdate = true;
  }
  holder.mesh.setColorAt(0, new Color());
  holder.mesh.count = 0;
  dress(holder.mesh);
  return {
    get mesh() {
      return holder.mesh;
    },
    /** How wide a pixel of the shadow map is. @param {number} metres */
    shadowPixel(metres) {
      leastShadow.value = MIN_SHADOW_PX * metres;
    },
    /** @param {Members} members @param {Float32Array} colours */
    set(members, colours) {
      const count = members.width_m.length;
      reserve(Math.max(Math.ceil(count * 1.25), 64));
      const { mesh } = holder;
      memberMatrices(members, /** @type {Float32Array} */ (mesh.instanceMatrix.array));
      mesh.count = count;
      mesh.visible = count > 0;
      mesh.instanceMatrix.needsUpdate = true;
      recolour(colours);
    },
    recolour,
    dispose() {
      holder.mesh.dispose();
      prism.dispose();
      material.dispose();
      depth.dispose();
    },
  };
}
