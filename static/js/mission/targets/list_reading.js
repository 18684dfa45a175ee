/** A pasted list of references: their parsing, and the server's matches for each. */

import { post } from "../../api.js";

/** @import { Answer } from "../../api.js" */
/** @import { LookupOutput, LookupResult } from "../../api_types.d.ts" */

const PER_REQUEST = 2000;
export const MAX_REFS = 10_000;

/**
 * Each reference once, in the order of the list: one a line, or parted by tabs, commas or semicolons; quotes are
 * dropped.
 *
 * @param {string} text
 */
export function refsIn(text) {
  const refs = text.split(/[\n\r\t,;]+/).map((ref) =>
    ref
      .trim()
      .replace(/^(["'])(.*)\1$/, "$2")
      .trim(),
  );
  return [...new Set(refs.filter(Boolean))];
}

/**
 * The references of a list, and by reference the external id for its target. A list whose first line names a column `external_id` is a
 * table: references are in its column `ref`, or in the first of the others.
 *
 * @param {string} text
 * @returns {{ refs: string[], externalIds: Map<string, string> }}
 */
export function listIn(text) {
  const [head, ...lines] = text.replace(/^\uFEFF/, "").split(/[\n\r]+/);
  const sign = ["\t", ";", ","].find((known) => head.includes(known)) ?? ",";
  const names = cellsOf(head, sign).map((name) => name.toLowerCase());
  const ids = names.indexOf("external_id");
  if (ids < 0 || names.length < 2) return { refs: refsIn(text), externalIds: new Map() };
  const named = names.indexOf("ref");
  const refs = named < 0 ? Number(ids === 0) : named;
  const rows = lines.map((line) => cellsOf(line, sign)).filter((cells) => cells[refs]);
  return {
    refs: [...new Set(rows.map((cells) => cells[refs]))],
    externalIds: new Map(rows.filter((cells) => cells[ids]).map((cells) => [cells[refs], cells[ids]])),
  };
}

/** Cells of a line of a table; a sign between quotes does not separate. @param {string} line @param {string} sign */
function cellsOf(line, sign) {
  const cells = line.match(new RegExp(`(?:"(?:[^"]|"")*"|[^${sign}])+|(?<=^|${sign})(?=${sign}|$)`, "g")) ?? [];
  return cells.map((cell) =>
    cell
      .trim()
      .replace(/^"(.*)"$/s, "$1")
      .replaceAll('""', '"')
      .trim(),
  );
}

/**
 * The server's matches of each: [{ ref, match, count, assets }].
 *
 * @param {string[]} refs
 * @param {string[]} kinds
 * @param {AbortSignal} [signal]
 */
export async function lookUp(refs, kinds, signal) {
  /** @type {LookupResult[]} */
  const results = [];
  for (let first = 0; first < refs.length; first += PER_REQUEST) {
    const { data } = /** @type {Answer<LookupOutput>} */ (
      await post("/assets/lookup", { refs: refs.slice(first, first + PER_REQUEST), kinds }, { signal })
    );
    results.push(...data.results);
  }
  return results;
}

/**
 * The rows to add: every reference with one match, and the choice for the others: ref → "all", an id, or nothing.
 * Each with the external id that the list has for its reference.
 *
 * @param {LookupResult[]} results
 * @param {Map<string, string>} choices
 * @param {Map<string, string>} [externalIds]
 */
export function rowsToAdd(results, choices, externalIds = new Map()) {
  return results.flatMap(({ ref, match, assets }) => {
    const choice = match === "found" ? "all" : (choices.get(ref) ?? "");
    const external_id = externalIds.get(ref) ?? "";
    return assets
      .filter((asset) => choice === "all" || String(asset.id) === choice)
      .map((asset) => ({ ...asset, external_id }));
  });
}
