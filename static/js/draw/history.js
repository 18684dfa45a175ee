/** Undo and redo of a value, without limit. */

export function createSteps(first) {
  const past = [];
  let future = [];
  let now = first;
  const isSame = (a, b) => JSON.stringify(a) === JSON.stringify(b);
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
    /** One step, unless it changes nothing. */
    take(value) {
      if (isSame(value, now)) return false;
      past.push(now);
      future = [];
      now = value;
      return true;
    },
    /** Another value for the step that is under way, such as a drag that goes on. */
    amend(value) {
      now = value;
    },
    undo() {
      if (!past.length) return false;
      future.push(now);
      now = past.pop();
      return true;
    },
    redo() {
      if (!future.length) return false;
      past.push(now);
      now = future.pop();
      return true;
    },
  };
}
