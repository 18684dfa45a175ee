/** The picture: renderer, camera and a loop that draws only changes. */

import { Color, PCFShadowMap, PerspectiveCamera, Scene, Vector3, WebGLRenderer } from "../three.js";
import { frameLoop } from "./frame_loop.js";

/** @import { Pose } from "../cameras/rig.js" */
/** @import { LoopTime } from "./frame_loop.js" */
/** @import { FrameTime, Projected, Size, Vector } from "../types.d.ts" */

const SLOW_MS = 45; // after many slower frames in a row the picture has fewer pixels
const SLOW_FRAMES = 12;
const MAX_PIXELS = 2; // device pixels for a CSS pixel
const MIN_PIXELS = 0.75;
const NEAR_SHARE = 0.25; // share of the free distance round the camera at which the near plane is
const [MIN_NEAR_M, LOW_NEAR_M, MAX_NEAR_M] = [0.15, 2, 500];
const LOW_M = 80; // with less free distance, bridges and similar may be beside it
const FAR_M = 200_000;

export class NoWebGL extends Error {}

/** @param {HTMLCanvasElement} canvas */
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
    throw new NoWebGL(error instanceof Error ? error.message : "");
  }
}

/** Create the figures of drawn frames since the last reading: count, total and longest time of scripts. */
function createFigures() {
  const figures = { frames: 0, script_ms: 0, longest_ms: 0 };
  return {
    /** @param {number} took_ms */
    note(took_ms) {
      figures.frames += 1;
      figures.script_ms += took_ms;
      figures.longest_ms = Math.max(figures.longest_ms, took_ms);
    },
    /** With draw calls and what the graphics hold. @param {WebGLRenderer} renderer */
    take({ info: { render, memory, programs } }) {
      const taken = {
        calls: render.calls,
        triangles: render.triangles,
        geometries: memory.geometries,
        textures: memory.textures,
        programs: programs?.length ?? 0,
        ...figures,
      };
      Object.assign(figures, { frames: 0, script_ms: 0, longest_ms: 0 });
      return taken;
    },
  };
}

/**
 * A canvas with the same picture; in the same task as the drawing, the buffer is still there.
 *
 * @param {HTMLCanvasElement} canvas
 */
function copyOf(canvas) {
  const copied = document.createElement("canvas");
  [copied.width, copied.height] = [canvas.width, canvas.height];
  copied.getContext("2d")?.drawImage(canvas, 0, 0);
  return copied;
}

/**
 * Watches the graphics context; returns what ends it.
 *
 * @param {HTMLCanvasElement} canvas
 * @param {() => void} onLost
 * @param {() => void} onFound
 */
function watchContext(canvas, onLost, onFound) {
  /** @param {Event} event */
  const lost = (event) => {
    event.preventDefault();
    onLost();
  };
  canvas.addEventListener("webglcontextlost", lost);
  canvas.addEventListener("webglcontextrestored", onFound);
  return () => {
    canvas.removeEventListener("webglcontextlost", lost);
    canvas.removeEventListener("webglcontextrestored", onFound);
  };
}

/**
 * Create the camera for the rig's pose, with the projection to the screen.
 *
 * @param {PerspectiveCamera} camera
 * @param {Size} size of the picture
 */
function createAim(camera, size) {
  const seen = new Vector3();
  return {
    /**
     * Move the near plane as far out as the free distance allows, for depth precision.
     *
     * @param {Pose} pose
     * @param {number} room_m distance to the nearest thing
     */
    aim({ eye, look, up, field_deg }, room_m) {
      camera.position.set(...eye);
      camera.up.set(...up);
      camera.lookAt(...look);
      camera.fov = size.width < size.height ? Math.min(75, field_deg * 1.25) : field_deg;
      camera.near = Math.min(room_m < LOW_M ? LOW_NEAR_M : MAX_NEAR_M, Math.max(MIN_NEAR_M, room_m * NEAR_SHARE));
      camera.updateProjectionMatrix();
      camera.updateMatrixWorld();
    },
    /** Place on the screen; null behind the camera. @param {Vector} place @returns {Projected | null} */
    project(place) {
      seen.set(...place);
      const away_m = seen.distanceTo(camera.position);
      seen.applyMatrix4(camera.matrixWorldInverse);
      if (seen.z > -camera.near) return null;
      seen.applyMatrix4(camera.projectionMatrix);
      return { x: ((seen.x + 1) / 2) * size.width, y: ((1 - seen.y) / 2) * size.height, away_m };
    },
    /** @param {Vector} place */
    metresPerPixel(place) {
      const away_m = camera.position.distanceTo(seen.set(...place));
      return (2 * away_m * Math.tan((camera.fov * Math.PI) / 360)) / size.height;
    },
  };
}

/**
 * The canvas fills its container, which has a size of its own.
 *
 * @param {HTMLElement} container
 * @param {HTMLCanvasElement} canvas
 * @param {object} acts
 * @param {(time: FrameTime) => boolean} acts.draw before each picture: moves what moves and returns whether the next one is wanted at once
 * @param {() => void} [acts.onLost] the graphics context
 * @param {() => void} [acts.onFound]
 * @throws {NoWebGL}
 */
export function createView(container, canvas, { draw, onLost = () => {}, onFound = () => {} }) {
  const renderer = rendererOn(canvas);
  renderer.shadowMap.enabled = true;
  renderer.shadowMap.type = PCFShadowMap;
  renderer.info.autoReset = false;
  const scene = new Scene();
  const background = new Color();
  scene.background = background;
  const camera = new PerspectiveCamera(50, 1, 0.5, FAR_M);
  const size = { width: 1, height: 1 };
  const figures = createFigures();
  let pixels = Math.min(globalThis.devicePixelRatio || 1, MAX_PIXELS);
  let slow = 0;

  function render() {
    renderer.info.reset();
    renderer.render(scene, camera);
  }

  const loop = frameLoop((time) => {
    if (renderer.getContext().isContextLost()) return false;
    const began = performance.now();
    const goesOn = draw(time);
    render();
    figures.note(performance.now() - began);
    if (goesOn && time.between_ms) keepPace(time);
    return goesOn;
  });

  /** @param {LoopTime} time */
  function keepPace({ between_ms }) {
    slow = between_ms > SLOW_MS ? slow + 1 : 0;
    if (slow < SLOW_FRAMES || pixels <= MIN_PIXELS) return;
    slow = 0;
    pixels = Math.max(MIN_PIXELS, pixels * 0.75);
    fit();
  }

  function fit() {
    size.width = Math.max(1, container.clientWidth);
    size.height = Math.max(1, container.clientHeight);
    renderer.setPixelRatio(pixels);
    renderer.setSize(size.width, size.height, false);
    camera.aspect = size.width / size.height;
    loop.request();
  }

  const watching = new ResizeObserver(fit);
  watching.observe(container);
  const endWatching = watchContext(canvas, onLost, () => {
    onFound();
    loop.request();
  });
  fit();

  return {
    scene,
    camera,
    size,
    request: loop.request,
    /** @param {string} colour */
    setBackground: (colour) => background.set(colour),
    ...createAim(camera, size),
    /** Device pixels, as shaders count. */
    viewport: () => [size.width * pixels, size.height * pixels],
    /** Copy the present picture to a new canvas. */
    copy() {
      draw({ dt_s: 0, now_ms: performance.now() });
      render();
      return { picture: copyOf(canvas), scale: canvas.width / size.width };
    },
    figures: () => figures.take(renderer),
    dispose() {
      loop.end();
      watching.disconnect();
      endWatching();
      renderer.dispose();
      renderer.forceContextLoss();
    },
  };
}
