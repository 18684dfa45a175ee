/** The picture: renderer, camera and a loop that draws only when something is another than before. */

import { Color, PCFShadowMap, PerspectiveCamera, Scene, Vector3, WebGLRenderer } from "./three.js";

const SLOW_MS = 45; // a frame that takes longer, many times over, is drawn with fewer pixels
const SLOW_FRAMES = 12;
const MOST_PIXELS = 2; // of the device a CSS pixel
const LEAST_PIXELS = 0.75;
const LONGEST_STEP_S = 0.25; // after a pause nothing jumps
const NEAR_SHARE = 0.25; // of the room round the camera: nothing is nearer than that
const [LEAST_NEAR_M, LOW_NEAR_M, MOST_NEAR_M] = [0.15, 2, 500];
const LOW_M = 80; // with less room bridges and the like may stand beside it
const FAR_M = 200_000;

export class NoWebGL extends Error {}

function rendererOn(canvas) {
  let context = null;
  try {
    context = canvas.getContext("webgl2", {
      antialias: true,
      alpha: false,
      powerPreference: "high-performance",
      stencil: false,
    });
  } catch {
    /* as without it */
  }
  if (!context) throw new NoWebGL();
  try {
    return new WebGLRenderer({ canvas, context });
  } catch (error) {
    throw new NoWebGL(error.message);
  }
}

/**
 * container: an element of a size of its own; the canvas fills it. draw({ dt_s, now_ms }) before each picture: moves what moves and returns
 * whether the next picture is wanted at once. onLost(), onFound(): the graphics context. Throws NoWebGL.
 */
export function createView(container, canvas, { draw, onLost = () => {}, onFound = () => {} }) {
  const renderer = rendererOn(canvas);
  renderer.shadowMap.enabled = true;
  renderer.shadowMap.type = PCFShadowMap;
  renderer.info.autoReset = false;
  const scene = new Scene();
  scene.background = new Color();
  const camera = new PerspectiveCamera(50, 1, 0.5, FAR_M);
  let pixels = Math.min(globalThis.devicePixelRatio || 1, MOST_PIXELS);
  let [wanted, last_ms, slow, isOver] = [0, 0, 0, false];
  const size = { width: 1, height: 1 };
  const figures = { frames: 0, script_ms: 0, longest_ms: 0 };
  const seen = new Vector3();

  function frame(now_ms) {
    wanted = 0;
    if (isOver || renderer.getContext().isContextLost()) return;
    const began = performance.now();
    const dt_s = Math.min(LONGEST_STEP_S, last_ms ? (now_ms - last_ms) / 1_000 : 0);
    const goesOn = draw({ dt_s, now_ms });
    renderer.info.reset();
    renderer.render(scene, camera);
    const took_ms = performance.now() - began;
    figures.frames += 1;
    figures.script_ms += took_ms;
    figures.longest_ms = Math.max(figures.longest_ms, took_ms);
    if (goesOn && last_ms) keepPace(now_ms - last_ms);
    last_ms = goesOn ? now_ms : 0;
    if (goesOn) request();
  }

  function keepPace(between_ms) {
    slow = between_ms > SLOW_MS ? slow + 1 : 0;
    if (slow < SLOW_FRAMES || pixels <= LEAST_PIXELS) return;
    slow = 0;
    pixels = Math.max(LEAST_PIXELS, pixels * 0.75);
    fit();
  }

  function request() {
    if (!wanted && !isOver) wanted = requestAnimationFrame(frame);
  }

  function fit() {
    size.width = Math.max(1, container.clientWidth);
    size.height = Math.max(1, container.clientHeight);
    renderer.setPixelRatio(pixels);
    renderer.setSize(size.width, size.height, false);
    camera.aspect = size.width / size.height;
    request();
  }

  const watching = new ResizeObserver(fit);
  watching.observe(container);
  const lost = (event) => (event.preventDefault(), onLost());
  const found = () => (onFound(), request());
  canvas.addEventListener("webglcontextlost", lost);
  canvas.addEventListener("webglcontextrestored", found);
  fit();

  return {
    kind: "3d",
    scene,
    camera,
    size,
    request,
    setBackground: (colour) => scene.background.set(colour),
    /** pose: of the rig; room_m: how near the nearest thing is. The near plane goes as far out as that allows, so that depths stay apart. */
    aim({ eye, look, up, field_deg }, room_m) {
      camera.position.set(...eye);
      camera.up.set(...up);
      camera.lookAt(...look);
      camera.fov = size.width < size.height ? Math.min(75, field_deg * 1.25) : field_deg;
      camera.near = Math.min(room_m < LOW_M ? LOW_NEAR_M : MOST_NEAR_M, Math.max(LEAST_NEAR_M, room_m * NEAR_SHARE));
      camera.updateProjectionMatrix();
      camera.updateMatrixWorld();
    },
    /** Where a place stands on the screen: { x, y, away_m } in CSS pixels; null behind the camera. */
    project(place) {
      seen.set(...place);
      const away_m = seen.distanceTo(camera.position);
      seen.applyMatrix4(camera.matrixWorldInverse);
      if (seen.z > -camera.near) return null;
      seen.applyMatrix4(camera.projectionMatrix);
      return { x: ((seen.x + 1) / 2) * size.width, y: ((1 - seen.y) / 2) * size.height, away_m };
    },
    metresPerPixel(place) {
      const away_m = camera.position.distanceTo(seen.set(...place));
      return (2 * away_m * Math.tan((camera.fov * Math.PI) / 360)) / size.height;
    },
    /** Device pixels, as shaders count. */
    viewport: () => [size.width * pixels, size.height * pixels],
    /** The picture as it stands now, on a canvas of its own. */
    copy() {
      draw({ dt_s: 0, now_ms: performance.now() });
      renderer.info.reset();
      renderer.render(scene, camera);
      const picture = document.createElement("canvas");
      [picture.width, picture.height] = [canvas.width, canvas.height];
      picture.getContext("2d").drawImage(canvas, 0, 0); // in the same task as the drawing: the buffer is still there
      return { picture, scale: canvas.width / size.width };
    },
    /** For measurements: draw calls and what the graphics hold, frames and their script since the last asking. */
    figures() {
      const { render, memory } = renderer.info;
      const told = {
        calls: render.calls,
        triangles: render.triangles,
        geometries: memory.geometries,
        textures: memory.textures,
        programs: renderer.info.programs?.length ?? 0,
        ...figures,
      };
      Object.assign(figures, { frames: 0, script_ms: 0, longest_ms: 0 });
      return told;
    },
    dispose() {
      isOver = true;
      cancelAnimationFrame(wanted);
      watching.disconnect();
      canvas.removeEventListener("webglcontextlost", lost);
      canvas.removeEventListener("webglcontextrestored", found);
      renderer.dispose();
      renderer.forceContextLoss();
    },
  };
}
