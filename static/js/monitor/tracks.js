/** Flown lines: from the log once, then point by point as they are measured. */

import { get } from "../api.js";

const MOST = 2_000; // points of a mission from the log
const GAP_MS = 60_000; // a line is broken where nothing was heard for longer

export function createTracks({ onRead, read = (mission) => get(`/telemetry?mission=${mission}&most=${MOST}&limit=1000`) }) {
  const points = new Map(); // uav → [{ at_ms, position }] in order
  const asked = new Set();

  function add(uav, at_ms, position) {
    const own = points.get(uav) ?? points.set(uav, []).get(uav);
    const last = own.at(-1);
    if (!last || at_ms > last.at_ms) own.push({ at_ms, position });
  }

  async function ask(mission) {
    asked.add(mission);
    try {
      const found = [];
      for (let page = (await read(mission)).data; page; page = page.next ? (await get(page.next)).data : null) found.push(...page.features);
      const logged = new Map();
      for (const { geometry, properties } of found) {
        if (!geometry || properties.is_from_future) continue;
        (logged.get(properties.uav) ?? logged.set(properties.uav, []).get(properties.uav)).push({ at_ms: Date.parse(properties.measured_at), position: geometry.coordinates });
      }
      for (const [uav, own] of logged) {
        const last_ms = own.at(-1).at_ms;
        points.set(uav, [...own, ...(points.get(uav) ?? []).filter(({ at_ms }) => at_ms > last_ms)]);
      }
      onRead();
    } catch {
      asked.delete(mission); // with the next word
    }
  }

  return {
    /** Of the feed's UAVs: what is new is put to their lines. */
    take(uavs) {
      for (const { id, mission, measured } of uavs) {
        if (mission && !asked.has(mission)) void ask(mission);
        if (measured?.position) add(id, Date.parse(measured.measured_at_of?.position ?? measured.measured_at), measured.position);
      }
    },
    /** Lines of positions of one UAV. */
    of(uav) {
      const lines = [];
      let before_ms = -Infinity;
      for (const { at_ms, position } of points.get(uav) ?? []) {
        if (at_ms - before_ms > GAP_MS) lines.push([]);
        lines.at(-1).push(position);
        before_ms = at_ms;
      }
      return lines.filter((line) => line.length > 1);
    },
  };
}
