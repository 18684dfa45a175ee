/** A pasted list of references: what is one of them, and what the server found for each. */

import { post } from "../api.js";

/** @import { Answer } from "../api.js" */
/** @import { LookupOutput, LookupResult } from "../api_types.d.ts" */

const PER_REQUEST = 2000;
export const MOST_REFS = 10_000;

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
 * What the server says of each: [{ ref, match, count, assets }].
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
 * The rows to add: every reference with one meaning, and of the others what was chosen: ref → "all", an id, or nothing.
 *
 * @param {LookupResult[]} results
 * @param {Map<string, string>} choices
 */
export function rowsToAdd(results, choices) {
  return results.flatMap(({ ref, match, assets }) => {
    if (match === "found") return assets;
    const choice = choices.get(ref) ?? "";
    return choice === "all" ? assets : assets.filter((asset) => String(asset.id) === choice);
  });
}
