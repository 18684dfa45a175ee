/** Notice on a page that no longer receives updates. Values in, values out. */

import { t } from "../text.js";
import { exactClockText } from "../units.js";
import { CONNECTING, CROWDED, FEED_LOST_MS, GONE, SIGNED_OUT } from "./feed.js";

/** @import { FeedState } from "./feed.js" */

const GRACE_MS = 2500; // a page that has just been opened, or a wink of the network, is not called cut off

/**
 * link, since_ms: state of feed.js and since when, by the server's clock; silent_ms: since the last message, which came at received_ms.
 * → { words, rest, isBad, needsDoor } or null.
 *
 * @param {{ link: FeedState | null, since_ms: number, now_ms: number, silent_ms?: number, received_ms?: number | null }} feed
 * @returns {{ words: string, rest?: string, isBad: boolean, needsDoor?: boolean } | null}
 */
export function staleWords({ link, since_ms, now_ms, silent_ms = 0, received_ms = null }) {
  if (link === SIGNED_OUT)
    return { words: t("You are signed out: nothing comes in any more."), isBad: true, needsDoor: true };
  if (link === GONE) return { words: t("This mission has been deleted."), isBad: true };
  if (received_ms !== null && silent_ms >= FEED_LOST_MS)
    return {
      words: t("No data on this device for {seconds} s.", {
        seconds: Math.floor(silent_ms / FEED_LOST_MS) * (FEED_LOST_MS / 1000), // in steps: it is read aloud
      }),
      rest: t("Last message {time}: everything here is as of then. Connecting again.", {
        time: exactClockText(new Date(received_ms).toISOString()),
      }),
      isBad: true,
    };
  if (link === CROWDED)
    return {
      words: t("Too many live pages are open."),
      rest: t("This one is updated every two seconds. Close some that you do not need."),
      isBad: false,
    };
  if (link === CONNECTING && received_ms === null && now_ms - since_ms > GRACE_MS)
    return { words: t("No live data yet."), rest: t("Connecting again."), isBad: true };
  return null;
}
