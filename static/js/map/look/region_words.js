/** What a region holds, in words. */

import { t, tn } from "../../text.js";

/** @type {Record<string, (count: number) => string>} */
const WORDS = {
  tower: (count) => tn(count, "{count} tower", "{count} towers"),
  line: (count) => tn(count, "{count} line", "{count} lines"),
  railway: (count) => tn(count, "{count} railway", "{count} railways"),
  bridge: (count) => tn(count, "{count} bridge", "{count} bridges"),
  zone: (count) => tn(count, "{count} zone", "{count} zones"),
  terrain: (count) => tn(count, "{count} terrain model", "{count} terrain models"),
};

/** "488 towers, 31 lines". @param {Record<string, number>} counts by kind */
export function countsText(counts) {
  const parts = Object.entries(WORDS).flatMap(([kind, words]) => (counts[kind] ? [words(counts[kind])] : []));
  return parts.length ? parts.join(", ") : t("no assets");
}
