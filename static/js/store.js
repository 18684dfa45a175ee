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

/** Undo and redo over one name of the store, back to the beginning. `changeTo` is one step; equal values make none. */
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
      past.push(current);
      future = [];
      show(value);
      return true;
    },
    undo() {
      if (!past.length) return false;
      future.push(store.state[name]);
      show(past.pop());
      return true;
    },
    redo() {
      if (!future.length) return false;
      past.push(store.state[name]);
      show(future.pop());
      return true;
    },
    /** The same step in other words, as the server has stored it: what went before can still be undone. */
    settle(value) {
      show(value);
    },
    /** Each step with what somebody else has changed meanwhile: undo takes back one's own steps alone. */
    rebase(change) {
      past = past.map(change);
      future = future.map(change);
      show(change(store.state[name]));
    },
    /** A new beginning: what is loaded from the server cannot be undone. */
    startFrom(value) {
      past = [];
      future = [];
      show(value);
    },
  };
}
