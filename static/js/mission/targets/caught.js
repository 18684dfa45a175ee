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
 * Rows that are not picked yet, and how many towers stand on lines that are picked whole.
 *
 * @param {PickedAsset[]} rows
 * @param {PickedTarget[]} targets
 */
export function notPickedYet(rows, targets) {
  const keys = new Set(targets.map(({ key }) => key));
  const lines = new Set(
    targets.filter(({ kind, position, stretch }) => kind === "line" && !position && !stretch).map(({ asset }) => asset),
  );
  const fresh = rows.filter(({ id }) => !keys.has(keyOf({ asset: id, position: null, stretch: null })));
  const kept = fresh.filter(({ line }) => line === null || !lines.has(line));
  return { rows: kept, covered: fresh.length - kept.length };
}

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

/** The lines that the towers carry. @param {PickedAsset[]} rows */
export const linesOf = (rows) => [
  ...new Set(rows.flatMap(({ kind, line }) => (kind === "tower" && line !== null ? [line] : []))),
];

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
