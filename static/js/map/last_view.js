/** The view at which the user's maps open, stored in the account once the map rests after a move. */

import { put } from "../api.js";
import { copiedAt } from "../offline_copy.js";

/** @import { MapLibreMap } from "./types.d.ts" */

const STORE_AFTER_MS = 1_500;

/**
 * Store the view after the user has moved the map. Moves of the page itself do not count: those that say so (`isOfPage`), and any before the
 * first act of the user.
 *
 * @param {MapLibreMap} map
 */
export function storeLastView(map) {
  if (copiedAt !== null) return;
  let stored = textOf(map);
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;
  function store() {
    clearTimeout(timer);
    timer = undefined;
    const view = textOf(map);
    if (view === stored) return;
    stored = view;
    // The next move tries again.
    put("/account/map-view", JSON.parse(view), { keepalive: true }).catch(() => {});
  }
  map.on("moveend", (event) => {
    if ("isOfPage" in event && event.isOfPage) return;
    const isOfUser = "originalEvent" in event && event.originalEvent;
    if (!isOfUser && !navigator.userActivation?.hasBeenActive) return;
    clearTimeout(timer); // the map may follow a UAV: only where it comes to rest counts
    timer = setTimeout(store, STORE_AFTER_MS);
  });
  addEventListener("pagehide", () => {
    if (timer) store();
  });
}

/** @param {MapLibreMap} map */
function textOf(map) {
  const { lng, lat } = map.getCenter().wrap();
  return JSON.stringify({
    zoom: Number(map.getZoom().toFixed(2)),
    longitude: Number(lng.toFixed(6)),
    latitude: Number(lat.toFixed(6)),
  });
}
