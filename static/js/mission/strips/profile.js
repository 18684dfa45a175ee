/** The flight of one UAV as a profile: terrain, nearby zones, flight height, task points and battery, on the axis of the strips. */

import { post } from "../../api.js";
import { profileOf } from "../../domain/route_profile.js";
import { t } from "../../text.js";
import { heightText } from "../../units.js";
import { passedZones, zoneWords } from "../options/zones_passed.js";
import { staysOf } from "../plan/route_times.js";

/** @import { Profile, Waypoint, ZoneAlong } from "../../api_types.d.ts" */
/** @import { Stay } from "../plan/route_times.js" */
/** @import { ShownRoute } from "../types.d.ts" */
/** @import { PassedZone } from "../options/zones_passed.js" */

/** @typedef {{ at_m: number, ground_m: number | null }} GroundSample */
/** @typedef {ReturnType<typeof groundOf>} GroundUnder */
/** @typedef {{ at_m: number, height_m: number, arrival_s: number | null, battery_percent: number | null }} PathPoint */
/** @typedef {ReturnType<typeof flightOf>} Flight a flight from the side */
/** @typedef {{ low: number, high: number }} Span of the heights that are drawn */

const MIN_SPAN_M = 60; // so that a plain does not look mountainous
const NEAR_ZONE_M = 300;
const MAX_VERTICES = 1_900; // of the server's limit of 2,000
const MAX_STEPS = 600;

/**
 * Every k-th of the positions where there are more than the server accepts; both ends stay.
 *
 * @template Item
 * @param {Item[]} positions
 * @param {number} [most]
 */
export function thinned(positions, most = MAX_VERTICES) {
  const step = Math.ceil((positions.length - 1) / (most - 1));
  if (step <= 1) return positions;
  return positions.filter((_, index) => index % step === 0 || index === positions.length - 1);
}

/**
 * Terrain under routes, requested once for each route: [{ at_m, ground_m or null }], and zones near it; not before the list of routes
 * has been in sight.
 *
 * @param {Promise<unknown>} seen
 * @returns {(route: Pick<ShownRoute, "waypoints" | "length_m">) => Promise<GroundUnder>}
 */
export function createGrounds(seen = Promise.resolve()) {
  /** @type {WeakMap<ShownRoute["waypoints"], Promise<GroundUnder>>} */
  const known = new WeakMap();
  return (route) => {
    const { waypoints, length_m } = route;
    const before = known.get(waypoints);
    if (before) return before;
    const line = thinned(waypoints.map(({ position }) => position));
    const body = { line, step_m: Math.max(5, length_m / MAX_STEPS), near_m: NEAR_ZONE_M };
    const asked = seen
      .then(() => post("/terrain/profile", body))
      .then(({ data }) => groundOf(/** @type {Profile} */ (data), length_m));
    asked.catch(() => known.delete(waypoints)); // requested again the next time
    known.set(waypoints, asked);
    return asked;
  };
}

/**
 * The server's profile, its distances stretched to the route's own length.
 *
 * @param {Pick<Profile, "length_m" | "distance_m" | "ground_amsl_m" | "zones" | "zone_margins">} profile
 * @param {number} length_m
 */
export function groundOf(profile, length_m) {
  const scale = profile.length_m > 0 ? length_m / profile.length_m : 1;
  return {
    samples: profile.distance_m.map((distance, index) => ({
      at_m: distance * scale,
      ground_m: profile.ground_amsl_m[index],
    })),
    zones: profile.zones.map((zone) => ({ ...zone, from_m: zone.from_m * scale, to_m: zone.to_m * scale })),
    zone_margins: profile.zone_margins,
  };
}

/**
 * Heights of the flight above their reference: sea level, or the take-off place where terrain is assumed flat. departs_at of the plan
 * decides which zones are in force.
 *
 * @param {ShownRoute} route
 * @param {GroundUnder | null} ground
 * @param {number | null} [battery_wh]
 * @param {string | null} [departs_at]
 */
export function flightOf(route, ground, battery_wh = null, departs_at = null) {
  const { places, targets } = profileOf(route.waypoints, route.length_m);
  const isFlat = route.waypoints.some(({ altitude_amsl_m }) => altitude_amsl_m === null);
  /** @param {Waypoint} waypoint */
  const heightOf = (waypoint) => (isFlat ? null : waypoint.altitude_amsl_m) ?? waypoint.altitude_relative_m;
  const stays = new Map(staysOf(route).map((stay) => [stay.index, stay]));
  const path = route.waypoints.flatMap((waypoint, index) => {
    /** @type {PathPoint} */
    const point = {
      at_m: places[index],
      height_m: heightOf(waypoint),
      arrival_s: route.arrival_s?.[index] ?? null,
      battery_percent: route.battery_left_percent?.[index] ?? null,
    };
    const stay = stays.get(index);
    if (stay) return [point, afterStay(point, stay, battery_wh)];
    return waypoint.task?.hold_s ? [point, afterStay(point, { stay_s: waypoint.task.hold_s }, null)] : [point];
  });
  /** @type {GroundSample[]} */
  const under = isFlat
    ? [
        { at_m: 0, ground_m: 0 },
        { at_m: route.length_m, ground_m: 0 },
      ]
    : (ground?.samples ?? []);
  const tasks = targets.map(({ target, at }) => ({ target, at_m: at, height_m: heightAt(path, at, "height_m") }));
  const waits = [...stays.values()].map((stay) => ({ ...stay, at_m: places[stay.index] }));
  return {
    isFlat,
    path,
    under,
    tasks,
    waits,
    zones: ground ? passedZones(ground, route, places, departs_at) : [],
    margins: ground?.zone_margins,
    hasBattery: path.some(({ battery_percent }) => battery_percent !== null),
  };
}

/**
 * The same place after a stay: later, and with a battery that is full after a base and fuller after charging.
 *
 * @param {PathPoint} point
 * @param {Pick<Stay, "stay_s"> & Partial<Stay>} stay
 * @param {number | null} battery_wh
 * @returns {PathPoint}
 */
function afterStay(point, { kind, stay_s, charged_wh }, battery_wh) {
  const { arrival_s, battery_percent } = point;
  const gained = kind === "charging" && battery_wh ? ((charged_wh ?? 0) / battery_wh) * 100 : 0;
  const left = battery_percent === null ? null : kind === "base" ? 100 : Math.min(100, battery_percent + gained);
  return { ...point, arrival_s: arrival_s === null ? null : arrival_s + stay_s, battery_percent: left };
}

/**
 * The value of a name at a distance, straight between neighbours; null where one of them is unknown.
 *
 * @template {string} Name
 * @param {({ at_m: number } & Record<Name, number | null>)[]} points
 * @param {number} at_m
 * @param {Name} name
 * @returns {number | null}
 */
export function heightAt(points, at_m, name) {
  if (!points.length) return null;
  const next = points.findIndex((point) => point.at_m >= at_m);
  if (next === 0) return points[0][name];
  if (next < 0) return points[points.length - 1][name];
  const [before, after] = [points[next - 1], points[next]];
  const [from, to] = [before[name], after[name]];
  if (from === null || to === null) return null;
  const share = after.at_m > before.at_m ? (at_m - before.at_m) / (after.at_m - before.at_m) : 1;
  return from + (to - from) * share;
}

/**
 * The figures at a distance: { at_m, height_m, ground_m, above_m, arrival_s, battery_percent, zones }; null where unknown.
 *
 * @param {Flight} flight
 * @param {number} at_m
 */
export function readingAt(flight, at_m) {
  const height_m = heightAt(flight.path, at_m, "height_m");
  const ground_m = heightAt(flight.under, at_m, "ground_m");
  return {
    at_m,
    height_m,
    ground_m,
    above_m: height_m === null || ground_m === null ? null : height_m - ground_m,
    arrival_s: heightAt(flight.path, at_m, "arrival_s"),
    battery_percent: heightAt(flight.path, at_m, "battery_percent"),
    zones: flight.zones.filter(({ from_m, to_m }) => from_m <= at_m && at_m <= to_m),
  };
}

/**
 * Lowest and highest value drawn; a zone without a ceiling does not count.
 *
 * @param {Pick<Flight, "path" | "under">} flight
 */
export function spanOf({ path, under }) {
  const known = [...path.map(({ height_m }) => height_m), ...under.map(({ ground_m }) => ground_m)].filter(
    (height) => height !== null,
  );
  const low = known.reduce((a, b) => Math.min(a, b), Infinity);
  const high = known.reduce((a, b) => Math.max(a, b), -Infinity);
  const room = Math.max(0, MIN_SPAN_M - (high - low));
  return { low, high: high + room + (high - low) * 0.08 };
}

/**
 * The vertical extent of a zone at a place, in the heights of the drawing. An open limit extends to the edge.
 *
 * @param {Pick<PassedZone, "from_m" | "to_m" | "lower_limit" | "upper_limit">} zone
 * @param {Pick<Flight, "under" | "isFlat">} flight
 * @param {Span} span
 */
export function bandOf(zone, flight, span) {
  const ground = heightAt(flight.under, (zone.from_m + zone.to_m) / 2, "ground_m") ?? span.low;
  /** @param {ZoneAlong["lower_limit"]} limit @param {number} otherwise */
  const height = (limit, otherwise) => {
    if (!limit) return otherwise;
    if (limit.reference === "AMSL" || limit.reference === "WGS84") return flight.isFlat ? otherwise : limit.value_m;
    return ground + limit.value_m;
  };
  /** @param {number} value */
  const clip = (value) => Math.min(Math.max(value, span.low), span.high);
  return { from: clip(height(zone.lower_limit, ground)), to: clip(height(zone.upper_limit, span.high)) };
}

/**
 * The whole in a sentence, for those who do not see the drawing.
 *
 * @param {Pick<ShownRoute, "name">} route
 * @param {Pick<Flight, "path" | "zones" | "isFlat">} flight
 */
export function profileSentence(route, flight) {
  const heights = flight.path.map(({ height_m }) => height_m);
  const [low, high] = [Math.min(...heights), Math.max(...heights)].map(heightText);
  const words = flight.isFlat
    ? t("{name} flies {low} to {high} above its take-off; flat ground is assumed.", { name: route.name, low, high })
    : t("{name} flies {low} to {high} above sea level.", { name: route.name, low, high });
  const zones = [...new Set(flight.zones.map(zoneWords))];
  return zones.length ? `${words} ${t("Zones: {zones}.", { zones: zones.join("; ") })}` : words;
}
