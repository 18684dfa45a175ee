/** Which targets of the list are chosen: one, several, or a range with Shift. */

/** @import { MissionStore, PickedTarget } from "../../types.d.ts" */

/** @typedef {ReturnType<typeof createChoosing>} Choosing */

/**
 * @param {MissionStore} store
 * @param {{ canPlan: boolean, order: () => string[] }} how the keys as they stand in the list
 */
export function createChoosing(store, { canPlan, order }) {
  let isOn = false; // several are chosen with check boxes
  /** @type {string | null} */
  let anchor = null; // where a range with Shift begins

  /** @param {PickedTarget} target */
  const isChosen = (target) => store.state.chosenTargets.includes(target.key);

  /** @param {string[]} keys */
  function choose(keys) {
    if (canPlan && keys.length > 1) isOn = true;
    store.update({ chosenTargets: keys, chosenTarget: keys.at(-1) ?? null });
  }

  return {
    isChosen,
    choose,
    all: () => choose(order()),
    isOn: () => isOn,
    /** @param {boolean} on */
    turn(on) {
      isOn = on;
    },
    /** This one alone. @param {PickedTarget} target */
    only(target) {
      anchor = target.key;
      choose([target.key]);
    },
    /** @param {PickedTarget} target */
    toggle(target) {
      anchor = target.key;
      const { chosenTargets } = store.state;
      choose(isChosen(target) ? chosenTargets.filter((key) => key !== target.key) : [...chosenTargets, target.key]);
    },
    /**
     * Choose all from the begin of the range, or from `from` where there is none.
     *
     * @param {PickedTarget} target
     * @param {PickedTarget} [from]
     */
    upTo(target, from) {
      if (from) anchor ??= from.key;
      const keys = order();
      const first = Math.max(0, keys.indexOf(anchor ?? target.key));
      const last = keys.indexOf(target.key);
      const range = keys.slice(Math.min(first, last), Math.max(first, last) + 1);
      choose(first <= last ? range : range.reverse());
    },
  };
}
