/** What UAVs meet if they return now or land where they are, asked for just before the question whether they shall. */

import { ApiError, get } from "../api.js";

/** @import { LandingHere, PresentReturn, PresentReturns } from "../api_types.d.ts" */
/** @import { Answer } from "../api.js" */

const CHECK_TIMEOUT_MS = 4000; // the question waits no longer

/**
 * What the server says of it now; null where that could not be read in time.
 *
 * @template Found
 * @param {string} path
 * @returns {Promise<Found | null>}
 */
async function askedInTime(path) {
  const signal = AbortSignal.timeout(CHECK_TIMEOUT_MS);
  try {
    return /** @type {Answer<Found>} */ (await get(path, { signal })).data;
  } catch (error) {
    if (!(error instanceof ApiError || signal.aborted)) throw error;
    return null;
  }
}

/**
 * By UAV; empty where that could not be read: the question then says that nobody has looked.
 *
 * @param {number[]} uavs that return at once
 * @returns {Promise<Map<number, PresentReturn>>}
 */
export async function returnsNow(uavs) {
  if (!uavs.length) return new Map();
  const query = uavs.map((uav) => `uav=${uav}`).join("&");
  const found = /** @type {PresentReturns | null} */ (await askedInTime(`/returns?${query}`));
  return new Map((found?.results ?? []).map((one) => [one.uav ?? 0, one]));
}

/** What lies below it. @param {number} uav @returns {Promise<LandingHere | null>} */
export const landingNow = (uav) => askedInTime(`/uavs/${uav}/landing`);

/**
 * What a question before a command has to know of the present.
 *
 * @param {number | null} uav
 * @param {string} kind
 * @returns {Promise<{ returns?: PresentReturn, landing?: LandingHere | null, hold_s?: number | null }>}
 */
export async function presentOf(uav, kind) {
  if (uav === null) return {};
  if (kind === "return" || kind === "abort") return { returns: (await returnsNow([uav])).get(uav) };
  if (kind === "hold" || kind === "pause") return { hold_s: (await returnsNow([uav])).get(uav)?.battery.hold_s };
  return kind === "land" ? { landing: await landingNow(uav) } : {};
}
