/** Letter and colour of UAVs whose mission is over: kept as long as they fly no other. Values in, values out. */

import { routeNumber } from "../domain/palette.js";

/** @import { LiveMission, LiveUav } from "../api_types.d.ts" */

/** @param {Pick<LiveMission, "ended_at">} mission */
const endedAt_ms = ({ ended_at }) => (ended_at ? Date.parse(ended_at) : Infinity);

/**
 * missions: those on the page, with their UAVs: [{ id, ended_at, uavs: [{ place, uav }], colours }].
 *
 * @param {LiveUav[]} uavs
 * @param {Pick<LiveMission, "id" | "ended_at" | "uavs" | "colours">[]} missions those on the page, with their UAVs
 * @returns {LiveUav[]}
 */
export function placed(uavs, missions) {
  const newest = [...missions].sort((a, b) => endedAt_ms(b) - endedAt_ms(a));
  return uavs.map((uav) => {
    if (uav.mission !== null) return uav;
    const last = newest.find((mission) => mission.uavs.some((entry) => entry.uav === uav.id));
    const entry = last?.uavs.find((one) => one.uav === uav.id);
    if (!last || !entry) return uav;
    const { place } = entry;
    return { ...uav, mission: last.id, place, colour: routeNumber(place, last.colours) };
  });
}

/**
 * UAVs of a page: on that of one mission its own, and those without a mission.
 *
 * @param {LiveUav[]} uavs
 * @param {string | null} mission the only one of the page; null: all
 */
export const ofPage = (uavs, mission) =>
  mission === null ? uavs : uavs.filter((uav) => uav.mission === null || uav.mission === mission);
