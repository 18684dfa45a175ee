/** What a live page shows, by kind and id, kept by the server's words. */

/** @import { Live } from "../api_types.d.ts" */

/** @typedef {{ [Kind in keyof Live]: Map<Live[Kind][number]["id"], Live[Kind][number]> }} Shown */
/** @typedef {{ [Kind in keyof Live]?: Set<number | string> }} Touched ids that came, changed or went */
/** @typedef {Partial<Live> & { removed?: { [Kind in keyof Live]?: (number | string)[] } }} Changes */

/** @type {(keyof Live)[]} */
export const KINDS = ["uavs", "missions", "alerts", "commands", "offers"];

/** The kinds of a live page as one loop sees them. @typedef {Record<keyof Live, Map<number | string, { id: number | string }>>} AnyShown */

export const nothingShown = () => shownAfterSnapshot({});

/** State after a snapshot: { uavs: [{ id, … }], … } → state to show. @param {Partial<Live>} live */
export function shownAfterSnapshot(live) {
  const entries = KINDS.map((kind) => [kind, new Map((live[kind] ?? []).map((entry) => [entry.id, entry]))]);
  return /** @type {Shown} */ (Object.fromEntries(entries));
}

/**
 * Apply changes to the state shown. Returns the ids that were added, changed or removed, by kind.
 * @param {Shown} shown @param {Changes} changes
 */
export function applyChanges(shown, changes) {
  const all = /** @type {AnyShown} */ (/** @type {unknown} */ (shown));
  /** @type {Touched} */
  const touched = {};
  for (const kind of KINDS) {
    const came = changes[kind] ?? [];
    const removed = changes.removed?.[kind] ?? [];
    for (const entry of came) all[kind].set(entry.id, entry);
    for (const id of removed) all[kind].delete(id);
    touched[kind] = new Set([...came.map(({ id }) => id), ...removed]);
  }
  return touched;
}
