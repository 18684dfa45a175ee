/** Lines and railways in parts, which UAVs share: as targets, and joined again. Values in, values out. */

import { detailOf, keyOf, targetOf, wishesOf, withTargets } from "../selection.js";
import { isWhole } from "../tasks.js";

/** @import { StretchPart } from "../../api_types.d.ts" */
/** @import { MissionSelection, PickedTarget } from "../types.d.ts" */

/** A part of a line or railway as a target. @param {StretchPart} part @returns {PickedTarget} */
export function targetOfPart({ line, label, stretch, length_m }) {
  const [[west, south], [east, north]] = stretch;
  const centre = Math.abs(east - west) > 180 ? [west, south] : [(west + east) / 2, (south + north) / 2];
  return targetOf({ id: line.id, kind: line.kind, properties: { ...line, label, length_m }, centre, stretch });
}

const PART = /^(.*), km ([\d.]+)–([\d.]+)$/s;

/** The label of the line that a part belongs to: the server calls parts "E402, km 9.8–10.8". @param {string} label */
export const lineOfPart = (label) => PART.exec(label)?.[1] ?? label;

/**
 * The label of several parts of one line: "E402, km 0.0–10.8" where each begins at the end of another, else that of the line.
 *
 * @param {string[]} labels
 */
export function labelOfParts(labels) {
  const extents = labels.map(extentOfPart);
  extents.sort(([a], [b]) => a - b);
  const isWhole = extents.every(([from], at) => at === 0 || from === extents[at - 1][1]);
  const line = lineOfPart(labels[0]);
  return isWhole ? `${line}, km ${extents[0][0].toFixed(1)}–${extents[extents.length - 1][1].toFixed(1)}` : line;
}

/** Whether it is a line or railway from end to end. @param {Pick<PickedTarget, "kind" | "position" | "stretch">} target */
export const isWholeLine = (target) => isWhole(target) && !target.stretch;

/**
 * The selection with parts in place of a target; they get its task and wishes.
 *
 * @param {MissionSelection} selection
 * @param {string} key
 * @param {PickedTarget[]} parts
 * @returns {MissionSelection}
 */
export function withParts(selection, key, parts) {
  const targets = selection.targets.flatMap((target) =>
    target.key === key ? parts.map((part) => ({ ...part, task: target.task, ...wishesOf(target) })) : [target],
  );
  return withTargets({ ...selection, targets: [] }, targets);
}

/**
 * The selection with the parts of a line joined where one begins at the end of another with the same task and wishes: all of them are
 * the whole line.
 *
 * @param {MissionSelection} selection
 * @param {PickedTarget} whole
 * @returns {MissionSelection}
 */
export function withJoinedParts(selection, whole) {
  const parts = selection.targets
    .filter(({ asset, stretch }) => asset === whole.asset && stretch)
    .map((target) => ({ target, extent_km: extentOfPart(target.label) }))
    .sort((a, b) => a.extent_km[0] - b.extent_km[0]);
  /** @type {{ target: PickedTarget, extent_km: number[] }[][]} */
  const runs = [];
  for (const part of parts) {
    const before = runs.at(-1)?.at(-1);
    if (before && before.extent_km[1] === part.extent_km[0] && isAskedAlike(before.target, part.target))
      runs.at(-1)?.push(part);
    else runs.push([part]);
  }
  /** @type {Map<string, PickedTarget>} by the key of the first part of each run */
  const joined = new Map(
    runs.map((run) => [
      run[0].target.key,
      joinedPart(
        run.map(({ target }) => target),
        whole,
      ),
    ]),
  );
  const gone = new Set(parts.map(({ target }) => target.key));
  const targets = selection.targets.flatMap(
    (target) => joined.get(target.key) ?? (gone.has(target.key) ? [] : [target]),
  );
  return withTargets({ ...selection, targets: [] }, targets);
}

/** @param {PickedTarget[]} parts one after the other @param {PickedTarget} whole @returns {PickedTarget} */
function joinedPart(parts, whole) {
  const [first, last] = [parts[0], parts[parts.length - 1]];
  const wishes = { task: first.task, ...wishesOf(first) };
  const label = labelOfParts(parts.map((part) => part.label));
  const isWhole = extentOfPart(label).join() === wholeExtent(whole).join();
  if (isWhole) return { ...whole, ...wishes };
  const stretch = [/** @type {number[][]} */ (first.stretch)[0], /** @type {number[][]} */ (last.stretch)[1]];
  const place = { ...first, ...wishes, stretch, label, detail: detailOf(first.kind, {}, null, stretch) };
  return { ...place, key: keyOf(place) };
}

/** Where along its line a part begins and ends [km]. @param {string} label @returns {number[]} */
const extentOfPart = (label) => PART.exec(label)?.slice(2).map(Number) ?? [Number.NaN, Number.NaN];

/** @param {PickedTarget} whole */
const wholeExtent = (whole) => [0, Number(((whole.length_m ?? Number.NaN) / 1000).toFixed(1))];

/** @param {PickedTarget} a @param {PickedTarget} b */
const isAskedAlike = (a, b) => JSON.stringify([a.task, wishesOf(a)]) === JSON.stringify([b.task, wishesOf(b)]);
