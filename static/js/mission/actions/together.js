/** Who else has the mission open, their saves, and whether the server is available: polled every few seconds while the page is visible. */

import { ApiError, get, post } from "../../api.js";

/** @import { Answer } from "../../api.js" */
/** @import { Mission, Presence } from "../../api_types.d.ts" */
/** @import { FleetUav, MissionStore } from "../types.d.ts" */

/**
 * @typedef {object} Watching
 * @property {string} editor the name of this page
 * @property {() => Promise<FleetUav[]>} readFleet reads the present fleet
 * @property {(theirs: Mission) => Promise<void>} take takes over a newer revision: see conflicts.js
 * @property {(hasWaited?: boolean) => void} connectedAgain
 * @property {() => void} showDeleted
 */

const POLL_MS = 3000;
const PRESENCE_MS = 6000;

/** @param {MissionStore} store @param {Watching} watching */
export function watchMission(store, { editor, readFleet, take, connectedAgain, showDeleted }) {
  /** @type {ReturnType<typeof setInterval> | undefined} */
  let timer;
  let isAsking = false;
  let reportedAt = 0;
  /** @type {string | null} */
  let confirmedDeletion = null;
  /** @type {string | null} */
  let watched = null;
  const followGround = createGroundReading(store, readFleet);

  /** @param {string} id @param {boolean} here */
  const presence = (id, here) =>
    post(
      `/missions/${id}/presence`,
      { editor, here, planning: here && store.state.planning !== null },
      { keepalive: !here },
    );

  /** @param {unknown} error @param {Mission} mission */
  function failed(error, mission) {
    if (!(error instanceof ApiError)) throw error;
    if (error.isAway) store.update({ isAway: true });
    else if (error.status === 404 && confirmedDeletion !== mission.id) {
      confirmedDeletion = mission.id;
      showDeleted();
    }
  }

  async function ask({ isFresh = false } = {}) {
    const { mission, saving, planning } = store.state;
    if (!mission || saving || isAsking) return;
    if (planning && Date.now() - reportedAt <= PRESENCE_MS) return;
    isAsking = true;
    try {
      if (planning || isFresh) {
        await report(); // other users' saves are taken over once the plan has arrived
        return;
      }
      const { data } = /** @type {Answer<Mission | null>} */ (
        await get(`/missions/${mission.id}`, { headers: { "If-None-Match": `"${mission.revision}"` } })
      );
      confirmedDeletion = null;
      const { mission: now, saving: isSaving, isAway: wasAway } = store.state;
      if (data && now && !isSaving && now.id === mission.id && data.revision > now.revision) await take(data);
      if (wasAway) connectedAgain(wasAway); // after their version was taken over: pending changes are saved on top of it
      if (Date.now() - reportedAt > PRESENCE_MS) await report();
    } catch (error) {
      failed(error, store.state.mission ?? mission);
    } finally {
      isAsking = false;
    }
  }

  async function report() {
    const { mission } = store.state;
    if (!mission) return;
    reportedAt = Date.now();
    const { data } = /** @type {Answer<Presence>} */ (await presence(mission.id, true));
    store.update({ others: data.others, groundRevision: data.ground_revision });
    if (!store.state.planning) await followGround(data);
  }

  function start({ isFresh = false } = {}) {
    clearInterval(timer);
    if (document.hidden) return;
    timer = setInterval(() => void ask(), POLL_MS);
    void ask({ isFresh });
  }

  store.listen(["mission"], ({ mission }) => {
    if (!mission || mission.id === watched) return;
    watched = mission.id;
    reportedAt = 0;
    start({ isFresh: true }); // it was read a moment ago
  });
  let wasPlanning = false;
  store.listen(["planning"], ({ planning }) => {
    if ((planning !== null) === wasPlanning) return;
    wasPlanning = planning !== null;
    reportedAt = 0; // others are to see at once that it begins or ends
    if (watched && !document.hidden) void ask();
  });
  document.addEventListener("visibilitychange", () => watched && start());
  addEventListener("offline", () => store.update({ isAway: true }));
  addEventListener("online", () => (store.state.mission ? void ask() : connectedAgain()));
  addEventListener("pagehide", () => {
    if (store.state.mission) presence(store.state.mission.id, false).catch(() => {}); // the page is closed; others drop it by timeout too
  });
}

/**
 * Reads what the map data or a UAV have changed though the mission has not.
 *
 * @param {MissionStore} store
 * @param {Watching["readFleet"]} readFleet
 */
function createGroundReading(store, readFleet) {
  /** the map data for which the causes were read last @type {{ id: string | null, revision: number }} */
  let groundRead = { id: null, revision: 0 };

  return async (/** @type {Presence} */ present) => {
    const { mission } = store.state;
    if (!mission) return;
    const { id, plan } = mission;
    const read = store.state.ground?.revision ?? plan?.ground_revision; // when the mission was read, its causes were those of this or later
    const known = groundRead.id === id ? groundRead.revision : read;
    const isOnOtherGround = plan && known !== present.ground_revision;
    const hasOtherUavs = JSON.stringify(mission.uav_changes) !== JSON.stringify(present.uav_changes);
    if (!isOnOtherGround && !hasOtherUavs) return;
    const fleet = hasOtherUavs ? await readFleet() : store.state.fleet;
    const { data: fresh } = /** @type {Answer<Mission>} */ (await get(`/missions/${mission.id}`));
    if (fresh.revision !== mission.revision || store.state.mission !== mission) return;
    groundRead = { id, revision: present.ground_revision };
    const { is_stale, stale_reason, stale_causes, uav_changes } = fresh;
    store.update({ fleet, mission: { ...mission, is_stale, stale_reason, stale_causes, uav_changes } });
  };
}
