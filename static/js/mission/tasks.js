/** What is done at targets, as plain values: the usual tasks, and planned photos. */

/** @import { MissionSelection, PickedTarget, Task, Views } from "./types.d.ts" */

/** Default seconds at a target, as in planning/task.py. */
export const HOLD_S = { look: 5, photo: 10, hold: 30 };
export const MAX_HOLD_S = 3600;
/** Seconds at each planned photo. */
const VIEWS_HOLD_S = 3;

/** Speeds along a line that may be asked for, as in planning/task.py. */
export const INSPECTION_SPEEDS_MPS = [0.5, 50];

/** @typedef {{ kind: Task["kind"], hold_s: number, views?: Views, speed_mps?: number }} WholeTask */

/** @param {Pick<PickedTarget, "kind" | "position">} target */
export function isWhole(target) {
  return (target.kind === "line" || target.kind === "railway") && !target.position;
}

/**
 * The default task of a target: towers and bridges are photographed, lines are filmed in passing.
 *
 * @param {Pick<PickedTarget, "asset" | "kind" | "position">} target
 * @returns {WholeTask}
 */
function usualTask(target) {
  if (target.asset === null) return { kind: "hold", hold_s: 10 };
  if (isWhole(target)) return { kind: "look", hold_s: 0 };
  return target.kind === "tower" || target.kind === "bridge"
    ? { kind: "photo", hold_s: HOLD_S.photo }
    : { kind: "look", hold_s: HOLD_S.look };
}

/** In one order of names: the server keeps another. @param {Views} views @returns {Views} */
const inOrder = ({ pattern = "detail", gsd_mm, min_height_m, camera }) => ({
  ...(pattern === "detail" ? {} : { pattern }),
  gsd_mm,
  min_height_m,
  camera: /** @type {Views["camera"]} */ (Object.fromEntries(Object.entries(camera).sort())),
});

/** @param {Pick<PickedTarget, "asset" | "kind" | "position" | "task">} target @returns {WholeTask} */
export function taskOf(target) {
  if (!target.task) return usualTask(target);
  const { kind, hold_s, views, speed_mps } = target.task;
  if (speed_mps) return { kind, hold_s: hold_s ?? HOLD_S[kind], speed_mps };
  if (views) return { kind, hold_s: hold_s ?? VIEWS_HOLD_S, views: inOrder(views) };
  return { kind, hold_s: hold_s ?? HOLD_S[kind] };
}

/** @param {WholeTask} a @param {WholeTask} b */
const isSameTask = (a, b) =>
  a.kind === b.kind &&
  a.hold_s === b.hold_s &&
  a.speed_mps === b.speed_mps &&
  JSON.stringify(a.views) === JSON.stringify(b.views);

/** @param {PickedTarget} target */
export function isUsualTask(target) {
  return isSameTask(taskOf(target), usualTask(target));
}

/** Whether photos of it can be planned. @param {Pick<PickedTarget, "asset" | "kind">} target */
export const canHaveViews = ({ asset, kind }) => asset !== null && (kind === "tower" || kind === "bridge");

/**
 * Whether it is photographed like this: wires are those of towers.
 *
 * @param {Pick<PickedTarget, "asset" | "kind">} target
 * @param {Pick<Views, "pattern">} views
 */
export const takesViews = (target, { pattern }) =>
  canHaveViews(target) && (pattern !== "spans" || target.kind === "tower");

/**
 * The same targets with another task at some of them; without seconds or speed each keeps its own where the kind stays. A speed is that
 * along a line; null: as the UAV flies.
 *
 * @param {MissionSelection} selection
 * @param {string[]} keys
 * @param {Task} task
 * @returns {MissionSelection}
 */
export function withTask(selection, keys, { kind, hold_s = null, speed_mps }) {
  return changed(selection, keys, (target) => {
    const now = taskOf(target);
    const hasViews = now.views && kind === "photo" && hold_s !== null; // other seconds at each photo
    const seconds = hold_s ?? (now.kind === kind && !now.views ? now.hold_s : HOLD_S[kind]);
    const speed = kind === "look" && isWhole(target) ? (speed_mps === undefined ? now.speed_mps : speed_mps) : null;
    const next = {
      kind,
      hold_s: seconds,
      ...(hasViews ? { views: now.views } : {}),
      ...(speed ? { speed_mps: speed } : {}),
    };
    if (isSameTask(now, next)) return target;
    const task = isSameTask(next, usualTask(target)) ? null : next;
    return now.views && !hasViews ? { ...withoutCamera(target, now.views), task } : { ...target, task };
  });
}

/**
 * The same targets, some of them with planned photos; only a UAV with the camera may fly these.
 *
 * @param {MissionSelection} selection
 * @param {string[]} keys
 * @param {Views} views
 * @returns {MissionSelection}
 */
export function withViews(selection, keys, views) {
  return changed(selection, keys, (target) => {
    if (!takesViews(target, views)) return target;
    const now = taskOf(target);
    const hold_s = now.views ? now.hold_s : VIEWS_HOLD_S;
    return { ...target, task: { kind: "photo", hold_s, views: inOrder(views) }, sensor: views.camera.name };
  });
}

/** @param {PickedTarget} target @param {Views} views @returns {PickedTarget} */
const withoutCamera = (target, { camera }) => (target.sensor === camera.name ? { ...target, sensor: "" } : target);

/**
 * @param {MissionSelection} selection
 * @param {string[]} keys
 * @param {(target: PickedTarget) => PickedTarget} change
 */
function changed(selection, keys, change) {
  const wanted = new Set(keys);
  return {
    ...selection,
    targets: selection.targets.map((target) => (wanted.has(target.key) ? change(target) : target)),
  };
}
