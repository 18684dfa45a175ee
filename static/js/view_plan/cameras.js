/** The choice of a camera for a plan of photos: those of the UAV types first, then the catalogue. */

import { get } from "../api.js";
import { cameraOf, groupsOf, optionsOf, readCatalogue } from "../cameras/catalogue.js";
import { standoff_m } from "../cameras/words.js";
import { h } from "../dom.js";
import { t } from "../text.js";

/** @import { Answer } from "../api.js" */
/** @import { Camera, UavTypePage, ViewPlan, ViewPlanInputRequest } from "../api_types.d.ts" */

/** @typedef {{ camera: Camera, request: Pick<ViewPlanInputRequest, "camera" | "camera_key"> }} Choice request: how it is asked for */

const MAX_TYPES = 1000;

/**
 * Returns the options of a select, and by their values what they stand for, in the same order. Rejects with ApiError.
 *
 * @param {AbortSignal} signal
 */
export async function readCameras(signal) {
  const [types, catalogue] = await Promise.all([
    get(`/uav-types?limit=${MAX_TYPES}`, { signal }).then((answer) => /** @type {Answer<UavTypePage>} */ (answer).data),
    readCatalogue(),
  ]);
  /** @type {Map<string, Choice>} */
  const choices = new Map();
  const own = types.results.flatMap(({ id, name, cameras = [] }) => {
    if (!cameras.length) return [];
    const options = cameras.map((camera, place) => {
      const value = `type-${id}-${place}`;
      choices.set(value, { camera, request: { camera } });
      return h("option", { value }, camera.name);
    });
    return [h("optgroup", { label: t("UAV type {name}", { name }) }, options)];
  });
  const known = [...groupsOf(catalogue).values()].flat();
  for (const camera of known)
    choices.set(camera.key, { camera: cameraOf(camera), request: { camera_key: camera.key } });
  return { options: [...own, ...optionsOf(catalogue)], choices };
}

/**
 * The value of the first camera that reaches a ground sample distance from the clearance on; null where none does.
 *
 * @param {ReadonlyMap<string, Pick<Choice, "camera">>} choices
 * @param {Pick<ViewPlan, "gsd_mm" | "clearance_m">} plan
 */
export function firstThatReaches(choices, { gsd_mm, clearance_m }) {
  for (const [value, { camera }] of choices)
    if (standoff_m(camera, gsd_mm) > Math.max(clearance_m, camera.nearest_focus_m ?? 0)) return value;
  return null;
}
