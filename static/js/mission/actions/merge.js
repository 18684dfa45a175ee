/** Merge of two users' changes of one mission, part by part. Values in, values out. */

import { t, tn } from "../../text.js";
import { flightOptionsOf } from "../options/flight_options.js";
import { PERFORMANCE, wishesOf } from "../selection.js";
import { areContrary, settled } from "../targets/locks.js";

/** @import { Lock, MissionSelection, PickedTarget, PickedUav, Version } from "../types.d.ts" */

/** Options that each have one value. @param {MissionSelection} selection */
const optionsOf = ({ objective, return_to_start, ...selection }) => ({
  objective,
  return_to_start,
  ...flightOptionsOf(selection),
});
/** @param {unknown} a @param {unknown} b */
const areSameValues = (a, b) => JSON.stringify(a) === JSON.stringify(b);
/** @param {PickedTarget} target */
const keyOfTarget = ({ key }) => key;
/** @param {PickedUav} uav */
const keyOfUav = (uav) => (uav.id === null || uav.id === undefined ? `name ${uav.name}` : `id ${uav.id}`);
/**
 * Without a task a target has its kind's own, which the server writes down: that is the same.
 *
 * @param {PickedTarget} a
 * @param {PickedTarget} b
 */
const isSameTask = (a, b) =>
  (a.task?.speed_mps ?? null) === (b.task?.speed_mps ?? null) &&
  (!a.task ||
    !b.task ||
    (a.task.kind === b.task.kind && (a.task.hold_s ?? b.task.hold_s) === (b.task.hold_s ?? a.task.hold_s)));
/** @param {PickedTarget} a @param {PickedTarget} b */
const isSameTarget = (a, b) => isSameTask(a, b) && JSON.stringify(wishesOf(a)) === JSON.stringify(wishesOf(b));
/** @param {PickedUav} uav */
const uavFacts = ({
  name,
  position,
  max_range_m = null,
  cruise_speed_mps = null,
  end_action,
  most_targets = null,
  sorties = 1,
}) => JSON.stringify([name, position, max_range_m, cruise_speed_mps, end_action, most_targets, sorties ?? 1]);
/**
 * Whether two values are equal. An unset value of a UAV is its type's, which the server fills in.
 *
 * @param {PickedUav} a
 * @param {PickedUav} b
 */
const isSamePerformance = (a, b) =>
  PERFORMANCE.every((fact) => a[fact] === undefined || b[fact] === undefined || a[fact] === b[fact]);
/** @param {PickedUav} a @param {PickedUav} b */
const isSameUav = (a, b) => uavFacts(a) === uavFacts(b) && isSamePerformance(a, b);

/**
 * Items of three lists by their keys: theirs, with my additions, changes and removals.
 *
 * @template Item
 * @param {Item[]} base
 * @param {Item[]} mine
 * @param {Item[]} theirs
 * @param {(item: Item) => string} keyOf
 * @param {(a: Item, b: Item) => boolean} isSame
 */
function mergedList(base, mine, theirs, keyOf, isSame) {
  const [b, m, th] = [base, mine, theirs].map((list) => new Map(list.map((item) => [keyOf(item), item])));
  let isClash = false;
  const list = [];
  for (const [key, their] of th) {
    const [own, old] = [m.get(key), b.get(key)];
    if (!own && old && isSame(their, old)) continue; // removed by me
    if (!own) {
      isClash ||= Boolean(old); // removed here and changed by the other user: it stays
      list.push(their);
    } else if (isSame(own, their) || (old && isSame(own, old))) list.push(their);
    else {
      isClash ||= !old || !isSame(their, old);
      list.push(own);
    }
  }
  for (const [key, own] of m) {
    if (th.has(key)) continue;
    const old = b.get(key);
    if (old && isSame(own, old)) continue; // removed by them
    isClash ||= Boolean(old);
    list.push(own);
  }
  return { list, isClash };
}

/** @param {Pick<MissionSelection, "locks">} selection */
const locksOf = ({ locks }) => locks ?? [];
/** @param {Lock} lock */
const keyOfLock = ({ uav, targets, at_start, at_end }) =>
  JSON.stringify([uav, targets, Boolean(at_start), Boolean(at_end)]);
/** @param {MissionSelection} a @param {MissionSelection} b */
const areSameLocks = (a, b) => locksOf(a).map(keyOfLock).join() === locksOf(b).map(keyOfLock).join();

/**
 * Whether only another UAV than `uav` may fly a target.
 *
 * @param {PickedTarget} target
 * @param {string | null | undefined} uav
 */
const isTiedElsewhere = (target, uav) => ![null, uav].includes(wishesOf(target).uav);

/**
 * Merged locks for the merged targets: theirs, with my locks and unlocks; where no plan can keep both a lock or tie of theirs and one of
 * mine, mine is kept.
 *
 * @param {MissionSelection} base
 * @param {MissionSelection} mine
 * @param {MissionSelection} theirs
 * @param {PickedTarget[]} targets
 */
function mergedLocks(base, mine, theirs, targets) {
  const { list } = mergedList(locksOf(base), locksOf(mine), locksOf(theirs), keyOfLock, () => true);
  const own = new Set(locksOf(mine).map(keyOfLock));
  const held = list.filter((lock) => own.has(keyOfLock(lock)));
  const uavs = new Map(held.flatMap((lock) => lock.targets.map((key) => [key, lock.uav])));
  const free = targets.map((target) =>
    uavs.has(target.key) && isTiedElsewhere(target, uavs.get(target.key)) ? { ...target, uav: null } : target,
  );
  /** @param {Lock} lock */
  const isAgainstTie = (lock) =>
    free.some((target) => lock.targets.includes(target.key) && isTiedElsewhere(target, lock.uav));
  const locks = list.filter(
    (lock) => held.includes(lock) || !(isAgainstTie(lock) || held.some((other) => areContrary(other, lock))),
  );
  return {
    locks,
    targets: free,
    isClash: locks.length < list.length || free.some((target, index) => target !== targets[index]),
  };
}

/**
 * base, mine and theirs are { name, selection }. A part that both changed differently is a clash, and mine is kept.
 *
 * @param {Version} base
 * @param {Version} mine
 * @param {Version} theirs
 */
export function merged(base, mine, theirs) {
  /** @type {string[]} */
  const clashes = [];
  /**
   * @template Value
   * @param {string} part
   * @param {Value} old
   * @param {Value} own
   * @param {Value} their
   */
  const single = (part, old, own, their) => {
    if (areSameValues(own, their) || areSameValues(own, old)) return their;
    if (!areSameValues(their, old)) clashes.push(part);
    return own;
  };
  const name = single("name", base.name, mine.name.trim() || base.name, theirs.name);
  const [old, own, their] = [base.selection, mine.selection, theirs.selection];
  const targets = mergedList(old.targets, own.targets, their.targets, keyOfTarget, isSameTarget);
  if (targets.isClash) clashes.push("targets");
  const uavs = mergedList(old.uavs, own.uavs, their.uavs, keyOfUav, isSameUav);
  if (uavs.isClash) clashes.push("uavs");
  const [oldOptions, ownOptions, theirOptions] = [old, own, their].map(optionsOf);
  const parts = /** @type {(keyof typeof theirOptions)[]} */ (Object.keys(theirOptions));
  const options = /** @type {typeof theirOptions} */ (
    Object.fromEntries(
      parts.map((part) => [part, single(part, oldOptions[part], ownOptions[part], theirOptions[part])]),
    )
  );
  const agreed = mergedLocks(old, own, their, targets.list);
  if (agreed.isClash) clashes.push("locks");
  const selection = { targets: agreed.targets, uavs: uavs.list, ...options, locks: agreed.locks };
  return { name, selection: settled(selection), clashes };
}

/**
 * @template Item
 * @param {Item[]} before
 * @param {Item[]} after
 * @param {(item: Item) => string} keyOf
 * @param {(a: Item, b: Item) => boolean} isSame
 */
function differences(before, after, keyOf, isSame) {
  const [old, now] = [before, after].map((list) => new Map(list.map((item) => [keyOf(item), item])));
  return {
    added: after.filter((item) => !old.has(keyOf(item))),
    removed: before.filter((item) => !now.has(keyOf(item))),
    changed: after.filter((item) => {
      const was = old.get(keyOf(item));
      return was !== undefined && !isSame(item, was);
    }),
  };
}

/** @param {MissionSelection} before @param {MissionSelection} after */
export const targetDifferences = (before, after) =>
  differences(before.targets, after.targets, keyOfTarget, isSameTarget);
/** @param {MissionSelection} before @param {MissionSelection} after */
export const uavDifferences = (before, after) => differences(before.uavs, after.uavs, keyOfUav, isSameUav);

/**
 * Whether two requests are equal; a value that one leaves to the server counts as equal.
 *
 * @param {Version} a
 * @param {Version} b
 */
export function isAlike(a, b) {
  if (
    a.name !== b.name ||
    !areSameValues(optionsOf(a.selection), optionsOf(b.selection)) ||
    !areSameLocks(a.selection, b.selection)
  )
    return false;
  return [targetDifferences(a.selection, b.selection), uavDifferences(a.selection, b.selection)].every((found) =>
    Object.values(found).every((list) => !list.length),
  );
}

/** ["2 targets added", "renamed"]: a user's changes. @param {Version} before @param {Version} after */
export function wordsOfChange(before, after) {
  const words = [];
  if (before.name !== after.name) words.push(t("renamed to “{name}”", { name: after.name }));
  const targets = targetDifferences(before.selection, after.selection);
  if (targets.added.length) words.push(tn(targets.added.length, "{count} target added", "{count} targets added"));
  if (targets.removed.length)
    words.push(tn(targets.removed.length, "{count} target removed", "{count} targets removed"));
  if (targets.changed.length)
    words.push(tn(targets.changed.length, "{count} target changed", "{count} targets changed"));
  const uavs = uavDifferences(before.selection, after.selection);
  if (uavs.added.length) words.push(tn(uavs.added.length, "{count} UAV added", "{count} UAVs added"));
  if (uavs.removed.length) words.push(tn(uavs.removed.length, "{count} UAV removed", "{count} UAVs removed"));
  if (uavs.changed.length) words.push(tn(uavs.changed.length, "{count} UAV changed", "{count} UAVs changed"));
  if (!areSameValues(optionsOf(before.selection), optionsOf(after.selection))) words.push(t("options changed"));
  if (!areSameLocks(before.selection, after.selection)) words.push(t("locks changed"));
  return words;
}
