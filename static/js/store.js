/** What a page knows, who listens, and a history for the part that an operator can take back. */

export function createStore(initial) {
  const listeners = new Set();
  const store = {
    state: Object.freeze({ ...initial }),

    /** Puts new values in and tells those who listen to one of the changed names. */
    update(change) {
      const changed = Object.keys(change).filter((name) => change[name] !== store.state[name]);
      if (!changed.length) return;
      store.state = Object.freeze({ ...store.state, ...change });
      for (const listener of [...listeners]) {
        if (listener.names.some((name) => changed.includes(name))) listener.tell(store.state);
      }
    },

    /** tell(state) is called at once and after each change of one of the names. Returns a function that ends it. */
    listen(names, tell) {
      const listener = { names, tell };
      listeners.add(listener);
      tell(store.state);
      return () => listeners.delete(listener);
    },
  };
  return store;
}

const LONGEST_HISTORY = 100;

/** Undo and redo over one name of the store. `changeTo` is one step; equal values make none. */
export function createHistory(store, name) {
  let past = [];
  let future = [];
  const isSame = (a, b) => a === b || JSON.stringify(a) === JSON.stringify(b);

  function show(value) {
    store.update({ [name]: value, canUndo: past.length > 0, canRedo: future.length > 0 });
  }

  return {
    changeTo(value) {
      const current = store.state[name];
      if (isSame(current, value)) return false;
      past = [...past, current].slice(-LONGEST_HISTORY);
      future = [];
      show(value);
      return true;
    },
    undo() {
      if (!past.length) return false;
      future = [store.state[name], ...future];
      const value = past.at(-1);
      past = past.slice(0, -1);
      show(value);
      return true;
    },
    redo() {
      if (!future.length) return false;
      past = [...past, store.state[name]];
      const [value, ...rest] = future;
      future = rest;
      show(value);
      return true;
    },
    /** The same step in other words, as the server has stored it: what went before can still be undone. */
    settle(value) {
      show(value);
    },
    /** A new beginning: what is loaded from the server cannot be undone. */
    startFrom(value) {
      past = [];
      future = [];
      show(value);
    },
  };
}
