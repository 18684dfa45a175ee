/** Locking targets to UAVs and places in their order: every wish is one step of the history. */

import { toast } from "../../page/toast.js";
import { t, tn } from "../../text.js";
import { withoutLocks } from "../selection.js";
import * as locks from "../targets/locks.js";

/** @import { MissionContext, MissionSelection } from "../types.d.ts" */

/** context: see actions.js. @param {MissionContext} context */
export function createLocking({ store, history, selection, change }) {
  const orders = () => locks.ordersOf(store.state.plan);
  /** @param {string} key */
  const uavOf = (key) => locks.wishedPlace(orders(), selection(), key)?.uav ?? "";
  /** @param {string} key */
  const labelOf = (key) => selection().targets.find((target) => target.key === key)?.label ?? t("Target");
  const undo = { label: t("Undo"), act: () => history.undo() };

  /** @param {MissionSelection} next @param {string} words */
  function wish(next, words) {
    if (!change(next)) return false;
    toast(words, undo);
    return true;
  }

  /** "Tower 4 is locked as target 2 of Kite." @param {string} key */
  function placeWords(key) {
    const place = locks.wishedPlace(orders(), selection(), key);
    return t("{target} is locked as target {number} of {uav}.", {
      target: labelOf(key),
      number: (place?.index ?? 0) + 1,
      uav: place?.uav ?? "",
    });
  }

  /** @param {MissionSelection} next @param {string[]} keys @param {string} uav */
  function placeAs(next, keys, uav) {
    const namesakes = selection().uavs.filter(({ name }) => name === uav).length;
    if (namesakes > 1)
      toast(t("Nothing is locked: {count} UAVs of this mission are called {name}.", { count: namesakes, name: uav }));
    if (namesakes > 1 || !change(next)) return false;
    toast(
      keys.length === 1
        ? placeWords(keys[0])
        : tn(keys.length, "{count} target is locked.", "{count} targets are locked."),
      undo,
    );
    return true;
  }

  return {
    /**
     * Where pills were dropped: index counts the other targets of that UAV.
     *
     * @param {string[]} keys
     * @param {{ uav: string, index: number }} place
     */
    placeTargets: (keys, place) => placeAs(locks.placed(selection(), orders(), keys, place), keys, place.uav),
    /** @param {string} key @param {number} step */
    shiftTarget: (key, step) => placeAs(locks.shifted(selection(), orders(), key, step), [key], uavOf(key)),
    /** @param {string} key */
    lockTarget: (key) => placeAs(locks.lockedHere(selection(), orders(), key), [key], uavOf(key)),
    /** @param {string} key */
    unlockTarget: (key) =>
      wish(locks.unlocked(selection(), key), t("{target} is not locked any more.", { target: labelOf(key) })),
    unlockAll: () => wish(withoutLocks(selection()), t("Nothing is locked any more.")),
    /** uav: a name, or null for any, which a lock does not stand against. @param {string[]} keys @param {string | null} uav */
    tieTargets(keys, uav) {
      const words =
        uav === null
          ? tn(keys.length, "{count} target may be flown by any UAV.", "{count} targets may be flown by any UAV.")
          : tn(keys.length, "{count} target is flown by {uav} alone.", "{count} targets are flown by {uav} alone.", {
              uav,
            });
      const next = locks.tied(selection(), keys, uav);
      return wish(uav === null ? keys.reduce(locks.unlocked, next) : next, words);
    },
  };
}
