//** An edit that was not saved outlives the page, in this browser. */

/** @param {string} key in the browser's storage */
export function createDraft(key) {
  return {
    /** Store the draft. Returns whether it was stored. @param {object | null} value */
    keep(value) {
      try {
        localStorage.setItem(key, JSON.stringify({ ...value, kept_at: new Date().toISOString() }));
        return true;
      } catch {
        return false; // storage is closed or full
      }
    },
    read() {
      try {
        return JSON.parse(localStorage.getItem(key) ?? "null");
      } catch {
        return null;
      }
    },
    drop() {
      try {
        localStorage.removeItem(key);
      } catch {
        /* storage is unavailable: no draft */
      }
    },
  };
}
