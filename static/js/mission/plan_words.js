/** What the pages read off a plan's reasons and warnings. */

import { t } from "../text.js";

/** @import { Plan } from "../api_types.d.ts" */

const WALL = /^the \S+ m around a mast or wires that cannot be flown over$/;

/** A zone's name in the reader's language, where it is no name but a description. @param {string} words */
export function zoneOf(words) {
  if (WALL.test(words)) return t("the surroundings of a mast or wires that cannot be flown over");
  return /^the \S+ m around a no-fly zone$/.test(words) ? t("the margin round a no-fly zone") : words;
}

/** Whether a plan leaves the preferred ways for the shortest ones. @param {Pick<Plan, "warnings">} plan */
export const takesShortestWays = ({ warnings }) => (warnings ?? []).some(({ code }) => code === "shortest_ways");
/** What a plan warns of where a UAV stays on the ground. @type {string[]} */
export const GROUNDING = ["uav_inside_zone", "uav_out_of_service"];
