/** State of a page, its listeners, and a history for the part that an operator can undo. */

/**
 * @template {object} State
 * @typedef {object} Store
 * @property {Readonly<State>} state
 * @property {(change: Partial<State>) => void} update Stores new values and notifies listeners of the changed names.
 * @property {(names: (keyof State)[], notify: (state: Readonly<State>) => void) => () => void} listen
 *   notify(state) is called at once and after each change of one of the names. Returns a function that ends it.
 */

/**
 * @template {object} State
 * @param {State} initial
 * @returns {Store<State>}
 */
export function createStore(initial) {
  /** @type {Set<{ names: (keyof State)[], notify: (state: Readonly<State>) => void }>} */
  const listeners = new Set();
  /** @type {Store<State>} */
  const store = {
    state: Object.freeze({ ...initial }),

    update(change) {
      const changed = /** @type {(keyof State)[]} */ (Object.keys(change)).filter(
        (name) => change[name] !== store.state[name],
      );
      if (!changed.length) return;
      store.state = Object.freeze({ ...store.state, ...change });
      for (const listener of [...listeners]) {
        if (listener.names.some((name) => changed.includes(name))) listener.notify(store.state);
      }
    },

    listen(names, notify) {
      const listener = { names, notify };
      listeners.add(listener);
      notify(store.state);
      return () => listeners.delete(listener);
    },
  };
  return store;
}

/**
 * Undo and redo over one name of the store, back to the beginning. `changeTo` is one step; equal values make none.
 *
 * @template {{ canUndo: boolean, canRedo: boolean }} State
 * @template {keyof State} Name
 * @param {Store<State>} store
 * @param {Name} name
 */
export function createHistory(store, name) {
  /** @typedef {State[Name]} Value */
  /** @type {Value[]} */
  let past = [];
  /** @type {Value[]} */
  let future = [];
  /** @param {Value} a @param {Value} b */
  const isSame = (a, b) => a === b || JSON.stringify(a) === JSON.stringify(b);

  /** @param {Value} value */
  function show(value) {
    const change = { [name]: value, canUndo: past.length > 0, canRedo: future.length > 0 };
    store.update(/** @type {Partial<State>} */ (change));
  }

  return {
    /** @param {Value} value @returns {boolean} whether the value differed */
    changeTo(value) {
      const current = store.state[name];
      if (isSame(current, value)) return false;
      past.push(current);
      future = [];
      show(value);
      return true;
    },
    undo() {
      if (!past.length) return false;
      future.push(store.state[name]);
      show(/** @type {Value} */ (past.pop()));
      return true;
    },
    redo() {
      if (!future.length) return false;
      past.push(store.state[name]);
      show(/** @type {Value} */ (future.pop()));
      return true;
    },
    /** Replace the present value by the server's stored form of it: earlier steps can still be undone. @param {Value} value */
    settle(value) {
      show(value);
    },
    /**
     * Apply another user's changes to each step: undo concerns only one's own steps.
     *
     * @param {(value: Value) => Value} change
     */
    rebase(change) {
      past = past.map(change);
      future = future.map(change);
      show(change(store.state[name]));
    },
    /** Start a new history: data loaded from the server cannot be undone. @param {Value} value */
    startFrom(value) {
      past = [];
      future = [];
      show(value);
    },
  };
}
