/** The same flight seen from straight above, drawn without WebGL: for machines that have no graphics for the picture in space. */

import { makeFrame } from "../frame.js";
import { makeGround } from "../geometry/ground.js";
import { wiresOf } from "../geometry/wires.js";
import { frameLoop } from "../picture/frame_loop.js";
import { drawUavs, drawWays } from "./flat_flight.js";
import { drawGround } from "./flat_ground.js";

const FIELD_DEG = 40; // of the camera from above: same place and width in both pictures

/** @import { FlownRoute, PlannedLine } from "../flight/drawn_flight.js" */
/** @import { Picture, PictureOptions, Size, Vector } from "../types.d.ts" */

/** @typedef {{ centre: Vector, metresPerPixel: number, turn: number }} FlatView centre of the picture, scale, rotation */

/** @param {Vector} place @param {FlatView} view @param {Size} size @returns {[x: number, y: number]} */
function placeOnScreen([x, , z], { centre, metresPerPixel, turn }, size) {
  const [dx, dz] = [(x - centre[0]) / metresPerPixel, (z - centre[2]) / metresPerPixel];
  const [cosine, sine] = [Math.cos(turn), Math.sin(turn)];
  return [size.width / 2 + dx * cosine + dz * sine, size.height / 2 - dx * sine + dz * cosine];
}

/**
 * @param {HTMLElement} container
 * @param {HTMLCanvasElement} canvas
 * @param {PictureOptions} options
 * @returns {Picture}
 */
export function createFlatPicture(container, canvas, { scene, palette: firstPalette, draw }) {
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  const size = { width: 1, height: 1 };
  const pixels = Math.min(globalThis.devicePixelRatio || 1, 2);
  const frame = makeFrame(scene.origin);
  const wires = wiresOf(scene, frame);
  const { request, end } = frameLoop(draw);
  let palette = firstPalette;
  /** @type {PlannedLine[]} */
  let planned = [];
  /** @type {FlownRoute[]} */
  let flown = [];
  /** @type {FlatView} */
  let view = { centre: [0, 0, 0], metresPerPixel: 1, turn: 0 };
  /** @param {Vector} place */
  const onScreen = (place) => placeOnScreen(place, view, size);

  function fit() {
    size.width = Math.max(1, container.clientWidth);
    size.height = Math.max(1, container.clientHeight);
    [canvas.width, canvas.height] = [Math.round(size.width * pixels), Math.round(size.height * pixels)];
    request();
  }
  const watching = new ResizeObserver(fit);
  watching.observe(container);
  fit();

  return {
    kind: "2d",
    size,
    frame,
    request,
    groundAt: makeGround(scene.ground, frame).heightAt,
    wires: () => wires,
    labels: () => [],
    isNight: () => false,
    showFlight(flight) {
      planned = flight.plannedLines();
      flown = flight.flownLines();
      request();
    },
    showFlown(flight) {
      flown = flight.flownLines();
    },
    setPalette(next) {
      palette = next;
      request();
    },
    setDate() {},
    show({ pose, distance_m, drawn, chosen, looked, at_ms }) {
      const metresPerPixel = (2 * distance_m * Math.tan((FIELD_DEG * Math.PI) / 360)) / size.height;
      const turn = Math.atan2(pose.up[0], -pose.up[2]);
      view = { centre: pose.look, metresPerPixel, turn };
      context.setTransform(pixels, 0, 0, pixels, 0, 0);
      context.fillStyle = palette.ground;
      context.fillRect(0, 0, size.width, size.height);
      drawGround(context, { scene, frame, onScreen, palette, metresPerPixel, size });
      drawWays(context, { planned, flown, onScreen, palette, at_ms, looked });
      drawUavs(context, { drawn, chosen, onScreen, palette, metresPerPixel, turn });
      return false;
    },
    project(place) {
      const [x, y] = onScreen(place);
      return { x, y, away_m: 0 };
    },
    copy() {
      draw({ dt_s: 0, now_ms: performance.now() });
      const copied = document.createElement("canvas");
      [copied.width, copied.height] = [canvas.width, canvas.height];
      copied.getContext("2d")?.drawImage(canvas, 0, 0);
      return { picture: copied, scale: pixels };
    },
    dispose() {
      end();
      watching.disconnect();
    },
  };
}
