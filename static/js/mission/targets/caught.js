/** What a box or a lasso has found: its groups, and which of it is chosen. Values in, values out. */

import { countedByKind } from "../../domain/counted.js";
import { t, tn } from "../../text.js";
import { keyOf } from "../selection.js";

/** @import { PickedAsset } from "../../api_types.d.ts" */
/** @import { PickedTarget } from "../types.d.ts" */

/** @typedef {"kind" | "line" | "voltage"} GroupName */
/** @typedef {{ key: string, words: string, count: number }} Group */

/** @type {Record<string, () => string>} */
const KINDS = {
  tower: () => t("Towers"),
  bridge: () => t("Bridges"),
  line: () => t("Lines"),
  railway: () => t("Railways"),
};

/** @type {Record<GroupName, (row: PickedAsset) => string>} the group that a row is in; empty: in none */
const IN = {
  kind: ({ kind }) => `kind ${kind}`,
  line: ({ line }) => (line === null ? "" : `line ${line}`),
  voltage: ({ kind, voltage_v }) => (kind === "tower" || kind === "line" ? `voltage ${voltage_v ?? ""}` : ""),
};

/** @type {Record<GroupName, (row: PickedAsset) => string>} */
const WORDS = {
  kind: ({ kind }) => KINDS[kind]?.() ?? kind,
  line: ({ detail, label }) => detail || label,
  voltage: ({ voltage_v }) => (voltage_v ? `${voltage_v / 1000}\u00a0kV` : t("voltage not stated")),
};

/** @type {GroupName[]} */
const NAMES = ["kind", "line", "voltage"];

/**
 * Rows that are not picked yet, and how many towers stand on lines that are picked whole, or in parts that begin or end near them.
 *
 * @param {PickedAsset[]} rows
 * @param {PickedTarget[]} targets
 */
export function notPickedYet(rows, targets) {
  const keys = new Set(targets.map(({ key }) => key));
  const lines = new Set(
    targets.filter(({ kind, position, stretch }) => kind === "line" && !position && !stretch).map(({ asset }) => asset),
  );
  if (areLines(rows)) return { rows: rows.filter(({ id }) => !lines.has(id)), covered: 0 };
  const fresh = rows.filter(({ id }) => !keys.has(keyOf({ asset: id, position: null, stretch: null })));
  const boxes = partBoxes(targets);
  const kept = fresh.filter(
    ({ line, centre }) =>
      line === null || !(lines.has(line) || (boxes.get(line) ?? []).some((box) => isIn(box, centre))),
  );
  return { rows: kept, covered: fresh.length - kept.length };
}

const PART_MARGIN_DEG = 0.0005; // a part bends a little between its ends

/** The boxes round the ends of picked parts, by line. @param {PickedTarget[]} targets */
function partBoxes(targets) {
  /** @type {Map<number, number[][]>} */
  const boxes = new Map();
  for (const { asset, kind, stretch } of targets)
    if (kind === "line" && asset !== null && stretch) {
      const [west, east] = [Math.min(stretch[0][0], stretch[1][0]), Math.max(stretch[0][0], stretch[1][0])];
      const [south, north] = [Math.min(stretch[0][1], stretch[1][1]), Math.max(stretch[0][1], stretch[1][1])];
      const box = [west - PART_MARGIN_DEG, south - PART_MARGIN_DEG, east + PART_MARGIN_DEG, north + PART_MARGIN_DEG];
      boxes.set(asset, [...(boxes.get(asset) ?? []), box]);
    }
  return boxes;
}

/** @param {number[]} box @param {readonly number[]} place */
const isIn = ([west, south, east, north], [longitude, latitude]) =>
  west <= longitude && longitude <= east && south <= latitude && latitude <= north;

/**
 * The groups to choose by, where there are several; the largest first.
 *
 * @param {PickedAsset[]} rows
 * @returns {[GroupName, Group[]][]}
 */
export function groupsOf(rows) {
  return NAMES.map((name) => /** @type {[GroupName, Group[]]} */ ([name, groupsBy(name, rows)])).filter(
    ([, groups]) => groups.length > 1,
  );
}

/** @param {GroupName} name @param {PickedAsset[]} rows @returns {Group[]} */
function groupsBy(name, rows) {
  /** @type {Map<string, Group>} */
  const groups = new Map();
  for (const row of rows) {
    const key = IN[name](row);
    if (!key) continue;
    const group = groups.get(key) ?? { key, words: WORDS[name](row), count: 0 };
    groups.set(key, { ...group, count: group.count + 1 });
  }
  return [...groups.values()].sort((a, b) => b.count - a.count);
}

/** Rows in none of the groups that are off. @param {PickedAsset[]} rows @param {Set<string>} off */
export const rowsWithout = (rows, off) => rows.filter((row) => NAMES.every((name) => !off.has(IN[name](row))));

/** The lines that the towers carry, and those among the rows. @param {PickedAsset[]} rows */
export const linesOf = (rows) => [
  ...new Set(
    rows.flatMap(({ id, kind, line }) => (kind === "line" ? [id] : kind === "tower" && line !== null ? [line] : [])),
  ),
];

/** Whether lines alone were found: an area with more towers than can be named. @param {PickedAsset[]} rows */
export const areLines = (rows) => rows.length > 0 && rows.every(({ kind }) => kind === "line");

/** "142 towers on 5 lines, 16 bridges". @param {PickedAsset[]} rows */
export function caughtWords(rows) {
  const towers = rows.filter(({ kind }) => kind === "tower");
  const lines = linesOf(towers).length;
  if (!lines) return countedByKind(rows);
  const onLines = t("{towers} on {lines}", {
    towers: countedByKind(towers),
    lines: tn(lines, "{count} line", "{count} lines"),
  });
  const others = countedByKind(rows.filter(({ kind }) => kind !== "tower"));
  return [onLines, others].filter(Boolean).join(", ");
}
