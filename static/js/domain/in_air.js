/** Whether a UAV is in the air, by what it told and by what its link knows: true, false, or null where nobody has said. */

import { isOnItsWay } from "./flying.js";

const HEARD_WITHIN_MS = 3_600_000;

/** A flight that was told to be over is, though no report has said so. */
export const inAir = ({ measured, link }) =>
  link?.is_in_air === false ? false : (measured?.is_in_air ?? link?.is_in_air ?? null);

const wasHeard = ({ link }, now_ms) => Boolean(link?.heard_at) && now_ms - Date.parse(link.heard_at) < HEARD_WITHIN_MS;

/**
 * UAVs that can be told something: on a mission that is on its way and not known to stand on the ground, or still in the air after it, as
 * far as they were heard within the hour.
 */
export function flyingUavs({ uavs, missions, now_ms }) {
  const onItsWay = new Set(missions.filter(isOnItsWay).map(({ id }) => id));
  return uavs.filter((uav) =>
    onItsWay.has(uav.mission) ? inAir(uav) !== false : inAir(uav) === true && wasHeard(uav, now_ms),
  );
}
