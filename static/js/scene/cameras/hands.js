/** Mouse, touch and pen on the picture: one finger turns, two pinch and move, the wheel zooms; keys that are held move on. */

const TURN_DEG_PER_PX = 0.28;
const WHEEL = 0.0014;
const CLICK_PX = 5;
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

/** rig: of rig.js; onChange(): something has moved; onPick({ x, y }): a click or tap at a place of the picture. */
export function listenToHands(canvas, rig, { onChange, onPick }) {
  const fingers = new Map();
  const held = new Set();
  let moved_px = 0;
  let isFast = false;
  const heightPx = () => canvas.clientHeight || 1;

  const middleOf = (points) => [
    points.reduce((sum, [x]) => sum + x, 0) / points.length,
    points.reduce((sum, [, y]) => sum + y, 0) / points.length,
  ];
  const spreadOf = ([[xa, ya], [xb, yb]]) => Math.hypot(xa - xb, ya - yb);

  function down(event) {
    if (event.pointerType === "mouse" && event.button > 2) return;
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
    if (fingers.size === 1) moved_px = 0;
  }

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
      else if (rig.mode === "free" || rig.mode === "onboard")
        rig.turn(-dx * TURN_DEG_PER_PX * 0.6, dy * TURN_DEG_PER_PX * 0.6);
      else rig.turn(dx * TURN_DEG_PER_PX, dy * TURN_DEG_PER_PX);
    } else if (fingers.size === 2) {
      const after = [...fingers.values()];
      const [from, to] = [middleOf(before), middleOf(after)];
      rig.zoom(Math.max(0.5, Math.min(2, spreadOf(before) / Math.max(1, spreadOf(after)))));
      rig.pan(-(to[0] - from[0]) / heightPx(), (to[1] - from[1]) / heightPx());
    }
    onChange();
  }

  function up(event) {
    const at = fingers.get(event.pointerId);
    if (!at) return;
    fingers.delete(event.pointerId);
    if (event.type === "pointerup" && fingers.size === 0 && moved_px < CLICK_PX && event.button === 0)
      onPick({ x: at[0], y: at[1] });
  }

  function wheel(event) {
    event.preventDefault();
    rig.zoom(Math.exp(Math.max(-300, Math.min(300, event.deltaY * (event.deltaMode ? 30 : 1))) * WHEEL));
    onChange();
  }

  /** A key that moves the camera as long as it is held; false: it is none. */
  function press(event) {
    const key = event.key.toLowerCase();
    if (!(key in HELD) || event.ctrlKey || event.metaKey || event.altKey) return false;
    if (HELD[key].move && rig.mode !== "free") return false;
    isFast = event.shiftKey;
    held.add(key);
    onChange();
    return true;
  }

  const release = (event) => held.delete(event.key.toLowerCase());
  const releaseAll = () => held.clear();

  const menu = (event) => event.preventDefault(); // the right button moves
  const listeners = [
    ["pointerdown", down],
    ["pointermove", move],
    ["pointerup", up],
    ["pointercancel", up],
    ["contextmenu", menu],
  ];
  for (const [name, act] of listeners) canvas.addEventListener(name, act);
  canvas.addEventListener("wheel", wheel, { passive: false });
  document.addEventListener("keyup", release);
  window.addEventListener("blur", releaseAll);

  return {
    press,
    isHeld: () => held.size > 0,
    /** What held keys do in a frame. */
    advance(dt_s) {
      for (const key of held) {
        const { turn, move: way } = HELD[key];
        const much = isFast ? FAST : 1;
        if (turn) {
          const sign = rig.mode === "free" || rig.mode === "onboard" ? [1, 1] : [-1, 1];
          if (rig.mode === "top") rig.pan((turn[0] * dt_s) / 2, (turn[1] * dt_s) / 2);
          else rig.turn(turn[0] * sign[0] * TURNS_DEG_S * dt_s, turn[1] * sign[1] * TURNS_DEG_S * dt_s);
        } else rig.move(...way.map((share) => share * MOVES_MPS * much * dt_s));
      }
    },
    dispose() {
      for (const [name, act] of listeners) canvas.removeEventListener(name, act);
      canvas.removeEventListener("wheel", wheel);
      document.removeEventListener("keyup", release);
      window.removeEventListener("blur", releaseAll);
    },
  };
}
