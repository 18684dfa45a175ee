/** Data that the feed does not have: plans of missions, and the line flown so far. Read once, and again when a mission changes. */

import { ApiError, get } from "../api.js";
import { inAir } from "../domain/in_air.js";

/** @import { Answer } from "../api.js" */
/** @import { LiveMission, Mission } from "../api_types.d.ts" */
/** @import { MonitorStore } from "./types.d.ts" */

/** @typedef {Map<number, { parts: number[][][], last_ms: number }>} Flown lines by UAV */
/** @typedef {{ geometry: { coordinates: number[] } | null, properties: { uav: number, measured_at: string, is_from_future?: boolean } }} Report */

const MAX_RECORDS = 900;
const GAP_S = 45; // no line is drawn over a longer silence: the path is unknown

/** The log as parts of a line by UAV: Map of uav → { parts: [[lon lat, …], …], last_ms }. @param {Report[]} features */
export function flownParts(features) {
  /** @type {Flown} */
  const flown = new Map();
  for (const { geometry, properties } of features) {
    if (geometry && !properties.is_from_future)
      addReport(flown, properties.uav, geometry.coordinates, Date.parse(properties.measured_at));
  }
  return flown;
}

/**
 * Append a report to a UAV's line; an older or equal one changes nothing. Returns whether it was appended.
 *
 * @param {Flown} flown
 * @param {number} uav
 * @param {number[]} position
 * @param {number} at_ms
 * @param {number} [gap_s]
 */
export function addReport(flown, uav, position, at_ms, gap_s = GAP_S) {
  const known = flown.get(uav);
  if (!known) flown.set(uav, { parts: [[position]], last_ms: at_ms });
  else if (at_ms <= known.last_ms) return false;
  else {
    if (at_ms - known.last_ms > gap_s * 1000) known.parts.push([position]);
    else known.parts.at(-1)?.push(position);
    known.last_ms = at_ms;
  }
  return true;
}

/**
 * @param {MonitorStore} store
 * @param {Promise<unknown>} [mapReady] lines are read once the map can show them
 */
export function createMissionDetails(store, mapReady = Promise.resolve()) {
  /** @type {Map<string, number>} */
  const asked = new Map(); // mission → revision that was read
  /** @type {Flown} */
  const flown = new Map();

  /** @param {LiveMission} mission */
  async function read({ id, revision }) {
    if (asked.get(id) === revision) return;
    const isFirst = !asked.has(id);
    asked.set(id, revision);
    try {
      const { data } = /** @type {Answer<Mission>} */ (await get(`/missions/${id}`));
      store.update({ details: new Map([...store.state.details, [id, data]]) });
      if (!isFirst) return;
      await mapReady;
      await readFlown(id);
    } catch (error) {
      asked.delete(id); // again with the next change
      if (!(error instanceof ApiError)) throw error;
    }
  }

  /** @param {string} mission */
  async function readFlown(mission) {
    /** @type {Report[]} */
    const features = [];
    /** @type {string | null} */
    let next = `/telemetry?mission=${mission}&most=${MAX_RECORDS}&limit=1000`;
    while (next) {
      const { data } = /** @type {Answer<{ features: Report[], next: string | null }>} */ (await get(next));
      features.push(...data.features);
      next = data.next;
    }
    for (const [uav, line] of flownParts(features)) {
      const live = flown.get(uav)?.parts.flat() ?? [];
      flown.set(uav, line);
      line.parts.at(-1)?.push(...live.slice(-1));
    }
    notify();
  }

  const notify = () => store.update({ flown: new Map([...flown].map(([uav, { parts }]) => [uav, parts])) });

  store.listen(["missions"], ({ missions }) => {
    for (const mission of missions) void read(mission);
  });
  store.listen(["uavs"], ({ uavs }) => {
    const isNew = uavs.map(
      (uav) =>
        uav.mission !== null &&
        uav.measured?.position &&
        inAir(uav) !== false &&
        addReport(flown, uav.id, uav.measured.position, Date.parse(uav.measured.measured_at)),
    );
    if (isNew.some(Boolean)) notify();
  });
}
