/** The unsaved selection, kept in this browser until it is saved. */

const keyOf = (mission) => `spanwise.draft.${mission ?? "new"}`;

/** draft: { name, selection, revision } */
export function keepDraft(mission, draft) {
  try {
    localStorage.setItem(keyOf(mission), JSON.stringify({ ...draft, kept_at: new Date().toISOString() }));
    return true;
  } catch {
    return false; // storage is full or closed: leaving the page asks first
  }
}

export function readDraft(mission) {
  try {
    const draft = JSON.parse(localStorage.getItem(keyOf(mission)));
    return Array.isArray(draft?.selection?.targets) && Array.isArray(draft.selection.uavs) ? draft : null;
  } catch {
    return null;
  }
}

export function dropDraft(mission) {
  try {
    localStorage.removeItem(keyOf(mission));
  } catch {
    /* nothing was kept */
  }
}
