/** Figures of cameras in words: pixels, focal lengths, and what a pixel shows from which distance. As in planning/views/camera.py. */

import { t } from "../text.js";
import { exactHeightText, numberText } from "../units.js";

/** @import { Camera, CatalogueCamera, CatalogueSource } from "../api_types.d.ts" */

const SPACE = "\u00a0";
const SHOWN_GSD_MM = 2; // for which a camera's distance is stated: broken strands and split pins are seen
const NOT_VERIFIED = /,?\s*not verified$/;

/** Figures of a camera as sources name them. @type {Record<string, string>} */
export const FIGURES = {
  pixels_wide: t("Pixels across"),
  pixels_high: t("Pixels down"),
  sensor_width_mm: t("Sensor width"),
  sensor_height_mm: t("Sensor height"),
  focal_lengths_mm: t("Focal lengths"),
  min_interval_s: t("Shortest interval between photos"),
  nearest_focus_m: t("Nearest focus"),
  shutter_s: t("Exposure time"),
  gimbal_pitch_min_deg: t("Lowest pitch of the gimbal"),
  gimbal_pitch_max_deg: t("Highest pitch of the gimbal"),
  gimbal_yaw_min_deg: t("Yaw of the gimbal to the left"),
  gimbal_yaw_max_deg: t("Yaw of the gimbal to the right"),
};

/** To a tenth where there is one. @param {number} figure */
const tenths = (figure) => numberText(figure, Number.isInteger(Math.round(figure * 10) / 10) ? 0 : 1);

/** A ground sample distance; in millimetres also for readers of feet. @param {number} gsd_mm */
export const gsdText = (gsd_mm) => `${tenths(gsd_mm)}${SPACE}mm`;

/** @param {Pick<Camera, "pixels_wide" | "pixels_high">} camera */
export const pixelsText = ({ pixels_wide: wide, pixels_high: high }) =>
  `${numberText(wide)}${SPACE}×${SPACE}${numberText(high)}`;

/** "30 mm"; of a zoom its ends. @param {readonly number[]} focal_lengths_mm */
export function focalText(focal_lengths_mm) {
  const ends = [...new Set([focal_lengths_mm[0], focal_lengths_mm[focal_lengths_mm.length - 1]])];
  return `${ends.map(tenths).join("–")}${SPACE}mm`;
}

/** The larger side of a pixel on the sensor [mm]. @param {Camera} camera */
const pixel_mm = (camera) =>
  Math.max(camera.sensor_width_mm / camera.pixels_wide, camera.sensor_height_mm / camera.pixels_high);

/** @param {Camera} camera */
const longest_mm = ({ focal_lengths_mm: steps }) => steps[steps.length - 1];

/** What a pixel shows at this distance with the longest focal length [mm]. @param {Camera} camera @param {number} distance_m */
export const gsdAt_mm = (camera, distance_m) => (1000 * distance_m * pixel_mm(camera)) / longest_mm(camera);

/** The greatest distance at which a pixel shows no more than this [m]. @param {Camera} camera @param {number} gsd_mm */
export const standoff_m = (camera, gsd_mm) => (gsd_mm * longest_mm(camera)) / pixel_mm(camera) / 1000;

/** "2 mm at 14.6 m". @param {Camera} camera */
export const reachText = (camera) =>
  t("{gsd} at {distance}", { gsd: gsdText(SHOWN_GSD_MM), distance: exactHeightText(standoff_m(camera, SHOWN_GSD_MM)) });

/** Pixels, focal lengths and reach in one line. @param {Camera} camera */
export const cameraText = (camera) =>
  [pixelsText(camera), focalText(camera.focal_lengths_mm), reachText(camera), camera.is_thermal && t("thermal")]
    .filter(Boolean)
    .join(" · ");

/** The title of a source without its remark, and whether it is verified. @param {Pick<CatalogueSource, "title">} source */
export const readTitle = ({ title }) => ({
  title: title.replace(NOT_VERIFIED, ""),
  isVerified: !NOT_VERIFIED.test(title),
});

/**
 * The sources of those figures that a camera has as the catalogue states them.
 *
 * @param {Camera} camera
 * @param {CatalogueCamera} known of the catalogue
 */
export function sourcesOf(camera, known) {
  const own = new Map(Object.entries(camera));
  const stated = new Map(Object.entries(known));
  /** @param {string} name */
  const isKept = (name) => JSON.stringify(own.get(name)) === JSON.stringify(stated.get(name));
  return known.sources
    .map((source) => ({ ...source, figures: source.figures.filter(isKept) }))
    .filter(({ figures }) => figures.length > 0);
}
