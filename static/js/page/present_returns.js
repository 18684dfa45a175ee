/** Obstructions if UAVs return or land now, requested while the confirmation is open. */

import { ApiError, get } from "../api.js";
import { questionOf } from "../domain/command_questions.js";
import { t } from "../text.js";

/** @import { AskedKind, AskedOf, Question } from "../domain/command_questions.js" */
/** @import { LandingHere, PresentReturn, PresentReturns } from "../api_types.d.ts" */
/** @import { Answer } from "../api.js" */

const CHECK_TIMEOUT_MS = 4000; // then the question states that the path was not checked
export const CHECKING_HOME = t("Checking the return path …");
/** @type {Partial<Record<AskedKind, string>>} */
const LOOKED_AT = {
  return: CHECKING_HOME,
  abort: CHECKING_HOME,
  land: t("Checking the landing place …"),
  hold: t("Checking how long it can hold …"),
};

/**
 * The server's present answer; null where it could not be read in time.
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
 * Returns by UAV; empty where they could not be read: the question then states that the path was not checked.
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

/** The check of a landing below the UAV. @param {number} uav @returns {Promise<LandingHere | null>} */
export const landingNow = (uav) => askedInTime(`/uavs/${uav}/landing`);

/**
 * The present state that a question before a command needs.
 *
 * @param {number} uav
 * @param {AskedKind} kind
 * @returns {Promise<{ returns?: PresentReturn, landing?: LandingHere | null, hold_s?: number | null }>}
 */
async function presentOf(uav, kind) {
  if (kind === "land") return { landing: await landingNow(uav) };
  const found = (await returnsNow([uav])).get(uav);
  return kind === "return" || kind === "abort" ? { returns: found } : { hold_s: found?.battery.hold_s };
}

/**
 * The question as it can be asked at once, and updated once the server has answered.
 *
 * @param {number | null} uav
 * @param {AskedKind} kind
 * @param {AskedOf} flyer
 * @param {(lines: Question["lines"]) => Question["lines"]} [withMore] adds the other lines
 * @returns {Question}
 */
export function presentQuestion(uav, kind, flyer, withMore = (lines) => lines) {
  const first = questionOf(kind, flyer);
  const needs = uav !== null && LOOKED_AT[kind];
  if (!needs) return { ...first, lines: withMore(first.lines) };
  return {
    ...first,
    lines: withMore([first.lines[0], needs]),
    later: presentOf(uav, kind).then((present) => {
      const { lines, ...known } = questionOf(kind, { ...flyer, ...present });
      return { ...known, lines: withMore(lines) };
    }),
  };
}
