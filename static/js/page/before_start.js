/** Upload and start of an approved mission's UAVs: on the page Fly, and on the mission's own after a question that shows the checks. */

import { ApiError, freshKey, get, post } from "../api.js";
import { KINDS } from "../domain/flying.js";
import { summaryOf, worstOf } from "../domain/preflight_step.js";
import { t, tn } from "../text.js";
import { heightText } from "../units.js";
import { commandUav } from "./command_uav.js";
import { confirmAct } from "./confirm.js";
import { beginStarts } from "./planned_starts.js";
import { toast } from "./toast.js";

/** @import { Answer } from "../api.js" */
/** @import { Mission, MissionStarts, Preflight, UavPreflight } from "../api_types.d.ts" */
/** @import { NextStep } from "../domain/preflight_step.js" */

/** @typedef {{ uav: number, name: string, height_m: number }} ReturnHeight */

/** Return altitudes to set with the upload: lower, a return path is obstructed. @param {Preflight} preflight @returns {ReturnHeight[]} */
export const heightsWanted = ({ next_act, uavs }) =>
  next_act === "upload"
    ? uavs
        .filter(({ is_loaded }) => !is_loaded)
        .flatMap(({ uav, name, checks }) => {
          const height_m = checks.find(({ safe_height_m }) => safe_height_m !== null)?.safe_height_m ?? null;
          return height_m === null ? [] : [{ uav, name, height_m }];
        })
    : [];

/** @param {ReturnHeight} height */
export const heightWords = ({ name, height_m }) =>
  t("Also set the return altitude of {name} to {height}: lower, its return path is obstructed", {
    name,
    height: heightText(height_m),
  });

/** Whether the command was sent. @param {ReturnHeight} height */
export async function setHeight({ uav, name, height_m }) {
  try {
    return await commandUav(uav, name, "set-return-height", { height_m });
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    toast(`${t("{act}: not sent to {name}.", { name, act: KINDS["set-return-height"] })} ${error.message}`);
    return false;
  }
}

/** Upload to all UAVs without a mission; of the revision that was just read. @param {string} mission @param {ReturnHeight[]} heights */
export async function upload(mission, heights) {
  const { data } = /** @type {Answer<Mission>} */ (await get(`/missions/${mission}`));
  const headers = { "If-Match": `"${data.revision}"`, "Idempotency-Key": freshKey() };
  await post(`/missions/${mission}/dispatch`, {}, { headers });
  for (const height of heights) await setHeight(height);
}

/**
 * Those that are ready, in planned order. `checked`: the lines of the question that also asks for the pilot's checks.
 *
 * @param {string} mission
 * @param {NextStep} step
 * @param {HTMLElement} opener
 * @param {string[] | null} [checked]
 */
export async function start(mission, { uavs, left }, opener, checked = null) {
  const { data } = /** @type {Answer<MissionStarts>} */ (await get(`/missions/${mission}/planned-starts`));
  const waiting = data.waiting.filter(({ uav }) => uavs.includes(uav));
  await beginStarts(mission, waiting, opener, { left, checked });
}

/** Every check that is not all right, of the mission and of the UAVs of a step. @param {Preflight} preflight @param {NextStep} step */
export function checkLines({ checks, uavs }, step) {
  /** @param {UavPreflight} row */
  const isShown = (row) => step.uavs.includes(row.uav) && worstOf(row.checks) !== "ok";
  return [
    ...checks.filter(({ state }) => state !== "ok").map(({ message }) => message),
    ...uavs.filter(isShown).map((row) => `${row.name}: ${summaryOf(row)}`),
  ];
}

/**
 * Ask before an upload. Resolves to the return altitudes to set with it; null where the user cancels.
 *
 * @param {Preflight} preflight
 * @param {NextStep} step
 * @param {HTMLElement} opener
 */
export async function askForUpload(preflight, step, opener) {
  const heights = heightsWanted(preflight);
  const names = preflight.uavs.filter(({ uav }) => step.uavs.includes(uav)).map(({ name }) => name);
  const asked = await confirmAct({
    title: tn(names.length, "Upload the mission to {count} UAV?", "Upload the mission to {count} UAVs?"),
    lines: [`${names.join(", ")}.`, ...checkLines(preflight, step), t("The upload to each UAV is verified.")],
    checks: heights.map((height) => ({ name: `height-${height.uav}`, words: heightWords(height) })),
    act: step.words,
    image: step.image,
    isBack: true,
    opener,
  });
  return asked && heights.filter(({ uav }) => asked[`height-${uav}`]);
}
