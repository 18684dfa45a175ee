/** One's own jobs: what runs, with a way to stop it, and the last that have ended. */

import { get, post } from "../api.js";
import { byId, h } from "../dom.js";
import { toast } from "../page/toast.js";
import { t } from "../text.js";
import { exactText, percentText, whenText } from "../units.js";

/** @import { Answer } from "../api.js" */
/** @import { JobPage } from "../api_types.d.ts" */
/** @import { Reporter } from "../page/problem.js" */

/** @typedef {JobPage["results"][number]} Job */

const SHOWN = 50;
const INTERVAL_MS = 3_000; // while one is open

/** @type {Record<string, string>} */
const TASKS = {
  "inspection.tasks.apply_proposal": t("Applying an import"),
  "inspection.tasks.fetch_subscription": t("Fetching zones"),
  "inspection.tasks.read_proposal": t("Reading an import"),
  "missions.tasks.plan_campaign": t("Planning a campaign"),
  "missions.tasks.plan_mission": t("Planning a mission"),
  "missions.tasks.replan_mission": t("Planning in flight"),
  "missions.tasks.solve_plan": t("Planning"),
  "simulation.tasks.make_demo_missions": t("Making demo missions"),
  "simulation.tasks.rehearse_mission": t("Rehearsing a mission"),
};
/** @type {Record<Job["state"], string>} */
const STATES = {
  queued: t("Waiting|job"),
  running: t("Running|job"),
  done: t("Done|job"),
  failed: t("Failed|job"),
  cancelled: t("Cancelled|job"),
};

/** @param {Job} job */
export const isOpen = ({ state }) => state === "queued" || state === "running";

/** @param {Reporter} reporter */
export function mountJobs({ notify, settle }) {
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;

  async function load() {
    clearTimeout(timer);
    try {
      const open = /** @type {Answer<JobPage>} */ (await get("/jobs?mine=true&open=true&limit=1000"));
      const last = /** @type {Answer<JobPage>} */ (
        await get(`/jobs?mine=true&limit=${SHOWN + open.data.results.length}`)
      );
      draw([...open.data.results, ...last.data.results.filter((job) => !isOpen(job))]);
      if (open.data.results.length) timer = setTimeout(load, INTERVAL_MS);
    } catch (error) {
      notify(t("Jobs could not be loaded."), error);
    }
  }

  /** @param {Job[]} jobs */
  function draw(jobs) {
    const focused = document.activeElement?.closest("[data-job]")?.getAttribute("data-job");
    const list = byId("jobs");
    const mayCancel = "mayCancel" in list.dataset;
    list.replaceChildren(...jobs.map((job) => jobRow(job, mayCancel ? () => cancel(job) : null)));
    byId("jobs-none").hidden = jobs.length > 0;
    /** @type {HTMLElement | null} */ (document.querySelector(`[data-job="${focused}"] button`))?.focus();
  }

  /** @param {Job} job */
  async function cancel(job) {
    try {
      await post(`/jobs/${job.id}/cancel`);
      settle();
      toast(t("The job is asked to stop."));
      await load();
    } catch (error) {
      notify(t("The job is not stopped."), error);
    }
  }

  return { load };
}

/** The row of a job; without `cancel` where the user may not stop it. @param {Job} job @param {(() => void) | null} cancel */
export function jobRow(job, cancel) {
  const what = TASKS[job.task] ?? job.task;
  const at = job.finished_at ?? job.created_at;
  const words = job.error?.message ?? job.message;
  const share = job.state === "running" ? percentText(job.progress * 100) : "";
  const facts = [share, whenText(at), words].filter(Boolean).join(" · ");
  const act =
    isOpen(job) && cancel
      ? h(
          "button",
          { type: "button", class: "button", "aria-label": t("Cancel: {what}", { what }), onclick: cancel },
          t("Cancel"),
        )
      : null;
  return h(
    "li",
    { dataset: { job: job.id } },
    h("div", { class: "what" }, h("strong", {}, what), h("span", { class: "caption", title: exactText(at) }, facts)),
    h(
      "span",
      { class: job.state === "failed" ? "chip aborted" : isOpen(job) ? "chip active" : "chip" },
      STATES[job.state],
    ),
    act,
  );
}
