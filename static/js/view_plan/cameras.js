/** The choice of a camera for a plan of photos: those of the UAV types first, then the catalogue. */

import { get } from "../api.js";
import { optionsOf, readCatalogue } from "../cameras/catalogue.js";
import { h } from "../dom.js";
import { t } from "../text.js";

/** @import { Answer } from "../api.js" */
/** @import { UavTypePage, ViewPlanInputRequest } from "../api_types.d.ts" */

/** @typedef {Pick<ViewPlanInputRequest, "camera" | "camera_key">} ChosenCamera as a request names it */

const MAX_TYPES = 1000;

/**
 * Returns the options of a select, and what each value stands for in a request. Rejects with ApiError.
 *
 * @param {AbortSignal} signal
 */
export async function readCameras(signal) {
  const [types, catalogue] = await Promise.all([
    get(`/uav-types?limit=${MAX_TYPES}`, { signal }).then((answer) => /** @type {Answer<UavTypePage>} */ (answer).data),
    readCatalogue(),
  ]);
  /** @type {Map<string, ChosenCamera>} */
  const requests = new Map(catalogue.map(({ key }) => [key, { camera_key: key }]));
  const own = types.results.flatMap(({ id, name, cameras = [] }) => {
    if (!cameras.length) return [];
    const options = cameras.map((camera, place) => {
      const value = `type-${id}-${place}`;
      requests.set(value, { camera });
      return h("option", { value }, camera.name);
    });
    return [h("optgroup", { label: t("UAV type {name}", { name }) }, options)];
  });
  return { options: [...own, ...optionsOf(catalogue)], requests };
}
