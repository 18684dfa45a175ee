/** Relation of zones to a route: obstructing it, at another height, passed by, or out of force when the UAV passes. */

import { isInForce } from "../../domain/zones_in_force.js";
import { t } from "../../text.js";
import { durationText, heightText } from "../../units.js";

/** @import { Route, ZoneAlong, ZoneMargins } from "../../api_types.d.ts" */

/** @typedef {ZoneAlong & { kind: "met" | "apart" | "near" | "asleep" }} PassedZone */

const STEP_MS = 60_000;
const NO_MARGINS = { time_s: 0, height_m: 0, terrain_m: 0 };

/**
 * Each stretch of the ground's zones with `kind`: "met", "apart" (in height), "near" or "asleep". Unknown counts as met.
 *
 * route: of a plan; places: of its waypoints along the route [m]; departs_at: of the plan, null for at any time.
 *
 * @param {{ zones: ZoneAlong[], zone_margins?: ZoneMargins }} ground
 * @param {Pick<Route, "arrival_s" | "waypoints">} route
 * @param {number[]} places
 * @param {string | null} departs_at
 * @returns {PassedZone[]}
 */
export function passedZones({ zones, zone_margins = NO_MARGINS }, route, places, departs_at) {
  return zones.map((zone) => ({ ...zone, kind: kindOf(zone, zone_margins, route, places, departs_at) }));
}

/**
 * @param {ZoneAlong} zone
 * @param {ZoneMargins} margins
 * @param {Pick<Route, "arrival_s" | "waypoints">} route
 * @param {number[]} places
 * @param {string | null} departs_at
 * @returns {PassedZone["kind"]}
 */
function kindOf(zone, margins, route, places, departs_at) {
  if (isAsleep(zone, margins, route, places, departs_at)) return "asleep";
  if (zone.is_crossed === false) return "near";
  return isApart(zone, margins, route, places) ? "apart" : "met";
}

/**
 * The waypoints from the last one before a stretch to the first one after it.
 *
 * @param {Pick<ZoneAlong, "from_m" | "to_m">} zone
 * @param {number[]} places
 */
function around({ from_m, to_m }, places) {
  const first = Math.max(
    0,
    places.findLastIndex((place) => place <= from_m),
  );
  const after = places.findIndex((place) => place >= to_m);
  return [first, after < 0 ? places.length - 1 : after];
}

/**
 * @param {ZoneAlong} zone
 * @param {ZoneMargins} margins
 * @param {Pick<Route, "arrival_s" | "waypoints">} route
 * @param {number[]} places
 * @param {string | null} departs_at
 */
function isAsleep(zone, { time_s }, { arrival_s, waypoints }, places, departs_at) {
  if (!zone.schedule || !departs_at || !arrival_s?.length) return false;
  const [first, last] = around(zone, places);
  const [from_s, to_s] = [arrival_s[first], arrival_s[last]];
  if (typeof from_s !== "number" || typeof to_s !== "number") return false;
  const begin = Date.parse(departs_at);
  const [from, to] = [
    begin + (from_s - time_s) * 1000,
    begin + (to_s + (waypoints[last].task?.hold_s ?? 0) + time_s) * 1000,
  ];
  for (let moment = from; moment < to + STEP_MS; moment += STEP_MS)
    if (isInForce(zone.schedule, Math.min(moment, to), waypoints[first].position) !== false) return false;
  return true;
}

/**
 * @param {ZoneAlong} zone
 * @param {ZoneMargins} margins
 * @param {Pick<Route, "waypoints">} route
 * @param {number[]} places
 */
function isApart({ from_m, to_m, lower_limit, upper_limit }, { height_m, terrain_m }, { waypoints }, places) {
  const [first, last] = around({ from_m, to_m }, places);
  /**
   * Those of the flight there over what a limit counts from; null where they are not known.
   *
   * @param {ZoneAlong["lower_limit"]} limit
   */
  const heightsOver = (limit) => {
    const name = limit?.reference === "AGL" ? "altitude_agl_m" : "altitude_amsl_m";
    if (limit?.reference !== "AGL" && limit?.reference !== "AMSL") return null;
    const known = waypoints.slice(first, last + 1).map((waypoint) => waypoint[name]);
    return known.length && known.every((height) => typeof height === "number") ? known : null;
  };
  const [lower, upper] = [heightsOver(lower_limit), heightsOver(upper_limit)];
  const give_m = height_m + terrain_m;
  return Boolean(
    (lower && lower_limit && Math.max(...lower) + give_m < lower_limit.value_m) ||
      (upper && upper_limit && Math.min(...upper) - give_m > upper_limit.value_m),
  );
}

/** "Airport, passed by". @param {Pick<PassedZone, "name" | "kind">} zone */
export const zoneWords = ({ name, kind }) =>
  ({
    met: t("{zone}, in the way", { zone: name }),
    apart: t("{zone}, at another height", { zone: name }),
    near: t("{zone}, passed by", { zone: name }),
    asleep: t("{zone}, not in force then", { zone: name }),
  })[kind];

/**
 * Legend of the drawn zones: [{ kind, words }], of the kinds that occur.
 *
 * @param {Pick<PassedZone, "kind">[]} zones
 */
export function zoneLegend(zones) {
  /** @type {Record<PassedZone["kind"], string>} */
  const words = {
    met: t("zone in the way"),
    apart: t("zone at another height"),
    near: t("zone passed by, not entered"),
    asleep: t("zone not in force when the UAV comes by"),
  };
  return /** @type {PassedZone["kind"][]} */ (Object.keys(words))
    .filter((kind) => zones.some((zone) => zone.kind === kind))
    .map((kind) => ({ kind, words: words[kind] }));
}

/**
 * Margins of zones in time and height; empty without any.
 *
 * @param {Pick<ZoneMargins, "time_s" | "height_m">} [margins]
 */
export function marginWords({ time_s, height_m } = NO_MARGINS) {
  if (time_s > 0 && height_m > 0)
    return t("Zones count {time} before and after their times and {height} below and above their limits.", {
      time: durationText(time_s),
      height: heightText(height_m),
    });
  if (time_s > 0) return t("Zones count {time} before and after their times.", { time: durationText(time_s) });
  return height_m > 0 ? t("Zones count {height} below and above their limits.", { height: heightText(height_m) }) : "";
}
