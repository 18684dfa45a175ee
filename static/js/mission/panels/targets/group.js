/** Targets that stand one after the other on one line, as groups of the list; the head of each stands at the first of its rows. */

import { find, h, icon } from "../../../dom.js";
import { tn } from "../../../text.js";

/** @import { PickedTarget } from "../../types.d.ts" */

/** @typedef {{ key: string, line: number, words: string, keys: string[] }} LineGroup `key`: of its first target */

const MIN_TARGETS = 13; // shorter lists are seen whole
const MIN_IN_GROUP = 3;

/** @param {Pick<PickedTarget, "key" | "line" | "detail" | "label">[]} targets in the order of the list @returns {LineGroup[]} */
export function lineGroups(targets) {
  if (targets.length < MIN_TARGETS) return [];
  /** @type {LineGroup[]} */
  const runs = [];
  /** @type {number | null} */
  let before = null;
  for (const { key, line, detail, label } of targets) {
    if (line !== null && line !== undefined) {
      if (line === before) runs.at(-1)?.keys.push(key);
      else runs.push({ key, line, words: detail || label, keys: [key] });
    }
    before = line ?? null;
  }
  return runs.filter(({ keys }) => keys.length >= MIN_IN_GROUP);
}

/**
 * The targets without those that folded groups hide: of each the first stays, which carries the group's head.
 *
 * @template {Pick<PickedTarget, "key">} Target
 * @param {Target[]} targets
 * @param {LineGroup[]} groups
 * @param {(group: LineGroup) => boolean} isFolded
 */
export function withoutFolded(targets, groups, isFolded) {
  const hidden = new Set(groups.filter(isFolded).flatMap(({ keys }) => keys.slice(1)));
  return targets.filter(({ key }) => !hidden.has(key));
}

/**
 * The groups of the list, and which of them are folded: of a list longer than `most` all, until the user decides.
 *
 * @param {() => void} changed
 * @param {number} most
 */
export function createGroups(changed, most) {
  /** @type {Map<string, LineGroup>} by the key of the first target */
  let groups = new Map();
  /** @type {Map<number, boolean>} by line, where the user has decided */
  const folded = new Map();
  let isLong = false;
  /** @param {LineGroup} group */
  const isFolded = ({ line }) => folded.get(line) ?? isLong;
  return {
    /** @param {PickedTarget[]} all */
    none(all) {
      groups = new Map();
      return all;
    },
    /** @param {PickedTarget[]} all */
    unfolded(all) {
      isLong = all.length > most;
      const found = lineGroups(all);
      groups = new Map(found.map((group) => [group.key, group]));
      return withoutFolded(all, found, isFolded);
    },
    /** The keys of the folded group whose head stands at a target; null where there is none. @param {PickedTarget} target */
    foldedAt(target) {
      const group = groups.get(target.key);
      return group && isFolded(group) ? group.keys : null;
    },
    /** @param {HTMLElement} row @param {PickedTarget} target */
    refresh(row, target) {
      const group = groups.get(target.key);
      const toggle = () => {
        if (group) folded.set(group.line, !isFolded(group));
        changed();
      };
      refreshGroup(row, group && { ...group, isFolded: isFolded(group), toggle });
    },
  };
}

/** @param {HTMLElement} row @param {(LineGroup & { isFolded: boolean, toggle: () => void }) | undefined} group */
function refreshGroup(row, group) {
  const before = row.querySelector(".group-head");
  row.classList.toggle("folded", Boolean(group?.isFolded));
  if (!group) {
    before?.remove();
    return;
  }
  const head = before ?? h("button", { type: "button", class: "group-head" });
  if (!before) {
    head.append(icon("chevron-down", "small"), h("span", {}), h("small", { class: "caption" }));
    row.prepend(head);
  }
  head.setAttribute("aria-expanded", String(!group.isFolded));
  /** @type {HTMLElement} */ (head).onclick = group.toggle;
  find(head, "span").textContent = group.words;
  find(head, "small").textContent = tn(group.keys.length, "{count} target", "{count} targets");
}
