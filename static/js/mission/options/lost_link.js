/** Lost-link actions of UAVs, their rally points, and the result of the server's check. Values in, values out. */

import { distance_m } from "../../domain/geodesy.js";
import { rallyName, routeLetter } from "../../domain/palette.js";
import { locale, t, tn } from "../../text.js";
import { durationText, exactHeightText, numberText } from "../../units.js";

/** @import { FailedReturn, LostLinkCheck } from "../../api_types.d.ts" */
/** @import { LostLink, ShownPlan } from "../types.d.ts" */

/** @typedef {Partial<LostLink> | null | undefined} Wish */
/** @typedef {"go-on" | "unplanned" | "unknown" | "waiting" | "home" | "lost"} CheckState */
/**
 * Waypoints of one route whose returns fail for the same reason, with the worst figures.
 *
 * @typedef {object} FailureGroup
 * @property {string} key
 * @property {number} sequence of the route
 * @property {string} letter
 * @property {string} name
 * @property {FailedReturn["return_point"]} return_point
 * @property {FailedReturn["trouble"]} trouble
 * @property {string | null} zone
 * @property {number | null} zone_id
 * @property {number[]} waypoints indices
 * @property {number} missing_wh
 * @property {number} over_m
 */

export const MAX_RALLY_POINTS = 50; // missions/serializers/limits.py
export const MAX_HOLD_S = 3600; // planning/problem.py
const USUAL_HOLD_S = 60;
const MIN_WAY_M = 20; // a shorter one is not seen
const DIGITS = 6; // some 0.1 m

/** @type {{ value: LostLink["behaviour"], words: string, meaning: string }[]} */
export const BEHAVIOURS = [
  {
    value: "go_on",
    words: t("Continue mission"),
    meaning: t("Each UAV flies its route to the end, as it was checked."),
  },
  {
    value: "hold",
    words: t("Hold, then return"),
    meaning: t(
      "Each UAV stays where it is for a while, then flies straight to the nearest of its start and the rally points, and lands.",
    ),
  },
  {
    value: "return",
    words: t("Return"),
    meaning: t("Each UAV flies straight to the nearest of its start and the rally points, and lands."),
  },
];
const GO_ON = "go_on";

/** @param {number[]} position */
const rounded = (position) => position.slice(0, 2).map((degrees) => Number(degrees.toFixed(DIGITS)));

/**
 * One form for equal wishes: null where UAVs go on and no rally point is set; hold_s counts only with "hold".
 *
 * @param {Partial<LostLink> | null | undefined} lost_link
 * @returns {LostLink | null}
 */
export function lostLinkOf(lost_link) {
  const { behaviour = GO_ON, rally_points = [], hold_s = 0 } = lost_link ?? {};
  if (behaviour === GO_ON && !rally_points.length) return null;
  return {
    behaviour,
    rally_points: rally_points.map((position) => position.slice(0, 2)),
    hold_s: behaviour === "hold" ? hold_s : 0,
  };
}

/** The same as one object with all parts. @param {Wish} lost_link @returns {LostLink} */
export const wholeLostLink = (lost_link) => lostLinkOf(lost_link) ?? { behaviour: GO_ON, rally_points: [], hold_s: 0 };

/** @param {Wish} lost_link @param {Partial<LostLink>} values */
const changed = (lost_link, values) => lostLinkOf({ ...wholeLostLink(lost_link), ...values });

/** @param {Wish} lost_link @param {LostLink["behaviour"]} behaviour */
export const withBehaviour = (lost_link, behaviour) =>
  changed(lost_link, { behaviour, hold_s: wholeLostLink(lost_link).hold_s || USUAL_HOLD_S });
/** @param {Wish} lost_link @param {number} hold_s */
export const withHold = (lost_link, hold_s) => changed(lost_link, { hold_s });

/** @param {Wish} lost_link @param {number[]} position */
export function withRallyPoint(lost_link, position) {
  const { rally_points } = wholeLostLink(lost_link);
  return rally_points.length < MAX_RALLY_POINTS
    ? changed(lost_link, { rally_points: [...rally_points, rounded(position)] })
    : lostLinkOf(lost_link);
}

/** @param {Wish} lost_link @param {number} index @param {number[]} position */
export const withRallyPointAt = (lost_link, index, position) =>
  changed(lost_link, {
    rally_points: wholeLostLink(lost_link).rally_points.map((at, place) => (place === index ? rounded(position) : at)),
  });
/** @param {Wish} lost_link @param {number} index */
export const withoutRallyPoint = (lost_link, index) =>
  changed(lost_link, { rally_points: wholeLostLink(lost_link).rally_points.filter((_, place) => place !== index) });

/** Whether UAVs may land at rally points: where they go on, none is used. @param {Wish} lost_link */
export const usesRallyPoints = (lost_link) => wholeLostLink(lost_link).behaviour !== GO_ON;

/** @param {number} hold_s */
const holdText = (hold_s) => (hold_s < 100 ? `${numberText(hold_s)}\u00a0s` : durationText(hold_s));

/** "holds 60 s and returns, 2 rally points". @param {Wish} lost_link */
export function lostLinkText(lost_link) {
  const { behaviour, rally_points, hold_s } = wholeLostLink(lost_link);
  if (behaviour === GO_ON) return t("flies on");
  const does = behaviour === "hold" ? t("holds {time}, then returns", { time: holdText(hold_s) }) : t("returns");
  return rally_points.length
    ? [does, tn(rally_points.length, "{count} rally point", "{count} rally points")].join(", ")
    : does;
}

/** @param {Wish} a @param {Wish} b */
const areSame = (a, b) => JSON.stringify(lostLinkOf(a)) === JSON.stringify(lostLinkOf(b));

/**
 * "go-on", "unplanned", "unknown" (a plan of before), "waiting" (checked for another wish), "home" or "lost".
 *
 * @param {Wish} lost_link
 * @param {ShownPlan | null} plan
 * @param {boolean} isCurrent
 * @returns {CheckState}
 */
export function checkStateOf(lost_link, plan, isCurrent) {
  if (!usesRallyPoints(lost_link)) return "go-on";
  if (!plan || !isCurrent) return "unplanned";
  const check = plan.result.lost_link ?? null;
  if (!check) return "unknown";
  if (!areSame(check, lost_link)) return "waiting";
  return check.failed.length ? "lost" : "home";
}

/** @type {Pick<LostLinkCheck, "failed" | "rally_points" | "rally_points_in_zones" | "highest_m">} */
const NO_CHECK = { failed: [], rally_points: [] };
/** What the server has checked of a plan. @param {ShownPlan} plan */
const checkOf = (plan) => plan.result.lost_link ?? NO_CHECK;

/**
 * Places in a route that do not return.
 *
 * @param {ShownPlan} plan
 */
export function failuresOf(plan) {
  /** @type {Map<string, FailureGroup>} */
  const groups = new Map();
  for (const { route, waypoint, return_point, trouble, missing_wh, zone, zone_id = null, over_m } of checkOf(plan)
    .failed) {
    const key = [route, return_point, trouble, zone_id ?? zone].join("|");
    const group = groups.get(key) ?? {
      key,
      sequence: route,
      letter: routeLetter(route),
      name: plan.result.routes[route]?.uav ?? "",
      return_point,
      trouble,
      zone,
      zone_id,
      waypoints: [],
      missing_wh: 0,
      over_m: 0,
    };
    group.waypoints.push(waypoint);
    group.missing_wh = Math.max(group.missing_wh, missing_wh ?? 0);
    group.over_m = Math.max(group.over_m, over_m ?? 0);
    groups.set(key, group);
  }
  return [...groups.values()];
}

/** "3–9, 12", counted from 1. @param {number[]} waypoints */
export function placesText(waypoints) {
  /** @type {{ from: number, to: number }[]} */
  const runs = [];
  for (const number of [...waypoints].sort((a, b) => a - b)) {
    const last = runs.at(-1);
    if (last && number === last.to + 1) last.to = number;
    else runs.push({ from: number, to: number });
  }
  return runs.map(({ from, to }) => (from === to ? `${from + 1}` : `${from + 1}–${to + 1}`)).join(", ");
}

/** @param {number} return_point */
const returnPointText = (return_point) => (return_point === 0 ? t("its start") : rallyName(return_point - 1));

/** Wh to a tenth: the shortfall may be small. @param {number} missing_wh */
const lackText = (missing_wh) => `${numberText(Math.max(0.1, Math.ceil(missing_wh * 10) / 10), 1)}\u00a0Wh`;

/**
 * The text of a group of failures: { where: "waypoints 3–9, back to R2", why: "up to 12.4 Wh are missing with the reserve kept" }.
 *
 * @param {Pick<FailureGroup, "waypoints" | "return_point" | "trouble" | "zone" | "missing_wh" | "over_m">} group
 */
export function failureText({ waypoints, return_point, trouble, zone, missing_wh, over_m }) {
  const values = { places: placesText(waypoints), returnPoint: returnPointText(return_point) };
  const where =
    waypoints.length === 1
      ? t("waypoint {places}, back to {returnPoint}", values)
      : t("waypoints {places}, back to {returnPoint}", values);
  const isOne = waypoints.length === 1;
  const lack = lackText(missing_wh);
  const why = {
    battery: isOne
      ? t("{energy} are missing with the reserve kept", { energy: lack })
      : t("up to {energy} are missing with the reserve kept", { energy: lack }),
    wind: t("the wind is too strong for the way back"),
    zone: zone ? t("the way back meets {zone}", { zone }) : t("the way back meets a no-fly zone"),
    too_high: t("the way back would be {height} above the greatest allowed height", {
      height: exactHeightText(over_m),
    }),
    obstacle: t(
      "a mast, wires or a bridge is in the way: over it the path would be {height} above the greatest allowed height",
      {
        height: exactHeightText(over_m),
      },
    ),
    unknown_ground: t("the ground under the way back is not known"),
  }[trouble];
  return { where, why };
}

/** @param {ShownPlan} plan */
const flownOf = (plan) => plan.result.routes.filter(({ geometry }) => geometry);

/** UAVs without an energy model: their return may still be too long. @param {ShownPlan} plan */
const uncountedOf = (plan) =>
  flownOf(plan)
    .filter(({ energy_wh }) => energy_wh === null || energy_wh === undefined)
    .map(({ uav }) => uav);

/** The sentence over the check. @param {CheckState} state @param {ShownPlan | null} plan */
export function checkText(state, plan) {
  if (state === "go-on") return "";
  if (state === "unplanned" || !plan) return t("It is checked for energy and zones once there is a plan.");
  if (state === "unknown") return t("This plan was made before this was checked. Plan again to check it.");
  if (state === "waiting") return t("It is being checked for energy and zones.");
  if (state === "lost") {
    const count = new Set(checkOf(plan).failed.map(({ route, waypoint }) => `${route} ${waypoint}`)).size;
    const total = flownOf(plan).reduce((sum, { waypoints }) => sum + waypoints.length, 0);
    return tn(
      count,
      "From {count} of {total} waypoints a UAV would not get home.",
      "From {count} of {total} waypoints a UAV would not get home.",
      { total: total.toLocaleString(locale) },
    );
  }
  return uncountedOf(plan).length === flownOf(plan).length
    ? t("From every waypoint the way back meets no zone.")
    : t("From every waypoint each UAV gets home with its reserve, and meets no zone.");
}

/** The text that names UAVs without a stated battery: unknown returns do not count as safe. @param {ShownPlan} plan */
export function uncountedText(plan) {
  const names = uncountedOf(plan);
  return names.length ? t("Energy is not checked for {uavs}: no battery is stated.", { uavs: names.join(", ") }) : "";
}

/** Rally points inside zones in which no UAV may land, whether or not a UAV would now return to them. @param {ShownPlan} plan */
export function inZonesText(plan) {
  const found = checkOf(plan).rally_points_in_zones ?? [];
  return found
    .map(({ rally_point, zone }) =>
      t("{name} lies inside {zone}: nothing may land there.", {
        name: rallyName(rally_point - 1),
        zone: zone || t("the margin round a no-fly zone"),
      }),
    )
    .join(" ");
}

/**
 * The heights that the check assumes: UAVs must be configured to climb to them. "" for an older check.
 *
 * @param {ShownPlan} plan
 */
export function heightsText(plan) {
  const heights = (checkOf(plan).highest_m ?? []).flatMap((height_m, sequence) =>
    height_m === null ? [] : [{ height_m, uav: plan.result.routes[sequence]?.uav }],
  );
  return heights.length
    ? t("Highest way back, above the start: {heights}.", {
        heights: heights.map(({ uav, height_m }) => `${uav} ${exactHeightText(height_m)}`).join(", "),
      })
    : "";
}

const STAYS_DOWN = ["start", "base"];

/**
 * For the map: [{ from, to }], the ways back that do not fail: from each waypoint in the air to the nearest of the
 * start and the rally points.
 *
 * @param {ShownPlan} plan
 */
export function quietReturnsOf(plan) {
  const { rally_points, failed } = checkOf(plan);
  const fails = new Set(failed.map(({ route, waypoint }) => `${route} ${waypoint}`));
  return plan.result.routes.flatMap(({ waypoints, geometry }, route) => {
    if (!geometry) return [];
    const returnPoints = [waypoints[0].position, ...rally_points];
    /** @param {number[]} from */
    const nearest = (from) =>
      returnPoints.reduce((best, return_point) =>
        distance_m(from, return_point) < distance_m(from, best) ? return_point : best,
      );
    return waypoints
      .filter(({ kind }, index) => !STAYS_DOWN.includes(kind) && !fails.has(`${route} ${index}`))
      .map(({ position }) => ({ from: position, to: nearest(position) }))
      .filter(({ from, to }) => distance_m(from, to) > MIN_WAY_M);
  });
}

/**
 * For the map: [{ key, from, to }], each waypoint that fails and where it would return to; key: of its group.
 *
 * @param {ShownPlan} plan
 */
export function returnLinesOf(plan) {
  const { rally_points } = checkOf(plan);
  return failuresOf(plan).flatMap(({ key, sequence, return_point, waypoints }) => {
    const places = plan.result.routes[sequence]?.waypoints ?? [];
    const to = return_point === 0 ? places[0]?.position : rally_points[return_point - 1];
    if (!to) return [];
    return waypoints
      .filter((waypoint) => places[waypoint])
      .map((waypoint) => ({ key, from: places[waypoint].position, to }));
  });
}
