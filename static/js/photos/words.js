/** Words of photos and findings. */

import { t } from "../text.js";

/** @type {Record<string, string>} how it is known what a photo shows */
export const PLACEMENTS = {
  waiting: t("Not read yet"),
  stated: t("Stated with the upload"),
  captured: t("By the UAV's report"),
  nearest: t("Nearest target"),
  manual: t("Assigned by hand"),
  unplaced: t("Not assigned"),
};

/** @type {Record<string, string>} */
export const FINDING_STATES = {
  open: t("Open"),
  work_ordered: t("Work ordered"),
  done: t("Done"),
  verified: t("Verified"),
  rejected: t("Rejected"),
};

/** @type {Record<number, string>} */
export const SEVERITIES = { 1: t("Danger"), 2: t("Repair"), 3: t("Watch"), 4: t("No action") };

const UNITS = ["kB", "MB", "GB", "TB"];

/** 12,3 MB; decimal units, as file managers show them. @param {number} bytes @param {(value: number, digits?: number) => string} numberText */
export function sizeText(bytes, numberText) {
  let [value, unit] = [bytes / 1000, 0];
  while (value >= 1000 && unit < UNITS.length - 1) [value, unit] = [value / 1000, unit + 1];
  return `${numberText(value, value < 10 ? 1 : 0)}\u00a0${UNITS[unit]}`;
}
