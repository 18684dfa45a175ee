/** What lies under the map: which raster maps are offered, and which one somebody chose last. */

import { t } from "../text.js";

const KEY = "spanwise.base-map";

const offered = (page) =>
  [
    ["base-map", page.baseMap],
    ["satellite", page.satellite],
  ]
    .filter(([, layer]) => layer.tiles)
    .map(([name]) => name);
const WORDS = { "base-map": t("Map"), satellite: t("Satellite") };

export function underChoices(page) {
  return [{ value: "", words: t("None") }, ...offered(page).map((value) => ({ value, words: WORDS[value] }))];
}

export function rememberedUnder(page) {
  const names = offered(page);
  let remembered = null;
  try {
    remembered = localStorage.getItem(KEY);
  } catch {
    /* storage is closed: the first one offered */
  }
  return remembered === "" || names.includes(remembered) ? remembered : (names[0] ?? "");
}

export function rememberUnder(name) {
  try {
    localStorage.setItem(KEY, name);
  } catch {
    /* storage is closed: the choice lasts as long as the page */
  }
}
