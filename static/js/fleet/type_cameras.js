/** The cameras of a UAV type: pixels, focal lengths, what they give, and where the figures come from. */

import { ApiError } from "../api.js";
import { MAX_CAMERAS } from "../cameras/cameras_field.js";
import { readCatalogue, sourcesList } from "../cameras/catalogue.js";
import { focalText, pixelsText, reachText } from "../cameras/words.js";
import { h, setChildren } from "../dom.js";
import { t } from "../text.js";

/** @import { CatalogueCamera, ReportedCamera } from "../api_types.d.ts" */
/** @import { FleetType } from "./types.d.ts" */

/**
 * The cameras that a UAV of the type reports with all figures, and whose figures the type does not have yet.
 *
 * @param {readonly ReportedCamera[]} reported
 * @param {Pick<FleetType, "cameras">} type
 */
export function camerasToAdd(reported, { cameras }) {
  const names = new Set(cameras.map(({ name }) => name.toLowerCase()));
  const found = [];
  for (const { name, focal_length_mm, sensor_width_mm, sensor_height_mm, pixels_wide, pixels_high } of reported) {
    if (!(name && focal_length_mm && sensor_width_mm && sensor_height_mm && pixels_wide && pixels_high)) continue;
    const isKnown = cameras.some((camera) => camera.pixels_wide === pixels_wide && camera.pixels_high === pixels_high);
    if (isKnown || names.has(name.toLowerCase()) || cameras.length + found.length >= MAX_CAMERAS) continue;
    names.add(name.toLowerCase());
    found.push({
      name,
      focal_lengths_mm: [focal_length_mm],
      sensor_width_mm,
      sensor_height_mm,
      pixels_wide,
      pixels_high,
    });
  }
  return found;
}

/** Draws itself into `place`; sources are added once the catalogue is read. @param {HTMLElement} place @param {FleetType} type */
export function mountTypeCameras(place, { cameras }) {
  /** @param {readonly CatalogueCamera[]} catalogue */
  function draw(catalogue) {
    const rows = cameras.map((camera) =>
      h(
        "li",
        {},
        h(
          "div",
          { class: "what" },
          h("strong", { translate: "no" }, camera.name),
          h(
            "span",
            { class: "caption" },
            `${t("{pixels} pixels", { pixels: pixelsText(camera) })} · ${focalText(camera.focal_lengths_mm)}`,
          ),
          sourcesList(camera, catalogue),
        ),
        camera.is_thermal && h("span", { class: "chip" }, t("thermal")),
        h("span", {}, reachText(camera)),
      ),
    );
    setChildren(
      place,
      rows.length
        ? h("ul", { class: "plain-list" }, rows)
        : h("p", { class: "quiet-text" }, t("None stated. Photos are planned with a type's cameras.")),
    );
  }
  draw([]);
  if (cameras.length)
    readCatalogue().then(draw, (error) => {
      if (!(error instanceof ApiError)) throw error; // without the catalogue there are no sources to show
    });
}
