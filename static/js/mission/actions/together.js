/** Who else has the mission open, what they save, and whether the server is there: asked every few seconds while the page is looked at. */

import { get, post } from "../../api.js";

const POLL_MS = 3000;
const PRESENCE_MS = 6000;

/** editor: the name of this page; readFleet(): what flies, as it is now; take(mission): see conflicts.js. */
export function watchMission(store, { editor, readFleet, take, connectedAgain, tellDeleted }) {
  let timer = 0;
  let isAsking = false;
  let reportedAt = 0;
  let toldDeleted = null;

  const presence = (here) =>
    post(`/missions/${store.state.mission.id}/presence`, { editor, here }, { keepalive: !here });

  function failed(error) {
    if (error.isAway) store.update({ isAway: true });
    else if (error.status === 404 && toldDeleted !== store.state.mission.id) {
      toldDeleted = store.state.mission.id;
      tellDeleted();
    } else if (!error.status) throw error;
  }

  async function ask() {
    const { mission, saving, planning } = store.state;
    if (!mission || saving || planning || isAsking) return;
    isAsking = true;
    try {
      const answer = await get(`/missions/${mission.id}`, { headers: { "If-None-Match": `"${mission.revision}"` } });
      toldDeleted = null;
      const { mission: now, saving: isSaving, isAway: wasAway } = store.state;
      if (answer.data && !isSaving && now.id === mission.id && answer.data.revision > now.revision)
        await take(answer.data);
      if (wasAway) connectedAgain(wasAway); // after theirs came in: what waits is saved on top of it
      if (Date.now() - reportedAt > PRESENCE_MS) await report();
    } catch (error) {
      failed(error);
    } finally {
      isAsking = false;
    }
  }

  async function report() {
    reportedAt = Date.now();
    const { data } = await presence(true);
    store.update({ others: data.others, groundRevision: data.ground_revision });
    const { mission } = store.state;
    const isOnOtherGround = mission.plan && !mission.is_stale && mission.plan.ground_revision !== data.ground_revision;
    const hasOtherUavs = JSON.stringify(mission.uav_changes) !== JSON.stringify(data.uav_changes);
    if (!isOnOtherGround && !hasOtherUavs) return;
    const fleet = hasOtherUavs ? await readFleet() : store.state.fleet;
    const { data: fresh } = await get(`/missions/${mission.id}`); // the ground or a UAV has changed, the mission has not
    if (fresh.revision !== mission.revision || store.state.mission !== mission) return;
    const { is_stale, stale_reason, stale_causes, uav_changes } = fresh;
    store.update({ fleet, mission: { ...mission, is_stale, stale_reason, stale_causes, uav_changes } });
  }

  function start() {
    clearInterval(timer);
    if (document.hidden) return;
    timer = setInterval(() => void ask(), POLL_MS);
    void ask();
  }

  let watched = null;
  store.listen(["mission"], ({ mission }) => {
    if (!mission || mission.id === watched) return;
    watched = mission.id;
    reportedAt = 0;
    start();
  });
  document.addEventListener("visibilitychange", () => watched && start());
  addEventListener("offline", () => store.update({ isAway: true }));
  addEventListener("online", () => (store.state.mission ? void ask() : connectedAgain()));
  addEventListener("pagehide", () => {
    if (watched) presence(false).catch(() => {}); // the page is gone; the others forget it by themselves too
  });
}
