/** The same flight seen from straight above, drawn without WebGL: for machines that have no graphics for the picture in space. */

import { makeFrame } from "../frame.js";
import { makeGround } from "../geometry/ground.js";
import { wiresOf } from "../geometry/wires.js";
import { drawUavs, drawWays } from "./flat_flight.js";
import { drawGround } from "./flat_ground.js";

const FIELD_DEG = 40; // of the camera from above: the same place and width in both pictures

/** As picture.js; draw() before each picture. */
export function createFlatPicture(container, canvas, { palette, draw }) {
  const context = canvas.getContext("2d");
  const size = { width: 1, height: 1 };
  const pixels = Math.min(globalThis.devicePixelRatio || 1, 2);
  let colours = palette;
  let [scene, flight, planned, flown] = [null, null, [], []];
  let heights = () => 0;
  let wires = null;
  let [wanted, last_ms, isOver] = [0, 0, false];
  let at = { centre: [0, 0, 0], metresPerPixel: 1, turn: 0 };

  function frame(now_ms) {
    wanted = 0;
    if (isOver) return;
    const goesOn = draw({ dt_s: last_ms ? Math.min(0.25, (now_ms - last_ms) / 1_000) : 0, now_ms });
    last_ms = goesOn ? now_ms : 0;
    if (goesOn) request();
  }

  function request() {
    if (!wanted && !isOver) wanted = requestAnimationFrame(frame);
  }

  function fit() {
    size.width = Math.max(1, container.clientWidth);
    size.height = Math.max(1, container.clientHeight);
    [canvas.width, canvas.height] = [Math.round(size.width * pixels), Math.round(size.height * pixels)];
    request();
  }
  const watching = new ResizeObserver(fit);
  watching.observe(container);
  fit();

  function onScreen([x, , z]) {
    const [dx, dz] = [(x - at.centre[0]) / at.metresPerPixel, (z - at.centre[2]) / at.metresPerPixel];
    const [cosine, sine] = [Math.cos(at.turn), Math.sin(at.turn)];
    return [size.width / 2 + dx * cosine + dz * sine, size.height / 2 - dx * sine + dz * cosine];
  }

  const picture = {
    kind: "2d",
    size,
    request,
    frame: null,
    groundAt: (x, z) => heights(x, z),
    wires: () => wires,
    labels: () => [],
    isNight: () => false,
    showGround(next) {
      scene = next;
      picture.frame = makeFrame(next.origin);
      heights = makeGround(next.ground, picture.frame).heightAt;
      wires = wiresOf(next, picture.frame);
    },
    showFlight(next) {
      flight = next;
      planned = flight.plannedLines();
      flown = flight.flownLines();
      request();
    },
    showFlown(next) {
      flown = next.flownLines();
    },
    setPalette(next) {
      colours = next;
      request();
    },
    setDate() {},
    show({ pose, distance_m, drawn, chosen, looked, at_ms }) {
      at = {
        centre: pose.look,
        metresPerPixel: (2 * distance_m * Math.tan((FIELD_DEG * Math.PI) / 360)) / size.height,
        turn: Math.atan2(pose.up[0], -pose.up[2]),
      };
      context.setTransform(pixels, 0, 0, pixels, 0, 0);
      context.fillStyle = colours.ground;
      context.fillRect(0, 0, size.width, size.height);
      drawGround(context, {
        scene,
        frame: picture.frame,
        onScreen,
        palette: colours,
        metresPerPixel: at.metresPerPixel,
        size,
      });
      drawWays(context, { planned, flown, onScreen, palette: colours, at_ms, looked });
      drawUavs(context, {
        drawn,
        chosen,
        onScreen,
        palette: colours,
        metresPerPixel: at.metresPerPixel,
        turn: at.turn,
      });
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
      copied.getContext("2d").drawImage(canvas, 0, 0);
      return { picture: copied, scale: pixels };
    },
    dispose() {
      isOver = true;
      cancelAnimationFrame(wanted);
      watching.disconnect();
    },
  };
  return picture;
}
