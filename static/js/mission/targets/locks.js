/** Locked parts of routes: runs of targets that one UAV flies in this order, with nothing between. Values in, values
 * out.
 *
 * A lock is { uav: name, targets: [keys, in order], at_start, at_end }; a target is in at most one. Orders are what a
 * plan flies:
 * [{ uav: name, targets: [keys] }].
 */

import { wishesOf, withWishes } from "../selection.js";
import { uavsByName } from "../uavs/mission_uavs.js";

/** @import { FlownOrder, Lock, MissionSelection, PickedTarget, ShownPlan } from "../types.d.ts" */

/** @param {Pick<MissionSelection, "locks">} selection */
const locksOf = (selection) => selection.locks ?? [];
/** @param {Lock} lock */
const isHeldAt = ({ at_start, at_end }) => at_start || at_end;
/** @param {Lock} lock */
const isWholeRoute = ({ at_start, at_end }) => Boolean(at_start && at_end);

/**
 * Whether no plan can keep both: they share a target, claim the same end of a route, or one is a whole route and the other adds to it.
 *
 * @param {Lock} a
 * @param {Lock} b
 */
export function areContrary(a, b) {
  if (a.targets.some((key) => b.targets.includes(key))) return true;
  return (
    a.uav === b.uav &&
    Boolean((a.at_start && b.at_start) || (a.at_end && b.at_end) || isWholeRoute(a) || isWholeRoute(b))
  );
}

/** Whether a lock to this name identifies one UAV. @param {MissionSelection} selection @param {string} uav */
const isOneUav = (selection, uav) => uavsByName(selection).some(({ name }) => name === uav);

/**
 * The order of each UAV's targets in a plan; one that is visited in several pieces appears once.
 *
 * @param {Pick<ShownPlan, "result" | "targets"> | null} plan
 * @returns {FlownOrder[]}
 */
export function ordersOf(plan) {
  if (!plan) return [];
  return plan.result.routes.map((route) => ({
    uav: route.uav,
    targets: [...new Set(route.targets.map((target) => plan.targets[target]?.key).filter(Boolean))],
  }));
}

/** @param {Pick<MissionSelection, "locks">} selection @param {string} key */
export const lockOf = (selection, key) => locksOf(selection).find(({ targets }) => targets.includes(key)) ?? null;

/**
 * The rest of a lock. A single target whose neighbours were removed is no longer locked, unless the run stands at an end of the route.
 *
 * @param {Lock} lock
 * @param {string[]} targets
 * @returns {Lock[]}
 */
function leftOf(lock, targets) {
  if (targets.length === lock.targets.length) return [lock];
  if (!targets.length || (targets.length === 1 && !isHeldAt(lock))) return [];
  return [{ ...lock, targets }];
}

/** @param {Lock[]} locks @param {string[]} keys */
const without = (locks, keys) =>
  locks.flatMap((lock) =>
    leftOf(
      lock,
      lock.targets.filter((key) => !keys.includes(key)),
    ),
  );

/**
 * Locks and ties of existing targets and UAVs; the same selection where none was removed.
 *
 * @param {MissionSelection} selection
 * @returns {MissionSelection}
 */
export function settled(selection) {
  const known = new Set(selection.targets.map(({ key }) => key));
  const names = new Set(selection.uavs.map(({ name }) => name));
  const locks = locksOf(selection)
    .filter(({ uav }) => names.has(uav))
    .flatMap((lock) =>
      leftOf(
        lock,
        lock.targets.filter((key) => known.has(key)),
      ),
    );
  /** @param {PickedTarget} target */
  const isTiedToNobody = (target) => wishesOf(target).uav !== null && !names.has(target.uav ?? "");
  const isSame =
    locks.length === locksOf(selection).length && locks.every((lock, index) => lock === locksOf(selection)[index]);
  if (isSame && !selection.targets.some(isTiedToNobody)) return selection;
  return {
    ...selection,
    locks,
    targets: selection.targets.map((target) => (isTiedToNobody(target) ? { ...target, uav: null } : target)),
  };
}

/**
 * The orders with the locks applied: locked targets stand at their wished place, the rest as planned. One for each of `orders`, at its
 * place, then those of UAVs with locked targets and without a route.
 *
 * @param {FlownOrder[]} orders
 * @param {Lock[]} locks
 * @returns {FlownOrder[]}
 */
export function wishedOrders(orders, locks) {
  const wished = orders.map((order) => ({ ...order }));
  /** @param {Lock} lock */
  const rank = ({ at_start, at_end }) => (at_end ? 2 : at_start ? 1 : 0);
  for (const lock of [...locks].sort((a, b) => rank(a) - rank(b))) {
    const held = new Set(lock.targets);
    let own = wished.find(({ uav }) => uav === lock.uav);
    if (!own) {
      own = { uav: lock.uav, targets: [] };
      wished.push(own);
    }
    const anchor = own.targets.findIndex((key) => held.has(key));
    for (const order of wished) order.targets = order.targets.filter((key) => !held.has(key));
    const rest = own.targets;
    const at = lock.at_start ? 0 : lock.at_end || anchor < 0 ? rest.length : anchor;
    own.targets = [...rest.slice(0, at), ...lock.targets, ...rest.slice(at)];
  }
  return wished;
}

/**
 * The selection after targets are given to a UAV: ties to another UAV are removed, because the later wish counts.
 *
 * @param {MissionSelection} selection
 * @param {string[]} keys
 * @param {string} uav
 */
function untied(selection, keys, uav) {
  /** @param {PickedTarget} target */
  const isTiedElsewhere = (target) => keys.includes(target.key) && wishesOf(target).uav !== null && target.uav !== uav;
  return selection.targets.some(isTiedElsewhere)
    ? selection.targets.map((target) => (isTiedElsewhere(target) ? { ...target, uav: null } : target))
    : selection.targets;
}

/**
 * Locks with one more; a run that was the whole route of its UAV keeps the begin alone, so that there is room.
 *
 * @param {Lock[]} locks
 * @param {Lock} lock
 * @returns {Lock[]}
 */
const withLock = (locks, lock) => [
  ...locks.map((other) => (other.uav === lock.uav && isWholeRoute(other) ? { ...other, at_end: false } : other)),
  lock,
];

/**
 * Keys of the targets that a UAV may fly: still picked, and not tied to another UAV.
 *
 * @param {MissionSelection} selection
 * @param {string} uav
 */
const flyableBy = ({ targets }, uav) =>
  new Set(targets.filter((target) => [null, uav].includes(wishesOf(target).uav)).map(({ key }) => key));

/** @param {FlownOrder[]} orders @param {string} uav */
const orderOf = (orders, uav) => orders.find((order) => order.uav === uav)?.targets ?? [];

/**
 * The place of a target in the orders as wished: { uav, index, last }, or null where no route visits it.
 *
 * @param {FlownOrder[]} orders
 * @param {MissionSelection} selection
 * @param {string} key
 */
export function wishedPlace(orders, selection, key) {
  const order = wishedOrders(orders, locksOf(selection)).find(({ targets }) => targets.includes(key));
  return order ? { uav: order.uav, index: order.targets.indexOf(key), last: order.targets.length - 1 } : null;
}

/**
 * Targets are locked to a UAV, at a place among the others that it flies: between its neighbours there, or at the begin
 * or the end.
 *
 * The same selection where two UAVs have the name.
 *
 * @param {MissionSelection} selection
 * @param {FlownOrder[]} orders
 * @param {string[]} keys
 * @param {{ uav: string, index: number }} place
 * @returns {MissionSelection}
 */
export function placed(selection, orders, keys, { uav, index }) {
  if (!isOneUav(selection, uav)) return selection;
  const locks = without(locksOf(selection), keys);
  const others = orderOf(wishedOrders(orders, locks), uav).filter((key) => !keys.includes(key));
  const at = Math.min(Math.max(0, index), others.length);
  const flyable = flyableBy(selection, uav);
  const before = others.slice(0, at).findLast((key) => flyable.has(key));
  const after = others.slice(at).find((key) => flyable.has(key));
  /** @param {string | undefined} key */
  const runWith = (key) => locks.find((lock) => key !== undefined && lock.uav === uav && lock.targets.includes(key));
  const [left, right] = [runWith(before), runWith(after)];
  const isAlone = before === undefined && after === undefined;
  const lock = {
    uav,
    targets: [...keys],
    at_start: before === undefined && !isAlone,
    at_end: after === undefined && !isAlone,
  };
  const joinsLeft = before !== undefined && (!lock.at_end || left?.at_end);
  const joinsRight = after !== undefined && (!lock.at_start || right?.at_start);
  if (joinsLeft) {
    lock.targets.unshift(...(left ? left.targets.slice(0, left.targets.indexOf(before) + 1) : [before]));
    lock.at_start = Boolean(left?.at_start);
  }
  if (joinsRight) {
    lock.targets.push(...(right ? right.targets.slice(right.targets.indexOf(after)) : [after]));
    lock.at_end = Boolean(right?.at_end);
  }
  const joined = [joinsLeft && left, joinsRight && right];
  return {
    ...selection,
    targets: untied(selection, keys, uav),
    locks: withLock(
      locks.filter((other) => !joined.includes(other)),
      lock,
    ),
  };
}

/**
 * One place earlier (−1) or later (1) in the order of its UAV; the same selection at an end.
 *
 * @param {MissionSelection} selection
 * @param {FlownOrder[]} orders
 * @param {string} key
 * @param {number} step
 * @returns {MissionSelection}
 */
export function shifted(selection, orders, key, step) {
  const place = wishedPlace(orders, selection, key);
  const index = place ? place.index + step : -1;
  return place && index >= 0 && index <= place.last
    ? placed(selection, orders, [key], { uav: place.uav, index })
    : selection;
}

/**
 * Locked where it is flown now.
 *
 * @param {MissionSelection} selection
 * @param {FlownOrder[]} orders
 * @param {string} key
 * @returns {MissionSelection}
 */
export function lockedHere(selection, orders, key) {
  const place = wishedPlace(orders, selection, key);
  return place ? placed(selection, orders, [key], place) : selection;
}

/**
 * Free a target for any UAV and place; the locks before and after it stay.
 *
 * @param {MissionSelection} selection
 * @param {string} key
 * @returns {MissionSelection}
 */
export function unlocked(selection, key) {
  /** @param {Lock} lock */
  const parts = (lock) => {
    const at = lock.targets.indexOf(key);
    if (at < 0) return [lock];
    const [head, tail] = [lock.targets.slice(0, at), lock.targets.slice(at + 1)];
    return [...leftOf({ ...lock, at_end: false }, head), ...leftOf({ ...lock, at_start: false }, tail)];
  };
  return { ...selection, locks: locksOf(selection).flatMap(parts) };
}

/**
 * Tie targets to one UAV; null frees them. Locks to another UAV are removed.
 *
 * @param {MissionSelection} selection
 * @param {string[]} keys
 * @param {string | null} uav
 * @returns {MissionSelection}
 */
export function tied(selection, keys, uav) {
  const elsewhere = keys.filter((key) => uav !== null && ![undefined, uav].includes(lockOf(selection, key)?.uav));
  return elsewhere.reduce(unlocked, withWishes(selection, keys, { uav }));
}

/**
 * Places of targets on the strip of a route with a wished order: [{ target, at, isMoved }], `at` in metres flown. stops: [{ target, at }]
 * as planned. Targets that keep their relative order keep their place; moved ones are placed between their neighbours.
 *
 * @param {{ target: string, at: number }[]} stops
 * @param {string[]} wished
 * @param {number} length_m
 */
export function stopsWished(stops, wished, length_m) {
  const planned = new Map();
  for (const { target, at } of stops) if (!planned.has(target)) planned.set(target, at);
  const kept = longestRising(wished.map((target) => planned.get(target)));
  const result = wished.map((target, index) => ({
    target,
    at: kept.has(index) ? planned.get(target) : null,
    isMoved: !kept.has(index),
  }));
  for (let index = 0; index < result.length; ) {
    if (result[index].at !== null) index += 1;
    else {
      let end = index;
      while (end < result.length && result[end].at === null) end += 1;
      const [from, to] = [index ? result[index - 1].at : 0, result[end]?.at ?? length_m];
      for (let step = index; step < end; step += 1)
        result[step].at = from + ((to - from) * (step - index + 1)) / (end - index + 1);
      index = end;
    }
  }
  return result;
}

/**
 * Indices of the longest rising subsequence of a list, without undefined values.
 *
 * @param {(number | undefined)[]} values
 */
function longestRising(values) {
  const best = values.map(() => ({ length: 0, before: -1 }));
  let last = -1;
  values.forEach((value, index) => {
    if (value === undefined) return;
    best[index].length = 1;
    for (let other = 0; other < index; other += 1) {
      const earlier = values[other];
      if (earlier !== undefined && earlier < value && best[other].length >= best[index].length)
        best[index] = { length: best[other].length + 1, before: other };
    }
    if (last < 0 || best[index].length > best[last].length) last = index;
  });
  const kept = new Set();
  for (let index = last; index >= 0; index = best[index].before) kept.add(index);
  return kept;
}
