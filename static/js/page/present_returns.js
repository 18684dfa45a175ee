/** What UAVs meet if they return now, asked for just before the question whether they shall. */

import { ApiError, get } from "../api.js";

/** @import { PresentReturn, PresentReturns } from "../api_types.d.ts" */
/** @import { Answer } from "../api.js" */

const CHECK_TIMEOUT_MS = 4000; // the question waits no longer

/**
 * By UAV; empty where that could not be read: the question then says that nobody has looked.
 *
 * @param {number[]} uavs that return at once
 * @returns {Promise<Map<number, PresentReturn>>}
 */
export async function returnsNow(uavs) {
  if (!uavs.length) return new Map();
  const signal = AbortSignal.timeout(CHECK_TIMEOUT_MS);
  try {
    const query = uavs.map((uav) => `uav=${uav}`).join("&");
    const { data } = /** @type {Answer<PresentReturns>} */ (await get(`/returns?${query}`, { signal }));
    return new Map(data.results.map((found) => [found.uav ?? 0, found]));
  } catch (error) {
    if (!(error instanceof ApiError || signal.aborted)) throw error;
    return new Map();
  }
}
