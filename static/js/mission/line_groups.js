/** Targets that stand one after the other on one line, as groups of the list. Values in, values out. */

/** @import { PickedTarget } from "./types.d.ts" */

/** @typedef {{ key: string, line: number, words: string, keys: string[] }} LineGroup `key`: of its first target */

const MIN_TARGETS = 13; // shorter lists are seen whole
const MIN_IN_GROUP = 3;

/** @param {Pick<PickedTarget, "key" | "line" | "detail" | "label">[]} targets in the order of the list @returns {LineGroup[]} */
export function lineGroups(targets) {
  if (targets.length < MIN_TARGETS) return [];
  /** @type {LineGroup[]} */
  const runs = [];
  /** @type {number | null} */
  let before = null;
  for (const { key, line, detail, label } of targets) {
    if (line !== null && line !== undefined) {
      if (line === before) runs.at(-1)?.keys.push(key);
      else runs.push({ key, line, words: detail || label, keys: [key] });
    }
    before = line ?? null;
  }
  return runs.filter(({ keys }) => keys.length >= MIN_IN_GROUP);
}

/**
 * The targets without those that folded groups hide: of each the first stays, which carries the group's head.
 *
 * @template {Pick<PickedTarget, "key">} Target
 * @param {Target[]} targets
 * @param {LineGroup[]} groups
 * @param {(group: LineGroup) => boolean} isFolded
 */
export function withoutFolded(targets, groups, isFolded) {
  const hidden = new Set(groups.filter(isFolded).flatMap(({ keys }) => keys.slice(1)));
  return targets.filter(({ key }) => !hidden.has(key));
}
