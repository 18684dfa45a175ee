/** What a live page shows, by kind and id, kept by the server's words. */

export const KINDS = ["uavs", "missions", "alerts", "commands", "offers"];

export const nothingShown = () => Object.fromEntries(KINDS.map((kind) => [kind, new Map()]));

/** Everything anew: { uavs: [{ id, … }], … } → what is shown. */
export function shownAfterSnapshot(live) {
  return Object.fromEntries(KINDS.map((kind) => [kind, new Map((live[kind] ?? []).map((entry) => [entry.id, entry]))]));
}

/** Puts changes into what is shown. Returns the ids that came, changed or went, by kind. */
export function applyChanges(shown, changes) {
  const touched = {};
  for (const kind of KINDS) {
    const came = changes[kind] ?? [];
    const gone = changes.gone?.[kind] ?? [];
    for (const entry of came) shown[kind].set(entry.id, entry);
    for (const id of gone) shown[kind].delete(id);
    touched[kind] = new Set([...came.map(({ id }) => id), ...gone]);
  }
  return touched;
}
