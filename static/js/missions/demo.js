/** Demo data on the list of missions: made where there are none, marked, and removed with one button. */

import { freshKey, get, post, remove } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { followLive } from "../live/jobs.js";
import { confirmAct } from "../page/confirm.js";
import { toast } from "../page/toast.js";
import { t, tn } from "../text.js";

/** @import { Answer } from "../api.js" */
/** @import { DemoData } from "../api_types.d.ts" */

const CHECK_MS = 5000;

/**
 * @param {{ reload: () => unknown, showProblem: (error: unknown, title: string) => unknown, canChange: boolean }} page
 * @returns state of the demo, and its acts
 */
export function createDemo({ reload, showProblem, canChange }) {
  /** @type {DemoData | null} */
  let known = null;
  /** @type {string | null} */
  let followed = null;
  /** @type {() => unknown} */
  let onChange = () => {};

  async function load() {
    known = /** @type {Answer<DemoData>} */ (await get("/demo-data")).data;
    draw();
    onChange();
    if (known.job) follow(known.job);
  }

  /** Follow the job; missions appear one by one. @param {string} job */
  async function follow(job) {
    if (followed === job) return;
    followed = job;
    const timer = setInterval(reload, CHECK_MS);
    try {
      await followLive(job);
    } catch (error) {
      showProblem(error, t("The demo missions were not made."));
    } finally {
      clearInterval(timer);
      followed = null;
    }
    await reload();
    await load();
  }

  async function make() {
    try {
      await post("/demo-data", {}, { headers: { "Idempotency-Key": freshKey() } });
      await load();
    } catch (error) {
      showProblem(error, t("The demo missions were not made."));
    }
  }

  /** @param {Event} event */
  async function removeAll(event) {
    const asked = await confirmAct({
      title: t("Remove the demo data?"),
      lines: [
        t("The demo missions with their records and the demo UAVs are deleted. Simulated flights of them end at once."),
        t("UAVs that your own missions use stay, and so do assets and zones. This cannot be undone."),
      ],
      act: t("Remove the demo data"),
      keep: t("Cancel"),
      isDanger: true,
      opener: /** @type {HTMLElement} */ (event.currentTarget),
    });
    if (!asked) return;
    try {
      const { data } = /** @type {Answer<{ missions: number }>} */ (await remove("/demo-data"));
      toast(tn(data.missions, "{count} demo mission is removed.", "{count} demo missions are removed."));
      await Promise.all([reload(), load()]);
    } catch (error) {
      showProblem(error, t("Not removed."));
    }
  }

  function draw() {
    const bar = byId("demo-data");
    bar.hidden = !known || (!known.missions && !known.job);
    if (!known || bar.hidden) return;
    bar.replaceChildren(
      icon("info", "small"),
      h(
        "span",
        { role: "status" },
        known.job
          ? t("Demo missions are being planned and flown in simulation.")
          : t("The missions marked “Demo” and their UAVs are demo data."),
      ),
      ...(canChange && !known.job
        ? [h("button", { type: "button", class: "text-button", onclick: removeAll }, t("Remove the demo data"))]
        : []),
    );
  }

  return {
    load,
    make,
    /** @returns {DemoData | null} */
    known: () => known,
    /** @param {() => unknown} act */
    listen: (act) => {
      onChange = act;
    },
  };
}
