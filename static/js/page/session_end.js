/** Notice before the session ends for inactivity, and after it. Unsaved changes stay in this browser meanwhile. */

import { ApiError, get, post, signInAddress } from "../api.js";
import { h, icon } from "../dom.js";
import { t } from "../text.js";
import { clockText } from "../units.js";

/** @import { Answer } from "../api.js" */
/** @import { SessionTimes } from "../api_types.d.ts" */

/** @typedef {{ ends_at_ms?: number, isOver?: boolean }} Ending */

export const WARNS_S = 300;
const ASKS_AGAIN_S = 30; // while it is about to end, or the server is unavailable: the user may be active in another window
const MAX_TIMER_S = 86_400;

/**
 * Checks the session when it is about to end, and no earlier. `ask()` and `stay()` answer in how many seconds it ends; `show` is called with
 * null, { ends_at_ms } or { isOver: true }. Returns the functions of its two buttons: { look, keep }.
 *
 * @param {object} options
 * @param {number} options.endsIn_s
 * @param {() => Promise<number>} options.ask
 * @param {() => Promise<number>} options.stay
 * @param {(state: Ending | null) => void} options.show
 * @param {(act: () => unknown, wait_ms: number) => any} [options.setTimer]
 * @param {(timer: any) => void} [options.clearTimer]
 * @param {() => number} [options.now_ms]
 */
export function createSessionWatch({
  endsIn_s,
  ask,
  stay,
  show,
  setTimer = setTimeout,
  clearTimer = clearTimeout,
  now_ms = Date.now,
}) {
  /** @type {unknown} */
  let timer = 0;
  /** @type {Ending | null} */
  let shown = null;

  /** @param {Ending | null} state */
  function notify(state) {
    if (state === null && shown === null) return;
    shown = state;
    show(state);
  }

  /** @param {number} left_s */
  function plan(left_s) {
    clearTimer(timer);
    const isSoon = left_s <= WARNS_S;
    notify(isSoon ? { ends_at_ms: now_ms() + left_s * 1_000 } : null);
    const wait_s = isSoon ? Math.min(ASKS_AGAIN_S, left_s + 1) : Math.min(left_s - WARNS_S, MAX_TIMER_S);
    timer = setTimer(look, wait_s * 1_000);
  }

  /** @param {() => Promise<number>} asked */
  async function by(asked) {
    try {
      plan(await asked());
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      clearTimer(timer);
      if (error.isSignedOut) notify({ isOver: true });
      else timer = setTimer(look, ASKS_AGAIN_S * 1_000);
    }
  }

  const look = () => by(ask);
  plan(endsIn_s);
  return { look, keep: () => by(stay) };
}

/** Start on every page with the bar. A computer that slept checks as soon as the page is visible again. @param {number} endsIn_s */
export function watchSessionEnd(endsIn_s) {
  /** @type {HTMLElement | null} */
  let box = null;
  /** @param {typeof get | typeof post} send */
  const answered = (send) => async () => {
    const { data } = /** @type {Answer<SessionTimes>} */ (await send("/account/session"));
    return data.ends_in_s;
  };
  const watch = createSessionWatch({ endsIn_s, ask: answered(get), stay: answered(post), show });
  let hidden_ms = 0;
  document.addEventListener("visibilitychange", () => {
    if (document.hidden) hidden_ms = Date.now();
    else if (Date.now() - hidden_ms > ASKS_AGAIN_S * 1_000) watch.look();
  });

  /** @param {Ending | null} state */
  function show(state) {
    box?.remove();
    box = null;
    if (state === null) return;
    const act = state.isOver
      ? h("a", { class: "button primary", href: signInAddress() }, t("Sign in"))
      : h("button", { type: "button", class: "button primary", onclick: () => watch.keep() }, t("Stay signed in"));
    const why = state.isOver
      ? t("You are signed out, as nobody was here for a while. What is not saved is kept in this browser.")
      : t("You will be signed out at {time}, as nothing was done here. What is not saved is kept in this browser.", {
          time: clockText(new Date(state.ends_at_ms ?? 0).toISOString()),
        });
    box = h("div", { class: "session-word", role: "alert" }, icon("calendar-clock"), h("p", {}, why), act);
    document.body.append(box);
  }
}
