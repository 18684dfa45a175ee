/** Reading of the event log while it is visible: the newest page, new events after a change in the feed, older pages on demand. */

import { ApiError, get } from "../api.js";
import { toast } from "../page/toast.js";
import { merged } from "./event_log.js";

/** @import { Answer } from "../api.js" */
/** @import { MissionEventPage } from "../api_types.d.ts" */
/** @import { MonitorPage, MonitorStore } from "./types.d.ts" */

const EVERY_MS = 5_000; // at most

/** @param {MonitorStore} store @param {MonitorPage} page */
export function createEventReading(store, page) {
  const newest = page.mission === null ? "/live/events" : `/missions/${page.mission}/events`;
  let read_ms = -Infinity;
  let isWaiting = false;

  async function readNewest() {
    isWaiting = false;
    read_ms = performance.now();
    try {
      const { results, next } = /** @type {Answer<MissionEventPage>} */ (await get(newest)).data;
      const { events, olderEvents } = store.state;
      const isFirst = events === null;
      // Where more events arrived than fit on one page, those in between are read with the older ones.
      const hasGap = !isFirst && next !== null && !results.some(({ key }) => events.some((event) => event.key === key));
      store.update({
        events: merged(hasGap ? [] : (events ?? []), results),
        olderEvents: isFirst || hasGap ? next : olderEvents,
      });
    } catch (error) {
      if (!(error instanceof ApiError)) throw error; // the page's head reports the lost connection
    }
  }

  /** Read changes within five seconds. */
  function refresh() {
    if (!store.state.showsLog || isWaiting) return;
    isWaiting = true;
    setTimeout(() => void readNewest(), Math.max(0, read_ms + EVERY_MS - performance.now()));
  }
  store.listen(["showsLog", "uavs", "missions", "alerts", "commands", "offers"], refresh);

  return {
    async readOlder() {
      const address = store.state.olderEvents;
      if (!address) return;
      try {
        const { results, next } = /** @type {Answer<MissionEventPage>} */ (await get(address)).data;
        store.update({ events: merged(store.state.events ?? [], results), olderEvents: next });
      } catch (error) {
        if (!(error instanceof ApiError)) throw error;
        toast(error.message);
      }
    },
  };
}
