/** Grouping of target pills and UAVs that share one place on the screen, and the labels of groups. Values in, values out. */

import { tn } from "../text.js";

const MAX_RUNS_LENGTH = 8;
const LETTER_PX = 7;
const PADDING_PX = 18;
const MIN_WIDTH_PX = 28;
const HEIGHT_PX = 22;
const DART_PX = 28;
const DART_LETTER_PX = 6;
const DART_HEIGHT_PX = 16;

/**
 * A target's pill at its place on the screen.
 *
 * @typedef {object} Pill
 * @property {string} key
 * @property {string} name
 * @property {number | null} sequence of its UAV; null while it has none
 * @property {string} letter
 * @property {number} number
 * @property {boolean} [isMissed]
 * @property {number} x
 * @property {number} y
 */
/** @typedef {{ id?: unknown, name: string, x: number, y: number }} Dart a UAV that is not of the mission, at its place on the screen */
/**
 * @template Item
 * @typedef {{ members: Item[], x: number, y: number, label: string }} Group
 */

/** How wide a pill with this label is drawn, about. @param {string} label */
export const pillWidth = (label) => Math.max(MIN_WIDTH_PX, label.length * LETTER_PX + PADDING_PX);

/** @param {Pick<Pill, "sequence" | "letter" | "isMissed">} a @param {Pick<Pill, "sequence" | "letter" | "isMissed">} b */
const isSameKind = (a, b) => a.sequence === b.sequence && a.letter === b.letter && a.isMissed === b.isMissed;

/**
 * Groups of pills to draw, given their places on the screen: [{ members, x, y, label }]. Overlapping pills of one UAV are merged.
 *
 * @template {Pill} Item
 * @param {Item[]} pills
 * @returns {Group<Item>[]}
 */
export function mergePills(pills) {
  return merged(pills, groupLabel, (a, b) => isSameKind(a.members[0], b.members[0]) && overlap(a, b));
}

/**
 * Groups of UAVs whose marks or names would overlap: [{ members, x, y, label }]. x is the place of the mark, its label is to the right.
 *
 * @template {Dart} Item
 * @param {Item[]} darts
 * @returns {Group<Item>[]}
 */
export function mergeDarts(darts) {
  return merged(
    darts,
    dartLabel,
    (a, b) => Math.abs(a.y - b.y) < DART_HEIGHT_PX && a.x < b.x + dartWidth(b.label) && b.x < a.x + dartWidth(a.label),
  );
}

/**
 * A group at the place of its first member.
 *
 * @template {{ x: number, y: number }} Item
 * @param {Item[]} items
 * @param {(members: Item[]) => string} labelOf
 * @param {(a: Group<Item>, b: Group<Item>) => boolean} overlaps
 * @returns {Group<Item>[]}
 */
function merged(items, labelOf, overlaps) {
  let groups = items.map((item) => ({ x: item.x, y: item.y, members: [item], label: labelOf([item]) }));
  for (let isMerged = true; isMerged; ) {
    isMerged = false;
    /** @type {typeof groups} */
    const kept = [];
    for (const group of groups) {
      const near = kept.find((other) => overlaps(other, group));
      if (near) {
        near.members.push(...group.members);
        near.label = labelOf(near.members);
        isMerged = true;
      } else kept.push(group);
    }
    groups = kept;
  }
  return groups;
}

/** @param {string} label */
const dartWidth = (label) => DART_PX + label.length * DART_LETTER_PX;
/** @param {Dart[]} members */
const dartLabel = (members) =>
  members.length === 1 ? members[0].name : tn(members.length, "{count} UAV", "{count} UAVs");

/** @param {Group<Pill>} a @param {Group<Pill>} b */
function overlap(a, b) {
  return Math.abs(a.x - b.x) < (pillWidth(a.label) + pillWidth(b.label)) / 2 && Math.abs(a.y - b.y) < HEIGHT_PX;
}

/** @param {Pill[]} members */
function groupLabel(members) {
  const [first] = members;
  if (first.isMissed)
    return members.length === 1 ? "×" : `× ${tn(members.length, "{count} target", "{count} targets")}`;
  return mergedLabel(
    first.letter,
    members.map((pill) => pill.number),
  );
}

/**
 * "C3", "C3–4", "C1, 3–4": letter once, runs with a dash; "C, 12 targets" where that would be long.
 *
 * @param {string} letter
 * @param {number[]} numbers
 */
export function mergedLabel(letter, numbers) {
  /** @type {number[][]} */
  const runs = [];
  for (const number of [...numbers].sort((a, b) => a - b)) {
    const run = runs.at(-1);
    if (run && number === run[run.length - 1] + 1) run.push(number);
    else runs.push([number]);
  }
  const label = letter + runs.map((run) => (run.length > 1 ? `${run[0]}–${run.at(-1)}` : `${run[0]}`)).join(", ");
  if (label.length <= MAX_RUNS_LENGTH) return label;
  return [letter, tn(numbers.length, "{count} target", "{count} targets")].filter(Boolean).join(", ");
}
