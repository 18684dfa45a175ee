/** An edit that was not saved outlives the page, in this browser. */

export function createDraft(key) {
  return {
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
        /* storage is closed: nothing was kept */
      }
    },
  };
}
