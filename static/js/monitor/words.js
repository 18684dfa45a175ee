/** States of targets in words and images; colour never alone. */

import { t } from "../text.js";

export const TARGET_STATES = {
  pending: { words: t("Pending"), image: "circle-dashed" },
  "in-progress": { words: t("In progress"), image: "loader-circle" },
  complete: { words: t("Complete"), image: "circle-check" },
  skipped: { words: t("Skipped"), image: "circle" },
  failed: { words: t("Failed"), image: "circle-x" },
};

const REASONS = {
  "flight-failed": t("Its flight failed."),
  "not-reached": t("The UAV went past it at a distance."),
  "not-held": t("The UAV did not stay long enough."),
};

/** Why a target was skipped or failed: a known code in words, anything else as it is. */
export const reasonWords = (reason) => REASONS[reason] ?? reason ?? "";

export const MISSION_STATES = {
  draft: t("Draft"),
  planned: t("Planned"),
  approved: t("Approved"),
  dispatched: t("Sent"),
  active: t("Active"),
  completed: t("Completed"),
  aborted: t("Aborted"),
  failed: t("Failed"),
};
