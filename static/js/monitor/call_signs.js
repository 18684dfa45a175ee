/** What tells UAVs of several missions apart on one page: their letters begin at A in each mission, so the mission's number comes before. Values in, values out. */

import { routeLetter } from "../domain/palette.js";

/** @import { LiveMission, LiveUav } from "../api_types.d.ts" */

/** Numbers of missions on a page of several, from 1. @typedef {Map<string, number>} MissionNumbers */

/**
 * A mission keeps its number as long as the page lives, also when others end; new ones go on behind it, in the order of their starts.
 *
 * @param {MissionNumbers} known
 * @param {Pick<LiveMission, "id" | "name" | "started_at" | "departs_at">[]} missions
 * @returns {MissionNumbers} `known` itself where nothing is new
 */
export function missionNumbers(known, missions) {
  const added = missions.filter(({ id }) => !known.has(id));
  if (added.length === 0) return known;
  /** @param {typeof missions[number]} mission */
  const keyOf = ({ started_at, departs_at, name, id }) => [started_at ?? departs_at ?? "9999", name, id].join("\n");
  added.sort((a, b) => keyOf(a).localeCompare(keyOf(b)));
  return new Map([...known, ...added.map(({ id }, index) => /** @type {const} */ ([id, known.size + index + 1]))]);
}

/** "2" before the letters of the second mission; empty while there was only one. @param {string | null} mission @param {MissionNumbers} numbers */
export const prefixOf = (mission, numbers) =>
  numbers.size > 1 && mission !== null && numbers.has(mission) ? `${numbers.get(mission)}` : "";

/** "B", or "2B" on a page of several missions; empty for one that flies none. @param {Pick<LiveUav, "mission" | "place">} uav @param {MissionNumbers} numbers */
export const letterOf = ({ mission, place }, numbers) =>
  place === null ? "" : `${prefixOf(mission, numbers)}${routeLetter(place)}`;
