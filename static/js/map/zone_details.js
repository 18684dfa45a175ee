/** Details of a zone beyond its tile: times as text, source. Requested when they are shown. */

import { get } from "../api.js";

/** @import { Answer } from "../api.js" */
/** @import { ZoneDetailFeature, ZoneDetailProperties } from "../api_types.d.ts" */

const KEPT_MS = 60_000;
/** @type {Map<number, { at: number, properties: ZoneDetailProperties }>} */
const known = new Map(); // zone → { at, properties }

/** The details read last, however old; null without any. @param {number} id */
export const zoneDetailsKept = (id) => known.get(id)?.properties ?? null;

/** @param {number} id */
export async function zoneDetails(id) {
  const kept = known.get(id);
  if (kept && Date.now() - kept.at < KEPT_MS) return kept.properties;
  const { data } = /** @type {Answer<ZoneDetailFeature>} */ (await get(`/zones/${id}`));
  const { properties } = data;
  known.set(id, { at: Date.now(), properties });
  return properties;
}

/**
 * An element that is shown only where a zone is not in force at all times.
 *
 * @template {HTMLElement} Kind
 * @param {Kind} element
 * @param {number} id of the zone
 */
export function shownWhereTimed(element, id) {
  element.hidden = true;
  zoneDetails(id).then(
    ({ schedule }) => {
      element.hidden = !schedule?.length;
    },
    () => {},
  );
  return element;
}
