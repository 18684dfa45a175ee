/** The live page of one mission as an offline copy: the approved plan, without live data. */

import { byId } from "../dom.js";
import { nothingShown } from "../live/shown.js";
import { fencesOf, rallyPointsOf, readBriefing } from "../offline/briefing.js";

/** @import { LiveMission, Mission } from "../api_types.d.ts" */
/** @import { MonitorStore } from "./types.d.ts" */

/** The mission in the form of the feed, without data that only the feed has. @param {Mission} mission @returns {LiveMission} */
export function missionOfCopy({ id, name, state, revision, departs_at, colours, uavs, targets, plan }) {
  const routes = plan?.routes ?? [];
  const placed = new Map(routes.flatMap((route, place) => route.targets.map((target) => [target, place])));
  return {
    id,
    name,
    call_number: null,
    colours,
    state,
    revision,
    departs_at,
    started_at: null,
    ended_at: null,
    uavs: uavs.map(({ id: uav, name: callSign }, place) => ({ place, name: callSign, uav })),
    targets: targets.map((target, place) => ({
      place,
      label: target.label,
      state: target.state,
      state_at: null,
      state_reason: "",
      uav: placed.get(place) ?? null,
    })),
    counts: { complete: targets.filter((target) => target.state === "complete").length, all: targets.length },
  };
}

/**
 * Replacement of the feed of live/feed.js: without messages, and with the time of the copy.
 *
 * @param {string} keptAt ISO 8601
 */
export function silentFeed(keptAt) {
  return {
    shown: nothingShown(),
    received_ms: null,
    shown_ms: () => Date.parse(keptAt),
    silent_ms: () => 0,
    close: () => {},
  };
}

/**
 * Read the mission from the copy, show it beside the map, and return the map's additional features.
 *
 * @param {MonitorStore} store
 * @param {string} id
 * @param {(position: number[]) => void} show
 */
export async function showCopy(store, id, show) {
  for (const part of ["right-parts", "narrow-tabs", "part-uavs", "live-facts"]) byId(part).hidden = true;
  byId("workbench").dataset.right = "folded";
  const { mission, approval, element } = await readBriefing(id, show);
  store.update({ missions: [missionOfCopy(mission)], details: new Map([[id, mission]]) });
  byId("part-uavs").after(element);
  return { rally: rallyPointsOf(mission), fences: fencesOf(approval) };
}
