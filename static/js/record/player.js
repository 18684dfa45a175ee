/** The clock of a replay: where it stands, how fast it goes, and that it stops at the end. */

export const SPEEDS = [0.5, 1, 5, 20, 60];

/** onMove() is told of each change. now_ms, nextFrame: for tests. */
export function createPlayer({
  onMove,
  now_ms = () => performance.now(),
  nextFrame = (act) => requestAnimationFrame(act),
}) {
  let span = null;
  let last_ms = 0;
  const player = { at_ms: null, speed: 20, isPlaying: false };

  const clamp = (at_ms) => Math.min(span.to_ms, Math.max(span.from_ms, at_ms));

  function frame() {
    if (!player.isPlaying) return;
    const now = now_ms();
    const at_ms = clamp(player.at_ms + (now - last_ms) * player.speed);
    last_ms = now;
    if (at_ms >= span.to_ms) player.isPlaying = false;
    player.at_ms = at_ms;
    onMove();
    if (player.isPlaying) nextFrame(frame);
  }

  return Object.assign(player, {
    /** The first time at the beginning; later it stays, or goes with the end where it stood there. */
    setSpan(next) {
      const wasAtEnd = span !== null && player.at_ms >= span.to_ms && span.to_ms < (next?.to_ms ?? 0);
      const isFirst = span === null;
      span = next;
      if (!span) return;
      player.at_ms = isFirst ? span.from_ms : wasAtEnd ? span.to_ms : clamp(player.at_ms);
    },
    span: () => span,
    seek(at_ms) {
      if (!span) return;
      player.at_ms = clamp(at_ms);
      onMove();
    },
    /** From the beginning where it stands at the end. */
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
    setSpeed(speed) {
      player.speed = speed;
      onMove();
    },
    /** direction 1: faster, -1: slower. */
    changeSpeed(direction) {
      const at = SPEEDS.indexOf(player.speed) + direction;
      if (SPEEDS[at]) player.setSpeed(SPEEDS[at]);
    },
  });
}
