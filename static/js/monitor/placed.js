/** UAVs whose mission is over keep the letter and colour that they had in it, as long as they fly no other. Values in, values out. */

/** @import { EstimateShape, LiveMission, LiveUav } from "../api_types.d.ts" */

/** @param {Pick<LiveMission, "ended_at">} mission */
const endedAt_ms = ({ ended_at }) => (ended_at ? Date.parse(ended_at) : Infinity);

/**
 * missions: those on the page, with their UAVs: [{ id, ended_at, uavs: [{ place, uav }] }].
 *
 * @param {LiveUav[]} uavs
 * @param {Pick<LiveMission, "id" | "ended_at" | "uavs">[]} missions those on the page, with their UAVs
 * @returns {LiveUav[]}
 */
export function placed(uavs, missions) {
  const newest = [...missions].sort((a, b) => endedAt_ms(b) - endedAt_ms(a));
  return uavs.map((uav) => {
    if (missions.some(({ id }) => id === uav.mission)) return uav;
    const last = newest.find((mission) => mission.uavs.some((entry) => entry.uav === uav.id));
    const entry = last?.uavs.find((one) => one.uav === uav.id);
    if (!last || !entry) return uav;
    return {
      ...uav,
      mission: last.id,
      place: entry.place,
      estimated: uav.mission === null ? uav.estimated : offRoute(uav.estimated),
    };
  });
}

/**
 * What is estimated of it along the route of a mission that is not on the page says nothing here.
 *
 * @param {EstimateShape | null} estimated
 */
const offRoute = (estimated) =>
  estimated && { ...estimated, along_route_m: null, to_go_m: null, arrivals: [], waypoint_sequence: null };
