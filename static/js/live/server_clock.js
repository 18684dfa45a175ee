/** The server's time, for a page whose own clock may be wrong: ages are computed with it. */

const WINDOW_MS = 60_000;

/**
 * Create a clock of the server: `received("2026-…")` takes the time in each message; `now_ms()` is the server's time now, in milliseconds
 * since 1970.
 */
export function serverClock(ticks_ms = () => performance.now(), first_ms = Date.now()) {
  const guess_ms = first_ms - ticks_ms();
  /** @type {{ at_ms: number, ahead_ms: number }[]} */
  let received = []; // lower bound of the server's offset from our clock: a message has a delay, so the largest is the best
  const newest = () => received.filter(({ at_ms }) => ticks_ms() - at_ms <= WINDOW_MS);
  return {
    /** @param {string} serverTime */
    received(serverTime) {
      const at_ms = ticks_ms();
      received = [...newest(), { at_ms, ahead_ms: Date.parse(serverTime) - at_ms }];
    },
    now_ms() {
      const last = received.at(-1);
      if (!last) return ticks_ms() + guess_ms;
      return ticks_ms() + Math.max(last.ahead_ms, ...newest().map(({ ahead_ms }) => ahead_ms));
    },
  };
}
