/** Whether a UAV is in the air, by what it told and by what its link knows: true, false, or null where nobody has said. */

import { isOnItsWay } from "./flying.js";

/** @import { LiveLink, LiveMission, LiveUav, Measured } from "../api_types.d.ts" */

const RECEIVED_WITHIN_MS = 3_600_000;

/**
 * A flight that was told to be over is, though no report has said so.
 *
 * @param {{ measured?: Pick<Measured, "is_in_air"> | null, link?: Pick<LiveLink, "is_in_air"> | null }} uav
 */
export const inAir = ({ measured, link }) =>
  link?.is_in_air === false ? false : (measured?.is_in_air ?? link?.is_in_air ?? null);

/** @param {Pick<LiveUav, "link">} uav @param {number} now_ms */
const wasReceived = ({ link }, now_ms) =>
  link?.last_message_at ? now_ms - Date.parse(link.last_message_at) < RECEIVED_WITHIN_MS : false;

/**
 * UAVs that can be told something: on a mission that is on its way and not known to stand on the ground, or still in the air after it, as
 * far as they were heard within the hour.
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
