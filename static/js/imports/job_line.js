/** Progress of a job, and the button that stops it. */

import { h } from "../dom.js";
import { t } from "../text.js";
import { percentText } from "../units.js";

/** @import { ProposalJob } from "../api_types.d.ts" */

/** `cancel()` requests the job's stop. @param {string} what @param {() => Promise<void>} cancel */
export function jobLine(what, cancel) {
  const words = h("span", {});
  const share = h("span", {});
  const fill = h("i");
  const bar = h(
    "div",
    { class: "progress", role: "progressbar", "aria-label": what, "aria-valuemin": "0", "aria-valuemax": "100" },
    fill,
  );
  const stop = h(
    "button",
    { type: "button", class: "button", "aria-label": t("Cancel: {what}", { what }) },
    t("Cancel"),
  );
  stop.addEventListener("click", () => {
    stop.disabled = true;
    stop.textContent = t("Stopping");
    cancel().catch(() => {
      stop.disabled = false;
      stop.textContent = t("Cancel");
    });
  });
  const element = h(
    "div",
    { class: "import-job" },
    h("div", { class: "job-words" }, words, share),
    bar,
    h("div", { class: "row-acts" }, stop),
  );

  /** @param {ProposalJob | null} job */
  function refresh(job) {
    const text = job?.message || what;
    words.textContent = text.charAt(0).toUpperCase() + text.slice(1);
    const isKnown = job?.state === "running";
    share.textContent = isKnown ? percentText(job.progress * 100) : "";
    if (isKnown) bar.setAttribute("aria-valuenow", String(Math.round(job.progress * 100)));
    else bar.removeAttribute("aria-valuenow");
    fill.style.width = isKnown ? `${job.progress * 100}%` : "0";
  }
  return { element, refresh };
}
