/** Plans of the missions that are shown: read once for each revision, since live words carry no geometry. */

import { get } from "../api.js";

const AGAIN_AFTER_MS = 10_000;

/** const plans = createPlans({ onRead }); plans.of(mission) is what is known by now, or null. */
export function createPlans({ onRead, read = (id) => get(`/missions/${id}`), now_ms = () => Date.now() }) {
  const known = new Map(); // mission → { revision, plan, asked_ms }

  async function ask(id, revision) {
    const entry = { revision, plan: known.get(id)?.plan ?? null, asked_ms: now_ms(), failed: false };
    known.set(id, entry);
    try {
      entry.plan = (await read(id)).data;
      onRead(id);
    } catch {
      entry.failed = true; // asked again by and by: what is shown goes on without it
    }
  }

  return {
    of({ id, revision }) {
      const entry = known.get(id);
      const isOld = entry && entry.revision !== revision;
      const isDue = entry?.failed && now_ms() - entry.asked_ms > AGAIN_AFTER_MS;
      if (!entry || isOld || isDue) void ask(id, revision);
      return known.get(id)?.plan ?? null;
    },
  };
}

/** The route of a UAV in its mission's plan, by its place; null without one. */
export const routeOf = (plan, place) => (place === null ? null : (plan?.plan?.routes?.[place] ?? null));

/** Numbers of targets as the mission page has them: place in the mission → "C3". */
export function labelsOf(plan, letterOf) {
  const labels = new Map();
  (plan?.plan?.routes ?? []).forEach((route, place) => route.targets.forEach((target, index) => labels.set(target, { label: `${letterOf(place)}${index + 1}`, place, number: index + 1 })));
  return labels;
}

/** Where each target is inspected from: place in the mission → position. */
export function placesOf(plan) {
  const places = new Map();
  for (const route of plan?.plan?.routes ?? []) for (const point of route.waypoints) if (point.kind === "target" && !places.has(point.target)) places.set(point.target, point.position);
  return places;
}
