/**
 * A manually edited route: waypoints moved, inserted, removed, with another height or speed. Values in, values out. A point is {
 * position, altitude_agl_m, speed_mps, was, kind, target, isManual }; `was` is its place in the stored route, null where it is new;
 * speed_mps is over ground on the leg that leads to it, null the UAV's own. Start, end and targets stay.
 */

/** @import { HandFaults, HandPoint } from "../types.d.ts" */
/** @import { Route } from "../../api_types.d.ts" */

const DIGITS = 7; // some 0.01 m

/** Only a waypoint between targets may go. @param {Pick<HandPoint, "kind">} point */
export const isFree = ({ kind }) => kind === "pass";

/** @param {number[]} position */
const rounded = (position) => position.map((degrees) => Number(degrees.toFixed(DIGITS)));

/** Whether a leg with a speed leads to the point. @param {Pick<HandPoint, "kind">} point */
export const isFlownTo = ({ kind }) => kind !== "start" && kind !== "base";

/** @param {Pick<Route, "waypoints" | "by_hand" | "speeds_by_hand">} route @returns {HandPoint[]} */
export function pointsOf({ waypoints, by_hand, speeds_by_hand }) {
  const manualEdit = new Set(by_hand ?? []);
  const speeds = new Map((speeds_by_hand ?? []).map(({ waypoint, speed_mps }) => [waypoint, speed_mps]));
  return waypoints.map(({ position, altitude_agl_m, kind, target }, was) => ({
    position,
    altitude_agl_m,
    speed_mps: speeds.get(was) ?? null,
    was,
    kind,
    target,
    isManual: manualEdit.has(was),
  }));
}

/** @param {HandPoint[]} points @param {number} index @param {Partial<HandPoint>} values */
const replaced = (points, index, values) =>
  points.map((point, at) => (at === index ? { ...point, ...values, isManual: true } : point));

/**
 * The same points where one that has to stay would be moved.
 *
 * @param {HandPoint[]} points
 * @param {number} index
 * @param {number[]} position
 */
export function moved(points, index, position) {
  return points[index] && isFree(points[index]) ? replaced(points, index, { position: rounded(position) }) : points;
}

/** @param {HandPoint[]} points @param {number} index @param {number} altitude_agl_m */
export const raised = (points, index, altitude_agl_m) =>
  points[index] && points[index].altitude_agl_m !== altitude_agl_m
    ? replaced(points, index, { altitude_agl_m })
    : points;

/**
 * speed_mps on the leg to a point; null: the UAV's own again.
 *
 * @param {HandPoint[]} points
 * @param {number} index
 * @param {number | null} speed_mps
 */
export const paced = (points, index, speed_mps) =>
  points[index] && isFlownTo(points[index]) && points[index].speed_mps !== speed_mps
    ? replaced(points, index, { speed_mps })
    : points;

/**
 * Insert a point after `index`, as high as the higher of its neighbours, with the leg's speed; in the middle of the leg without
 * `position`.
 *
 * @param {HandPoint[]} points
 * @param {number} index
 * @param {number[] | null} [position]
 * @returns {HandPoint[]}
 */
export function inserted(points, index, position = null) {
  const [before, after] = [points[index], points[index + 1]];
  if (!before || !after) return points;
  const middle = before.position.map((degrees, axis) => (degrees + after.position[axis]) / 2);
  /** @type {HandPoint} */
  const point = {
    position: rounded(position ?? middle),
    altitude_agl_m: Math.max(before.altitude_agl_m, after.altitude_agl_m),
    speed_mps: after.speed_mps,
    was: null,
    kind: "pass",
    target: null,
    isManual: true,
  };
  return [...points.slice(0, index + 1), point, ...points.slice(index + 1)];
}

/** @param {HandPoint[]} points @param {number} index */
export const dropped = (points, index) =>
  points[index] && isFree(points[index]) ? points.filter((_, at) => at !== index) : points;

/**
 * @param {HandPoint} point
 * @param {HandPoint[]} original
 * @returns {point is HandPoint & { was: number }}
 */
function isAtPlace(point, original) {
  if (point.was === null) return false;
  const { altitude_agl_m, position } = original[point.was];
  return point.altitude_agl_m === altitude_agl_m && point.position.every((degrees, axis) => degrees === position[axis]);
}

/** @param {HandPoint & { was: number }} point @param {HandPoint[]} original */
const isAsFast = (point, original) => point.speed_mps === original[point.was].speed_mps;

/**
 * Indices of the legs that differ from the stored route: leg i goes from point i to the next.
 *
 * @param {HandPoint[]} points
 * @param {HandPoint[]} original
 */
export function changedLegs(points, original) {
  return points.slice(1).flatMap((end, index) => {
    const start = points[index];
    const isAsStored =
      isAtPlace(start, original) && isAtPlace(end, original) && isAsFast(end, original) && end.was === start.was + 1;
    return isAsStored ? [] : [index];
  });
}

/**
 * Count of waypoints that differ from the stored ones: moved, higher, reached faster or slower, inserted, removed.
 *
 * @param {HandPoint[]} points
 * @param {HandPoint[]} original
 */
export function changesOf(points, original) {
  const kept = points.filter(({ was }) => was !== null);
  return (
    original.length -
    kept.length +
    points.filter((point) => !isAtPlace(point, original) || !isAsFast(point, original)).length
  );
}

/** The whole route in the form of the API. @param {HandPoint[]} points */
export const bodyOf = (points) => ({
  waypoints: points.map(({ position, altitude_agl_m, was, speed_mps }) => ({
    position,
    altitude_agl_m,
    was,
    speed_mps,
  })),
});

/**
 * The server's faults by place: { points: Map index → words, legs: Map index → words, other: [words] }.
 *
 * @param {unknown} details
 * @returns {HandFaults}
 */
export function faultsOf(details) {
  /** @type {HandFaults} */
  const faults = { points: new Map(), legs: new Map(), other: [] };
  for (const [place, words] of Object.entries(details ?? {})) {
    const text = [words].flat(2).join(" ");
    const [, list, index] = /^(waypoints|legs)\.(\d+)/.exec(place) ?? [];
    if (list === "waypoints") faults.points.set(Number(index), text);
    else if (list === "legs") faults.legs.set(Number(index), text);
    else faults.other.push(text);
  }
  return faults;
}

/**
 * Whether a leg is without faults, its own and those of the points at its ends.
 *
 * @param {HandFaults} faults
 * @param {number} index
 */
export const isLegClear = ({ legs, points }, index) => !legs.has(index) && !points.has(index) && !points.has(index + 1);
