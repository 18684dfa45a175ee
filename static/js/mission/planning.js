/** Planning what is picked, following the job where it is a large one, and stopping it. */

import { follow, post } from "../api.js";
import { say, toast } from "../page/toast.js";
import { countText } from "../units.js";
import { sentenceOf, unreachedOf } from "./plan_view.js";
import * as picks from "./selection.js";

/** The plan of a result, with the selection that it was made for: its indices point into that. */
export function planOf(result, selection) {
  return { result, basis: picks.basisOf(selection), targets: selection.targets, uavs: selection.uavs };
}

/** context: see actions.js. `running.stopping` is the AbortController of what is being waited for. */
export function createPlanning({ store, selection, problem, failed, running }) {
  async function waitForJob(jobId, what) {
    const job = await follow(jobId, {
      signal: running.stopping?.signal,
      onProgress: (at) => store.update({ planning: { what: at.message || what, share: at.progress, job: jobId } }),
    });
    if (job.state === "cancelled" && !job.result) throw new DOMException("stopped", "AbortError");
    return job;
  }

  function missing() {
    if (!selection().targets.length) return ["Nothing picked yet.", "Click a tower, bridge or track on the map, then plan."];
    if (!selection().uavs.length) return ["No UAV is chosen.", "Tick one in the list, or add the first one."];
    return null;
  }

  async function plan() {
    if (store.state.planning || store.state.saving) return;
    const lacking = missing();
    if (lacking) {
      problem(...lacking, [], { untilChanged: true });
      return;
    }
    const asked = selection();
    const what = `Planning ${countText(asked.targets.length, "target")}`;
    running.stopping = new AbortController();
    store.update({ planning: { what, share: null, job: null }, problem: null });
    try {
      const answer = await post("/plans", picks.requestOf(asked), { signal: running.stopping.signal });
      const result = answer.status === 202 ? (await waitForJob(answer.data.job, what)).result : answer.data;
      const made = planOf(result, asked);
      store.update({ plan: made, figures: { ...store.state.figures, [made.basis]: result }, planIsStored: false, chosenRoute: null });
      const { sentence, facts } = sentenceOf(made);
      const unreached = unreachedOf(made).length;
      say(`${sentence}. ${facts}.${unreached ? ` ${countText(unreached, "target is", "targets are")} not reached.` : ""}`);
    } catch (error) {
      if (error.name === "AbortError") toast("Planning stopped. Nothing was changed.");
      else failed("Not planned.", error, [{ label: "Plan again", act: plan }]);
    } finally {
      running.stopping = null;
      store.update({ planning: null });
    }
  }

  async function stop() {
    const job = store.state.planning?.job;
    try {
      if (job) await post(`/jobs/${job}/cancel`, {});
    } catch (error) {
      if (error.status !== 409) failed("Not stopped.", error); // 409: it ended by itself
    }
    if (!job) running.stopping?.abort();
  }

  return { plan, stop, waitForJob };
}
