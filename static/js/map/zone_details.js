/** What is known of a zone beyond its tile: times in words, source. Asked for when somebody looks at it. */

import { get } from "../api.js";

const KEPT_MS = 60_000;
const known = new Map(); // zone → { at, properties }

/** What was read of it last, however old; null where nothing was. */
export const zoneDetailsKept = (id) => known.get(id)?.properties ?? null;

export async function zoneDetails(id) {
  const kept = known.get(id);
  if (kept && Date.now() - kept.at < KEPT_MS) return kept.properties;
  const { properties } = (await get(`/zones/${id}`)).data;
  known.set(id, { at: Date.now(), properties });
  return properties;
}
