/** Finds categories by what is typed: a name's beginning first, then a word's, then any part. */

/** @import { Category } from "../api_types.d.ts" */

/** @param {readonly Category[]} categories @param {string} typed @returns {Category[]} the best first */
export function categoriesFor(categories, typed) {
  const wanted = fold(typed);
  if (!wanted) return [...categories];
  const ranked = categories.map((category) => ({ category, rank: rankOf(category, wanted) }));
  return ranked
    .filter(({ rank }) => rank < Infinity)
    .sort((one, other) => one.rank - other.rank)
    .map(({ category }) => category);
}

/** @param {Category} category @param {string} wanted */
function rankOf({ name, component_name: component }, wanted) {
  const [of, whole] = [fold(name), fold(`${component} ${name}`)];
  if (of.startsWith(wanted)) return 0;
  if (whole.startsWith(wanted)) return 1;
  if (initialsOf(whole).startsWith(wanted)) return 2;
  if (whole.split(/\s+/).some((word) => word.startsWith(wanted))) return 3;
  return whole.includes(wanted) ? 4 : Infinity;
}

/** @param {string} text */
const initialsOf = (text) =>
  text
    .split(/\s+/)
    .map((word) => word[0])
    .join("");

/** Without case and accents. @param {string} text */
const fold = (text) => text.normalize("NFD").replace(/\p{M}/gu, "").toLowerCase().trim();
