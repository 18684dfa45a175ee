/** The cameras of a UAV type: pixels, focal lengths, what they give, and where the figures come from. */

import { ApiError } from "../api.js";
import { MAX_CAMERAS } from "../cameras/cameras_field.js";
import { readCatalogue, sourcesList } from "../cameras/catalogue.js";
import { focalText, pixelsText, reachText } from "../cameras/words.js";
import { h, setChildren } from "../dom.js";
import { t } from "../text.js";

/** @import { CatalogueCamera, ReportedCamera } from "../api_types.d.ts" */
/** @import { FleetType } from "./types.d.ts" */

/** @typedef {{ [Figure in keyof ReportedCamera]: NonNullable<ReportedCamera[Figure]> }} Reported a camera with all figures */

/** "Z30", or "Z30 (2)" where that is taken. @param {string} name @param {Set<string>} taken in lower case */
function freeName(name, taken) {
  let [found, number] = [name, 1];
  while (taken.has(found.toLowerCase())) found = `${name} (${++number})`;
  return found;
}

/**
 * The cameras that a UAV of the type reports with all figures, and that are not of the type yet.
 *
 * @param {readonly ReportedCamera[]} reported
 * @param {Pick<FleetType, "cameras">} type
 */
export function camerasToAdd(reported, { cameras }) {
  const taken = new Set(cameras.map(({ name }) => name.toLowerCase()));
  const whole = /** @type {Reported[]} */ (
    reported.filter(
      (own) => !own.is_of_type && own.name && own.focal_length_mm && own.sensor_width_mm && own.pixels_wide,
    )
  );
  return whole.slice(0, MAX_CAMERAS - cameras.length).map((own) => {
    const { focal_length_mm, sensor_width_mm, sensor_height_mm, pixels_wide, pixels_high } = own;
    const name = freeName(own.name, taken);
    taken.add(name.toLowerCase());
    const figures = { sensor_width_mm, sensor_height_mm, pixels_wide, pixels_high };
    return { name, focal_lengths_mm: [focal_length_mm], ...figures };
  });
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
