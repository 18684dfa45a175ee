/** Targets one after the other on one line, or parts of it, as groups of the list; the head of each stands at the first of its rows. */

import { find, h, icon } from "../../../dom.js";
import { routeNumber } from "../../../domain/palette.js";
import { t, tn } from "../../../text.js";
import { labelOfParts } from "../../targets/line_parts.js";

/** @import { PickedTarget } from "../../types.d.ts" */
/** @import { RowState } from "./row.js" */

/** @typedef {{ key: string, run: string, words: string, keys: string[], isOfParts: boolean }} LineGroup `key`: of its first target, `run`: line and route */
/** @typedef {Map<string, NonNullable<RowState["place"]>>} Places in the plan, by key */

const MIN_TARGETS = 13; // shorter lists are seen whole
const MIN_IN_GROUP = 3;

/**
 * Supports of one line are grouped in long lists, its parts in any.
 *
 * @param {Pick<PickedTarget, "key" | "asset" | "line" | "stretch" | "detail" | "label">[]} targets in the order of the list
 * @param {(key: string) => number | undefined} [routeOf] a group has targets of one route alone
 * @returns {LineGroup[]}
 */
export function lineGroups(targets, routeOf = () => undefined) {
  /** @type {LineGroup[]} */
  const runs = [];
  /** @type {string[][]} of the targets of each run */
  const labels = [];
  let before = "";
  for (const { key, asset, line, stretch, detail, label } of targets) {
    const isOfParts = Boolean(stretch);
    const on = isOfParts ? asset : (line ?? null);
    const run = on === null ? "" : [on, isOfParts, routeOf(key)].join(" ");
    if (run && run === before) {
      runs[runs.length - 1].keys.push(key);
      labels[labels.length - 1].push(label);
    } else if (on !== null) {
      runs.push({ key, run, words: detail || label, keys: [key], isOfParts });
      labels.push([label]);
    }
    before = run;
  }
  const named = runs.map((run, at) => (run.isOfParts ? { ...run, words: labelOfParts(labels[at]) } : run));
  return named.filter(
    ({ keys, isOfParts }) => keys.length >= MIN_IN_GROUP && (isOfParts || targets.length >= MIN_TARGETS),
  );
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
 * The groups of the list, and which of them are folded: those of parts, and of a list longer than `most` all, until the user decides.
 *
 * @param {() => void} changed
 * @param {number} most
 * @param {GroupActs | null} acts null for those who may not change the mission
 */
export function createGroups(changed, most, acts) {
  /** @type {Map<string, LineGroup>} by the key of the first target */
  let groups = new Map();
  /** @type {Map<string, boolean>} by line and route, where the user has decided */
  const folded = new Map();
  let isLong = false;
  /** @param {LineGroup} group */
  const isFolded = ({ run, isOfParts }) => folded.get(run) ?? (isLong || isOfParts);
  return {
    /** @param {PickedTarget[]} all */
    none(all) {
      groups = new Map();
      return all;
    },
    /** @param {PickedTarget[]} all @param {Places} places */
    unfolded(all, places) {
      isLong = all.length > most;
      const found = lineGroups(all, (key) => places.get(key)?.sequence);
      groups = new Map(found.map((group) => [group.key, group]));
      return withoutFolded(all, found, isFolded);
    },
    /** The keys of the folded group whose head stands at a target; null where there is none. @param {PickedTarget} target */
    foldedAt(target) {
      const group = groups.get(target.key);
      return group && isFolded(group) ? group.keys : null;
    },
    /** @param {HTMLElement} row @param {PickedTarget} target @param {Places} places */
    refresh(row, target, places) {
      const group = groups.get(target.key);
      const toggle = () => {
        if (group) folded.set(group.run, !isFolded(group));
        changed();
      };
      refreshGroup(
        row,
        group && {
          ...group,
          isFolded: isFolded(group),
          toggle,
          acts,
          place: places.get(group.key),
        },
      );
    },
  };
}

/**
 * What can be done with all targets of a folded group.
 *
 * @typedef {object} GroupActs
 * @property {(keys: string[]) => void} remove
 * @property {(keys: string[]) => { image: string, word: string, words: string }} taskOf what is done at all of them
 * @property {(keys: string[], opener: HTMLElement) => void} openTask
 */
/** @typedef {LineGroup & { isFolded: boolean, toggle: () => void, acts: GroupActs | null, place: RowState["place"] }} ShownGroup */

/** @param {HTMLElement} row @param {ShownGroup | undefined} group */
function refreshGroup(row, group) {
  const before = row.querySelector(".group-head");
  row.classList.toggle("folded", Boolean(group?.isFolded));
  if (!group?.isFolded) for (const button of row.querySelectorAll(".group-task, .group-remove")) button.remove();
  if (!group) {
    before?.remove();
    return;
  }
  const head = before ?? h("button", { type: "button", class: "group-head" });
  if (!before) {
    head.append(
      icon("chevron-down", "small"),
      h("i", { class: "pill" }),
      h("span", {}),
      h("small", { class: "caption" }),
    );
    row.prepend(head);
  }
  if (group.isFolded && group.acts) refreshActs(row, head, group, group.acts);
  head.setAttribute("aria-expanded", String(!group.isFolded));
  /** @type {HTMLElement} */ (head).onclick = group.toggle;
  find(head, "span").textContent = group.words;
  const pill = find(head, ".pill", HTMLElement);
  pill.hidden = !group.place;
  pill.className = group.place ? `pill route-${routeNumber(group.place.sequence)}` : "pill";
  pill.textContent = group.place?.letter ?? "";
  find(head, "small").textContent = group.isOfParts
    ? tn(group.keys.length, "{count} part", "{count} parts")
    : tn(group.keys.length, "{count} target", "{count} targets");
}

/** @param {HTMLElement} row @param {Element} head @param {ShownGroup} group @param {GroupActs} acts */
function refreshActs(row, head, { keys, words }, acts) {
  if (!row.querySelector(".group-remove")) head.after(taskButton(), removeButton());
  const removing = find(row, ".group-remove", HTMLElement);
  removing.setAttribute("aria-label", t("Remove {name}", { name: words }));
  removing.onclick = () => acts.remove(keys);
  const button = find(row, ".group-task", HTMLElement);
  button.onclick = () => acts.openTask(keys, button);
  const { image, word, words: task } = acts.taskOf(keys);
  const title = t("{task}. Change task, priority", { task });
  button.setAttribute("aria-label", t("Task, priority of {name}: {task}", { name: words, task }));
  if (button.title === title) return;
  button.replaceChildren(icon(image, "small"), h("span", { class: "task-word" }, word));
  button.title = title;
}

const taskButton = () =>
  h("button", { type: "button", class: "task-chip group-task", "aria-haspopup": "true", "aria-expanded": "false" });

const removeButton = () =>
  h(
    "button",
    { type: "button", class: "icon-button tight group-remove", title: t("Remove (Del)") },
    icon("x", "small"),
  );
