/** The clock of a replay: its position, its speed, and its stop at the end. */

export const SPEEDS = [0.5, 1, 5, 20, 60];

/** @typedef {{ from_ms: number, to_ms: number }} TimeSpan since 1970 */
/** @typedef {ReturnType<typeof createPlayer>} Player */

/**
 * onMove() is called at each change. now_ms, nextFrame: for tests.
 *
 * @param {{ onMove: () => void, now_ms?: () => number, nextFrame?: (act: () => void) => void }} options
 */
export function createPlayer({
  onMove,
  now_ms = () => performance.now(),
  nextFrame = (act) => requestAnimationFrame(act),
}) {
  /** @type {TimeSpan | null} */
  let span = null;
  let last_ms = 0;
  /** at_ms: 0 until there is a span */
  const state = { at_ms: 0, speed: 20, isPlaying: false };

  /** @param {TimeSpan} span @param {number} at_ms */
  const clamp = ({ from_ms, to_ms }, at_ms) => Math.min(to_ms, Math.max(from_ms, at_ms));

  function frame() {
    if (!player.isPlaying || !span) return;
    const now = now_ms();
    const at_ms = clamp(span, player.at_ms + (now - last_ms) * player.speed);
    last_ms = now;
    if (at_ms >= span.to_ms) player.isPlaying = false;
    player.at_ms = at_ms;
    onMove();
    if (player.isPlaying) nextFrame(frame);
  }

  const player = Object.assign(state, {
    /**
     * Set the span: the first time the position is the beginning; later it stays, or follows the end if it was there.
     *
     * @param {TimeSpan | null} next
     */
    setSpan(next) {
      const before = span;
      span = next;
      if (!span) return;
      const wasAtEnd = before !== null && player.at_ms >= before.to_ms && before.to_ms < span.to_ms;
      player.at_ms = !before ? span.from_ms : wasAtEnd ? span.to_ms : clamp(span, player.at_ms);
    },
    span: () => span,
    /** @param {number} at_ms */
    seek(at_ms) {
      if (!span) return;
      player.at_ms = clamp(span, at_ms);
      onMove();
    },
    /** Start or stop; from the beginning if it is at the end. */
    toggle() {
      if (!span) return;
      player.isPlaying = !player.isPlaying;
      if (player.isPlaying) {
        if (player.at_ms >= span.to_ms) player.at_ms = span.from_ms;
        last_ms = now_ms();
        nextFrame(frame);
      }
      onMove();
    },
    stop() {
      if (!player.isPlaying) return;
      player.isPlaying = false;
      onMove();
    },
    /** @param {number} speed */
    setSpeed(speed) {
      player.speed = speed;
      onMove();
    },
    /** @param {1 | -1} direction 1: faster */
    changeSpeed(direction) {
      const at = SPEEDS.indexOf(player.speed) + direction;
      if (SPEEDS[at]) player.setSpeed(SPEEDS[at]);
    },
  });
  return player;
}
