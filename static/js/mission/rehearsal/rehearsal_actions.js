/** Starting, following and stopping rehearsals of the mission, and reading what came of them: store.rehearsal, which the panel and the map listen to. */

import { ApiError, get, post } from "../../api.js";
import { followLive } from "../../live/jobs.js";
import { t } from "../../text.js";
import { isRunning } from "./rehearsal.js";

export const NOTHING = { list: null, detail: null, run: 0, track: null, running: null, fault: "" };

/** isStage: the page is about rehearsals alone, and its address names the one that is looked at. */
export function createRehearsing(store, { isStage = false } = {}) {
  const ofAddress = new URLSearchParams(isStage ? location.search : "");
  let following = null; // the job that is listened to
  let asked = 0; // the last reading wins

  const change = (values) => store.update({ rehearsal: { ...store.state.rehearsal, ...values } });
  const missionId = () => store.state.mission?.id ?? null;
  const address = (rehearsal = "", rest = "") =>
    `/missions/${missionId()}/rehearsals${rehearsal ? `/${rehearsal}` : ""}${rest}`;

  async function told(act) {
    try {
      await act();
    } catch (error) {
      if (error.name === "AbortError") return;
      if (!(error instanceof ApiError)) throw error;
      change({ fault: error.message, running: null });
    }
  }

  /** The rehearsals of the mission, and the newest of them; one that is being flown is followed. */
  const read = (wanted = null) =>
    told(async () => {
      const mission = missionId();
      if (!mission) return change({ ...NOTHING });
      const turn = ++asked;
      const { data } = await get(address());
      if (turn !== asked || mission !== missionId()) return;
      change({ list: data.results, fault: "" });
      const [newest] = data.results;
      if (isRunning(newest)) void follow(newest);
      const { detail, run } = store.state.rehearsal;
      const named = wanted || detail ? null : ofAddress.get("rehearsal");
      if (named) return await show(named, ofAddress.has("run") ? Number(ofAddress.get("run")) : null);
      const shown =
        data.results.find(({ id }) => id === (wanted ?? detail?.id)) ??
        data.results.find(({ level, state }) => level || ["failed", "cancelled"].includes(state));
      if (shown) await show(shown.id, detail?.id === shown.id ? run : null);
      else change({ detail: null, track: null });
    });

  /** run: null for the worst of its runs. */
  const show = (id, run = null) =>
    told(async () => {
      const { data: detail } = await get(address(id));
      const order = ["fail", "warnings", "pass"];
      const flown = detail.runs
        .filter(({ level }) => level)
        .sort((a, b) => order.indexOf(a.level) - order.indexOf(b.level) || a.sequence - b.sequence);
      const chosen = detail.runs[run] ? run : (flown[0]?.sequence ?? 0);
      change({ detail, run: chosen, track: null });
      remember();
      if (detail.runs[chosen]?.level) await showTrack(id, chosen);
    });

  /** What is looked at stands in the address: it can be loaded again, and passed on. */
  function remember() {
    if (!isStage) return;
    const { detail, run } = store.state.rehearsal;
    history.replaceState(
      history.state,
      "",
      `${location.pathname}?${new URLSearchParams({ rehearsal: detail.id, run })}${location.hash}`,
    );
  }

  async function showTrack(id, run) {
    const { data: track } = await get(address(id, `/track?run=${run}`));
    if (store.state.rehearsal.detail?.id === id && store.state.rehearsal.run === run) change({ track });
  }

  const chooseRun = (run) =>
    told(async () => {
      change({ run, track: null });
      remember();
      const { detail } = store.state.rehearsal;
      if (detail.runs[run]?.level) await showTrack(detail.id, run);
    });

  /** afresh: also what was flown alike lately. */
  const start = (conditions, { afresh = false } = {}) =>
    told(async () => {
      change({ fault: "", running: { id: null, job: null, progress: null, message: t("Being sent") } });
      const key = crypto.randomUUID?.() ?? `${Date.now()}-${Math.random()}`;
      const { data } = await post(address(), { conditions, afresh }, { headers: { "Idempotency-Key": key } });
      await follow(data);
    });

  async function follow({ id, job, progress, message }) {
    if (following === job) return;
    following = job;
    const mission = missionId();
    const onProgress = (at) =>
      mission === missionId() &&
      change({
        running: {
          id,
          job,
          progress: at.state === "queued" ? null : at.progress,
          message: at.state === "queued" ? t("Waiting for a worker") : at.message,
        },
      });
    change({ running: { id, job, progress, message } });
    try {
      await followLive(job, { onProgress });
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      change({ fault: error.message });
    } finally {
      following = null;
    }
    if (mission !== missionId()) return;
    const { fault } = store.state.rehearsal;
    change({ running: null });
    await read(id);
    if (fault) change({ fault });
  }

  const cancel = () =>
    told(async () => {
      const { running } = store.state.rehearsal;
      if (running?.id) await post(address(running.id, "/cancel"));
    });

  // Another mission, or another revision of it: what was flown may be of another plan by now.
  let known = "";
  store.listen(["mission"], ({ mission }) => {
    const now = mission ? `${mission.id} ${mission.revision}` : "";
    if (now === known) return;
    known = now;
    void read();
  });

  return { start, cancel, show, chooseRun };
}
