/** Undo and redo of a value, without limit. */

/**
 * @template Value
 * @param {Value} first
 */
export function createSteps(first) {
  /** @type {Value[]} */
  const past = [];
  /** @type {Value[]} */
  let future = [];
  let now = first;
  /** @param {Value} a @param {Value} b */
  const isSame = (a, b) => JSON.stringify(a) === JSON.stringify(b);
  /** @param {Value[]} from @param {Value[]} to */
  function step(from, to) {
    if (!from.length) return false;
    to.push(now);
    now = /** @type {Value} */ (from.pop());
    return true;
  }
  return {
    get value() {
      return now;
    },
    get canUndo() {
      return past.length > 0;
    },
    get canRedo() {
      return future.length > 0;
    },
    /** Add one step, unless it changes nothing. @param {Value} value */
    take(value) {
      if (isSame(value, now)) return false;
      past.push(now);
      future = [];
      now = value;
      return true;
    },
    /** Replace the value of the present step, such as during a drag. @param {Value} value */
    amend(value) {
      now = value;
    },
    undo() {
      return step(past, future);
    },
    redo() {
      return step(future, past);
    },
  };
}
