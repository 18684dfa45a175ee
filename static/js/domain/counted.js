/** How many there are of each kind of map data or target, in words. Values in, values out. */

import { tn } from "../text.js";

/** @type {Record<string, (count: number) => string>} in the order in which they are told */
const WORDS = {
  tower: (count) => tn(count, "{count} tower", "{count} towers"),
  line: (count) => tn(count, "{count} line", "{count} lines"),
  railway: (count) => tn(count, "{count} railway", "{count} railways"),
  bridge: (count) => tn(count, "{count} bridge", "{count} bridges"),
  place: (count) => tn(count, "{count} place", "{count} places"),
  zone: (count) => tn(count, "{count} zone", "{count} zones"),
  terrain: (count) => tn(count, "{count} terrain model", "{count} terrain models"),
};

/** "488 towers, 31 lines"; empty where there is none. @param {Record<string, number>} counts by kind */
export const countedText = (counts) =>
  Object.entries(WORDS)
    .flatMap(([kind, words]) => (counts[kind] > 0 ? [words(counts[kind])] : []))
    .join(", ");

/** "142 towers, 16 bridges". @param {{ kind: string }[]} things */
export function countedByKind(things) {
  /** @type {Record<string, number>} */
  const counts = {};
  for (const { kind } of things) counts[kind] = (counts[kind] ?? 0) + 1;
  return countedText(counts);
}
