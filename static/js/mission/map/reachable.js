/** Which assets the chosen UAVs can inspect, as the server has answered. Values in, values out. */

import { t } from "../../text.js";
import { energyText, lengthText } from "../../units.js";
import { requestOf } from "../selection.js";

/** @import { Reachability } from "../../api_types.d.ts" */
/** @import { MissionSelection, PickedUav } from "../types.d.ts" */

/** "yes", "partly" or "no" as the map draws them; "" is not known. */
export const VERDICTS = ["yes", "partly", "no"];

/**
 * Inputs of the check: UAVs, their ends, departure, conditions. Null without a chosen UAV.
 *
 * @param {MissionSelection} selection
 */
export function questionOf(selection) {
  if (!selection.uavs.length) return null;
  const { targets, locks, objective, ...rest } = requestOf({ ...selection, lost_link: null });
  return rest;
}

/** Place of an id in a sorted list, −1 where it is not in it. @param {number[]} ids @param {number} id */
function placeOf(ids, id) {
  let [low, high] = [0, ids.length - 1];
  while (low <= high) {
    const middle = (low + high) >> 1;
    if (ids[middle] === id) return middle;
    if (ids[middle] < id) low = middle + 1;
    else high = middle - 1;
  }
  return -1;
}

/** @param {Reachability} answer @param {number} id */
export function reachabilityOf({ assets, reasons }, id) {
  const place = placeOf(assets.ids, id);
  if (place < 0) return "";
  const code = assets.code[place];
  if (code === 0) return "yes";
  return reasons[code - 1]?.code === "partly_reachable" ? "partly" : "no";
}

/**
 * The text on one asset; empty where the answer does not contain it. uavs: as in the request.
 *
 * @param {Reachability} answer
 * @param {number} id
 * @param {Pick<PickedUav, "name">[]} uavs
 */
export function reachText({ assets, reasons, flights }, id, uavs) {
  const place = placeOf(assets.ids, id);
  if (place < 0) return "";
  const code = assets.code[place];
  if (code === 0) {
    const name = uavs[flights[assets.flight[place]]?.uav]?.name;
    return name ? t("Can be inspected: {name} has the shortest way.", { name }) : t("Can be inspected.");
  }
  const { code: why, message } = reasons[code - 1];
  if (why === "beyond_range" && assets.missing_m[place] > 0)
    return t("Out of range: {length} are missing at best.", { length: lengthText(assets.missing_m[place]) });
  const lacking_wh = assets.missing_wh?.[place] ?? 0;
  if (why === "beyond_energy" && lacking_wh > 0)
    return t("Out of range: {length} are missing at best.", { length: energyText(lacking_wh) });
  return message;
}
