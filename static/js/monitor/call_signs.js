/**
 * Call signs of UAVs of several missions on one page: letters begin at A in each mission, so the mission's number comes first. Values in,
 * values out.
 */

import { routeLetter } from "../domain/palette.js";

/** @import { LiveMission, LiveUav } from "../api_types.d.ts" */

/** Call numbers of the missions on a page of several, by id. @typedef {Map<string, number>} MissionNumbers */

/**
 * Numbers of missions from the service: every page of the organisation shows the same ones, and no two missions in progress share one.
 *
 * @param {MissionNumbers} known
 * @param {Pick<LiveMission, "id" | "call_number">[]} missions
 * @returns {MissionNumbers} `known` itself where nothing has changed
 */
export function missionNumbers(known, missions) {
  const numbers = new Map(
    missions.flatMap(({ id, call_number }) => (call_number === null ? [] : [/** @type {const} */ ([id, call_number])])),
  );
  const isSame = numbers.size === known.size && [...numbers].every(([id, number]) => known.get(id) === number);
  return isSame ? known : numbers;
}

/** "2" before the letters of the mission with that number; empty while there is only one. @param {string | null} mission @param {MissionNumbers} numbers */
export const prefixOf = (mission, numbers) =>
  numbers.size > 1 && mission !== null && numbers.has(mission) ? `${numbers.get(mission)}` : "";

/** "B", or "2B" on a page of several missions; empty for one that flies none. @param {Pick<LiveUav, "mission" | "place">} uav @param {MissionNumbers} numbers */
export const letterOf = ({ mission, place }, numbers) =>
  place === null ? "" : `${prefixOf(mission, numbers)}${routeLetter(place)}`;
