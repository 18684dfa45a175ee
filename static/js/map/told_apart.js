/** Results of a search that are called alike are told apart by where they are. Values in, values out. */

import { coordinateText } from "../units.js";

/**
 * @template {{ words: string, detail: string, centre?: number[] | null }} Result
 * @param {Result[]} results
 * @returns {Result[]}
 */
export function toldApart(results) {
  /** @param {Result} result */
  const nameOf = ({ words, detail }) => JSON.stringify([words, detail]);
  /** @type {Map<string, number>} */
  const counts = new Map();
  for (const result of results) counts.set(nameOf(result), (counts.get(nameOf(result)) ?? 0) + 1);
  return results.map((result) => {
    if (!result.centre || (counts.get(nameOf(result)) ?? 0) < 2) return result;
    return { ...result, detail: [result.detail, coordinateText(result.centre)].filter(Boolean).join(" · ") };
  });
}
