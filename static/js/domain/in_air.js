/** Whether a UAV is in the air by its reports and its link: true, false, or null where neither states it. */

import { isOnItsWay } from "./flying.js";

/** @import { LiveLink, LiveMission, LiveUav, Measured } from "../api_types.d.ts" */

const RECEIVED_WITHIN_MS = 3_600_000;

/**
 * Whether a UAV is in the air. A flight that its link knows to be over is over, even without such a report.
 *
 * @param {{ measured?: Pick<Measured, "is_in_air"> | null, link?: Pick<LiveLink, "is_in_air"> | null }} uav
 */
export const inAir = ({ measured, link }) =>
  link?.is_in_air === false ? false : (measured?.is_in_air ?? link?.is_in_air ?? null);

/** @param {Pick<LiveUav, "link">} uav @param {number} now_ms */
const wasReceived = ({ link }, now_ms) =>
  link?.last_message_at ? now_ms - Date.parse(link.last_message_at) < RECEIVED_WITHIN_MS : false;

/**
 * UAVs that can receive commands: on a mission in progress unless known to stand on the ground, or still in the air after it if a message
 * arrived within the hour.
 *
 * @param {{ uavs: LiveUav[], missions: LiveMission[], now_ms: number }} live
 */
export function flyingUavs({ uavs, missions, now_ms }) {
  const onItsWay = new Set(missions.filter(isOnItsWay).map(({ id }) => id));
  return uavs.filter((uav) =>
    uav.mission !== null && onItsWay.has(uav.mission)
      ? inAir(uav) !== false
      : inAir(uav) === true && wasReceived(uav, now_ms),
  );
}
