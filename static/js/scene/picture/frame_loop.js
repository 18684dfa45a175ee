/** Requested frames: each is drawn once, and the next one is requested as long as something moves. */

/** @import { FrameTime } from "../types.d.ts" */

const MAX_STEP_S = 0.25; // prevents jumps after a pause

/** @typedef {FrameTime & { between_ms: number }} LoopTime between_ms: since the frame before; 0 after a pause */

/** @param {(time: LoopTime) => boolean} draw returns whether the next frame is wanted at once */
export function frameLoop(draw) {
  let [wanted, last_ms, isOver] = [0, 0, false];

  /** @param {number} now_ms */
  function frame(now_ms) {
    wanted = 0;
    if (isOver) return;
    const between_ms = last_ms ? now_ms - last_ms : 0;
    const goesOn = draw({ dt_s: Math.min(MAX_STEP_S, between_ms / 1_000), now_ms, between_ms });
    last_ms = goesOn ? now_ms : 0;
    if (goesOn) request();
  }

  function request() {
    if (!wanted && !isOver) wanted = requestAnimationFrame(frame);
  }

  return {
    request,
    end() {
      isOver = true;
      cancelAnimationFrame(wanted);
    },
  };
}
