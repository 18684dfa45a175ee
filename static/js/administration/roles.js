/** Roles by name, and as a choice. */

import { h } from "../dom.js";
import { t } from "../text.js";

/** @import { Role } from "../api_types.d.ts" */

/** @type {Record<Role, string>} */
export const ROLES = {
  viewer: t("Viewer"),
  operator: t("Operator|role"),
  curator: t("Curator"),
  administrator: t("Administrator"),
};

/** What each may do, in a few words. @type {Record<Role, string>} */
export const MAY = {
  viewer: t("sees everything, changes nothing"),
  operator: t("plans and flies missions"),
  curator: t("keeps assets, zones and terrain"),
  administrator: t("does everything, and manages users"),
};

/** @param {Role} chosen */
export function roleOptions(chosen) {
  return Object.entries(ROLES).map(([value, words]) => h("option", { value, selected: value === chosen }, words));
}
