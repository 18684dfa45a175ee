/** Towns of the world by name, without a service: Natural Earth's populated places, read with the first search. */

import { staticAddress } from "../static_address.js";
import { locale } from "../text.js";

/** @import { Box, FoundPlace } from "./types.d.ts" */

/**
 * Name, "German|Spanish|French" or "", longitude and latitude in UNITS_PER_DEG, country (ISO 3166) or "".
 *
 * @typedef {[string, string, number, number, string]} PackedPlace
 */

const UNITS_PER_DEG = 100; // of scripts/development/place_names.py
const LANGUAGES = ["de", "es", "fr"];
const MIN_LETTERS = 2;
const TOWN_DEG = 0.1; // from its middle to the edge of what is shown

/** @type {Promise<PackedPlace[]> | null} */
let places = null;

/** The places, largest first; none where they cannot be read. */
function placesKnown() {
  places ??= fetch(staticAddress("data/places.json"))
    .then((answer) => (answer.ok ? answer.json() : Promise.reject(new Error(answer.statusText))))
    .then((found) => (Array.isArray(found) ? found : []))
    .catch(() => {
      places = null; // read again with the next search
      return [];
    });
  return places;
}

/** Letters without case and accents. @param {string} text */
const plain = (text) => text.normalize("NFD").replace(/\p{M}/gu, "").toLowerCase();

/**
 * Places whose name begins with the text, then those with a later word that does; of each the largest first.
 *
 * @param {readonly PackedPlace[]} known largest first
 * @param {string} text
 * @param {number} most
 */
export function matching(known, text, most) {
  const wanted = plain(text.trim());
  if (wanted.length < MIN_LETTERS) return [];
  /** @type {PackedPlace[]} */
  const first = [];
  /** @type {PackedPlace[]} */
  const later = [];
  for (const place of known) {
    const names = [place[0], ...place[1].split("|")].map(plain);
    if (names.some((name) => name.startsWith(wanted))) first.push(place);
    else if (names.some((name) => name.includes(` ${wanted}`) || name.includes(`-${wanted}`))) later.push(place);
    if (first.length === most) break;
  }
  return [...first, ...later].slice(0, most);
}

/** @param {string} code of ISO 3166 */
function countryName(code) {
  try {
    return (code && new Intl.DisplayNames([locale], { type: "region" }).of(code)) || "";
  } catch {
    return "";
  }
}

/** The name in a language. @param {PackedPlace} place @param {string} language */
export const nameIn = ([name, others], language) => others.split("|")[LANGUAGES.indexOf(language)] || name;

/** @param {number} longitude @param {number} latitude @returns {Box} */
const boxOfTown = (longitude, latitude) => [
  longitude - TOWN_DEG,
  latitude - TOWN_DEG,
  longitude + TOWN_DEG,
  latitude + TOWN_DEG,
];

/** @param {string} text @param {number} most @returns {Promise<FoundPlace[]>} */
export async function townsFound(text, most) {
  return matching(await placesKnown(), text, most).map((place) => ({
    icon: "map-pin",
    isTown: true,
    label: nameIn(place, locale),
    detail: countryName(place[4]),
    box: boxOfTown(place[2] / UNITS_PER_DEG, place[3] / UNITS_PER_DEG),
  }));
}
