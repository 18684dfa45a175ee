/** What a search may go to that is no asset: coordinates, no-fly zones, bases, UAVs and towns by name. */

import { get } from "../api.js";
import { boxAround } from "../domain/geodesy.js";
import { t } from "../text.js";
import { coordinateText } from "../units.js";
import { positionIn } from "./coordinates_read.js";
import { townsFound } from "./place_names.js";

/** @import { Answer } from "../api.js" */
/** @import { BasePage, ZoneCollection } from "../api_types.d.ts" */
/** @import { Box, FoundPlace, MapLibreMap } from "./types.d.ts" */

/** @typedef {{ name: string, position: number[], icon: string, detail: string }} NamedThing */

const COORDINATES_ZOOM = 15;
const MAX_ZONES = 4;
const MAX_NAMED = 4;
const MAX_TOWNS = 3;

/**
 * The place of typed coordinates, as a list of one or none: [{ icon, label, detail, position, zoom }].
 *
 * @param {string} text
 * @returns {FoundPlace[]}
 */
function coordinatesFound(text) {
  const found = positionIn(text);
  if (!found) return [];
  const orders = {
    letters: t("Coordinates"),
    "latitude first": t("Coordinates, latitude first"),
    "longitude first": t("Coordinates, longitude first: the first figure can be no latitude"),
  };
  return [
    {
      icon: "map-pin",
      label: coordinateText(found.position),
      detail: orders[found.order],
      position: found.position,
      zoom: COORDINATES_ZOOM,
    },
  ];
}

/**
 * Those of [{ name, position, icon, detail }] whose name contains the text; at most four.
 *
 * @param {string} text
 * @param {NamedThing[]} things
 * @returns {FoundPlace[]}
 */
function namedFound(text, things) {
  const wanted = text.trim().toLocaleLowerCase();
  if (!wanted) return [];
  return things
    .filter(({ name }) => name.toLocaleLowerCase().includes(wanted))
    .slice(0, MAX_NAMED)
    .map(({ name, ...rest }) => ({ label: name, zoom: COORDINATES_ZOOM - 1, ...rest }));
}

/**
 * Zones by name: [{ icon, label, detail, box }].
 *
 * @param {string} text
 * @param {AbortSignal} [signal]
 * @returns {Promise<FoundPlace[]>}
 */
async function zonesFound(text, signal) {
  const address = `/zones?text=${encodeURIComponent(text)}&limit=${MAX_ZONES}`;
  const { data } = /** @type {Answer<ZoneCollection>} */ (await get(address, { signal }));
  return data.features.map(({ geometry, properties }) => ({
    icon: "zone",
    label: properties.name,
    detail: t("No-fly zone"),
    box: boxAround(/** @type {number[][]} */ (geometry.coordinates.flat(2))) ?? undefined,
  }));
}

/** @type {Promise<NamedThing[]> | null} */
let bases = null;

/** The organisation's bases, read with the first search; none where they cannot be read. */
function basesKnown() {
  bases ??= get("/bases?limit=1000").then(
    (answer) =>
      /** @type {Answer<BasePage>} */ (answer).data.results.map(({ name, position }) => ({
        name,
        position,
        icon: "warehouse",
        detail: t("Base"),
      })),
    () => {
      bases = null; // asked again with the next search
      return [];
    },
  );
  return bases;
}

/**
 * Places for a text: [{ icon, label, detail, and position with zoom, or box }]. A pair of coordinates has no other results. `things` are
 * named features of the page, such as UAVs: [{ name, position, icon, detail }].
 *
 * @param {string} text
 * @param {{ signal?: AbortSignal, things?: NamedThing[] }} [options]
 */
export async function placesFound(text, { signal, things = [] } = {}) {
  const coordinates = coordinatesFound(text);
  if (coordinates.length || !text.trim()) return coordinates;
  const [bases, zones, towns] = await Promise.all([
    basesKnown(),
    zonesFound(text.trim(), signal),
    townsFound(text, MAX_TOWNS),
  ]);
  return [...namedFound(text, things), ...namedFound(text, bases), ...zones, ...towns];
}

/**
 * Brings a found place into view.
 *
 * @param {MapLibreMap} map
 * @param {Pick<FoundPlace, "position" | "zoom" | "box">} place
 * @param {(box: Box) => void} fit
 */
export function goTo(map, place, fit) {
  if (place.box || !place.position) {
    if (place.box) fit(place.box);
    return;
  }
  const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
  const [longitude, latitude] = place.position;
  const zoom = Math.max(map.getZoom(), place.zoom ?? 0);
  map.easeTo({ center: [longitude, latitude], zoom, duration: calm ? 0 : 350 });
}

/**
 * Results that are called alike are told apart by where they are.
 *
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
