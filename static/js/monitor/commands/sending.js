/** Commands on their way to the server, or not yet in the feed: shown on the card at once. */

/** @import { CommandKind } from "../../api_types.d.ts" */
/** @import { MonitorStore } from "../types.d.ts" */

const CLOCKS_APART_MS = 3000;
const MAX_SENDING_MS = 12_000; // after this time the other parts of the card show it

/** @param {MonitorStore} store @param {number[]} ids of UAVs @param {CommandKind | null} kind null: no command is being sent */
export function markSending(store, ids, kind) {
  const sending = new Map(store.state.sending);
  for (const id of ids) {
    if (kind) sending.set(id, { kind, at_ms: store.state.now_ms });
    else sending.delete(id);
  }
  store.update({ sending });
}

/** Drop them once the feed reports the commands. @param {MonitorStore} store */
export function dropSent(store) {
  store.listen(["commands", "now_ms"], ({ commands, sending, now_ms }) => {
    for (const [id, { kind, at_ms }] of sending) {
      const isThere = commands.some(
        (one) => one.uav.id === id && one.kind === kind && Date.parse(one.created_at) >= at_ms - CLOCKS_APART_MS,
      );
      if (isThere || now_ms - at_ms > MAX_SENDING_MS) markSending(store, [id], null);
    }
  });
}
