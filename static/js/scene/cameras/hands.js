/** Mouse, touch and pen on the picture: one finger turns, two pinch and move, the wheel zooms; keys that are held move on. */

/** @import { Rig } from "./rig.js" */

/** @typedef {ReturnType<typeof listenToHands>} Hands */

const TURN_DEG_PER_PX = 0.28;
const WHEEL = 0.0014;
const CLICK_PX = 5;
/** @type {Record<string, { turn?: [right: number, up: number], move?: [ahead: number, right: number, up: number] }>} by key */
const HELD = {
  arrowleft: { turn: [-1, 0] },
  arrowright: { turn: [1, 0] },
  arrowup: { turn: [0, 1] },
  arrowdown: { turn: [0, -1] },
  w: { move: [1, 0, 0] },
  s: { move: [-1, 0, 0] },
  a: { move: [0, -1, 0] },
  d: { move: [0, 1, 0] },
  e: { move: [0, 0, 1] },
  q: { move: [0, 0, -1] },
};
const TURNS_DEG_S = 55;
const MOVES_MPS = 22;
const FAST = 5; // with Shift

/** @param {number[][]} points */
const middleOf = (points) => [
  points.reduce((sum, [x]) => sum + x, 0) / points.length,
  points.reduce((sum, [, y]) => sum + y, 0) / points.length,
];
/** @param {number[][]} points */
const spreadOf = ([[xa, ya], [xb, yb]]) => Math.hypot(xa - xb, ya - yb);

/** @param {Rig} rig */
const looksOut = ({ mode }) => mode === "free" || mode === "onboard";

/**
 * @typedef {object} HandActs
 * @property {() => void} onChange called after a movement
 * @property {(at: { x: number, y: number }) => void} onPick a click or tap at a place of the picture
 */

/** @param {HTMLCanvasElement} canvas @param {Rig} rig @param {HandActs} acts */
export function listenToHands(canvas, rig, { onChange, onPick }) {
  const endFingers = listenToFingers(canvas, rig, { onChange, onPick });
  const keys = heldKeys(rig, onChange);
  /** @param {WheelEvent} event */
  function wheel(event) {
    event.preventDefault();
    rig.zoom(Math.exp(Math.max(-300, Math.min(300, event.deltaY * (event.deltaMode ? 30 : 1))) * WHEEL));
    onChange();
  }
  canvas.addEventListener("wheel", wheel, { passive: false });
  return {
    press: keys.press,
    isHeld: keys.isHeld,
    advance: keys.advance,
    dispose() {
      endFingers();
      keys.dispose();
      canvas.removeEventListener("wheel", wheel);
    },
  };
}

/**
 * Mouse, touch and pen; returns what ends it.
 *
 * @param {HTMLCanvasElement} canvas
 * @param {Rig} rig
 * @param {HandActs} acts
 */
function listenToFingers(canvas, rig, { onChange, onPick }) {
  /** @type {Map<number, number[]>} */
  const fingers = new Map();
  let moved_px = 0;
  const heightPx = () => canvas.clientHeight || 1;

  /** @param {PointerEvent} event */
  function down(event) {
    if (event.pointerType === "mouse" && event.button > 2) return;
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
    if (fingers.size === 1) moved_px = 0;
  }

  /** @param {PointerEvent} event */
  function move(event) {
    const last = fingers.get(event.pointerId);
    if (!last) return;
    const before = [...fingers.values()];
    fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
    const [dx, dy] = [event.offsetX - last[0], event.offsetY - last[1]];
    moved_px += Math.hypot(dx, dy);
    if (fingers.size === 1) {
      const isMoving = event.shiftKey || event.ctrlKey || (event.buttons & 6) !== 0 || rig.mode === "top";
      if (isMoving) rig.pan(-dx / heightPx(), dy / heightPx());
      else if (looksOut(rig)) rig.turn(-dx * TURN_DEG_PER_PX * 0.6, dy * TURN_DEG_PER_PX * 0.6);
      else rig.turn(dx * TURN_DEG_PER_PX, dy * TURN_DEG_PER_PX);
    } else if (fingers.size === 2) {
      const after = [...fingers.values()];
      const [from, to] = [middleOf(before), middleOf(after)];
      rig.zoom(Math.max(0.5, Math.min(2, spreadOf(before) / Math.max(1, spreadOf(after)))));
      rig.pan(-(to[0] - from[0]) / heightPx(), (to[1] - from[1]) / heightPx());
    }
    onChange();
  }

  /** @param {PointerEvent} event */
  function up(event) {
    const at = fingers.get(event.pointerId);
    if (!at) return;
    fingers.delete(event.pointerId);
    if (event.type === "pointerup" && fingers.size === 0 && moved_px < CLICK_PX && event.button === 0)
      onPick({ x: at[0], y: at[1] });
  }

  const ending = new AbortController();
  const { signal } = ending;
  canvas.addEventListener("pointerdown", down, { signal });
  canvas.addEventListener("pointermove", move, { signal });
  canvas.addEventListener("pointerup", up, { signal });
  canvas.addEventListener("pointercancel", up, { signal });
  canvas.addEventListener("contextmenu", (event) => event.preventDefault(), { signal }); // the right button moves
  return () => ending.abort();
}

/** Keys that move the camera as long as they are held. @param {Rig} rig @param {() => void} onChange */
function heldKeys(rig, onChange) {
  /** @type {Set<string>} */
  const held = new Set();
  let isFast = false;
  /** @param {KeyboardEvent} event */
  const release = (event) => held.delete(event.key.toLowerCase());
  const releaseAll = () => held.clear();
  document.addEventListener("keyup", release);
  window.addEventListener("blur", releaseAll);
  return {
    /** Handle a key; returns whether it is one of the camera's. @param {KeyboardEvent} event */
    press(event) {
      const key = event.key.toLowerCase();
      if (!(key in HELD) || event.ctrlKey || event.metaKey || event.altKey) return false;
      if (HELD[key].move && rig.mode !== "free") return false;
      isFast = event.shiftKey;
      held.add(key);
      onChange();
      return true;
    },
    isHeld: () => held.size > 0,
    /** What held keys do in a frame. @param {number} dt_s */
    advance(dt_s) {
      for (const key of held) {
        const { turn, move } = HELD[key];
        if (turn) {
          const sign = looksOut(rig) ? 1 : -1;
          if (rig.mode === "top") rig.pan((turn[0] * dt_s) / 2, (turn[1] * dt_s) / 2);
          else rig.turn(turn[0] * sign * TURNS_DEG_S * dt_s, turn[1] * TURNS_DEG_S * dt_s);
        } else if (move) {
          const much_m = MOVES_MPS * (isFast ? FAST : 1) * dt_s;
          rig.move(move[0] * much_m, move[1] * much_m, move[2] * much_m);
        }
      }
    },
    dispose() {
      document.removeEventListener("keyup", release);
      window.removeEventListener("blur", releaseAll);
    },
  };
}
