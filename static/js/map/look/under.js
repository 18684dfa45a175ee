/** The base map: the raster maps offered, and the user's last choice. */

import { t } from "../../text.js";

/** @import { MapPage } from "../types.d.ts" */

const KEY = "spanwise.base-map";
const UNREACHABLE = "spanwise.base-map-unreachable"; // of this tab: no page of it asks again by itself

/** @param {MapPage} page */
const offered = (page) => [...(page.baseMap.tiles ? ["base-map"] : []), ...(page.satellite.tiles ? ["satellite"] : [])];
/** @type {Record<string, string>} */
const WORDS = { "base-map": t("Map"), satellite: t("Satellite") };

/** What a map takes from its page. @param {MapPage} page */
export const optionsOf = (page) => ({
  baseMap: page.baseMap,
  satellite: page.satellite,
  under: rememberedUnder(page),
  extent: page.extent,
  regions: page.regions,
  view: page.view,
});

/** @param {MapPage} page */
export function underChoices(page) {
  return [{ value: "", words: t("None") }, ...offered(page).map((value) => ({ value, words: WORDS[value] }))];
}

/** @param {MapPage} page @returns {string} none where it could not be reached on an earlier page */
export function rememberedUnder(page) {
  const names = offered(page);
  let remembered = null;
  try {
    remembered = localStorage.getItem(KEY);
    if (sessionStorage.getItem(UNREACHABLE) === (remembered ?? names[0])) return "";
  } catch {
    /* storage is closed: the first one offered */
  }
  return remembered !== null && ["", ...names].includes(remembered) ? remembered : (names[0] ?? "");
}

/** Have no page of this tab ask for a base map by itself. @param {string} name */
export function rememberUnreachable(name) {
  try {
    sessionStorage.setItem(UNREACHABLE, name);
  } catch {
    /* storage is closed: the next page asks again */
  }
}

/** @param {string} name */
export function rememberUnder(name) {
  try {
    sessionStorage.removeItem(UNREACHABLE);
    localStorage.setItem(KEY, name);
  } catch {
    /* storage is closed: the choice lasts as long as the page */
  }
}
