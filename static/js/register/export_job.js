/** A GeoPackage that a job writes: its progress in the bar of the register, a button that stops it, and the file. */

import { ApiError, isAbort, post, remove } from "../api.js";
import { h, icon, setChildren } from "../dom.js";
import { followLive } from "../live/jobs.js";
import { toast } from "../page/toast.js";
import { t } from "../text.js";
import { numberText, percentText } from "../units.js";

/** @import { Answer } from "../api.js" */
/** @import { Job } from "../api_types.d.ts" */

/**
 * Write the file and offer it.
 *
 * @param {HTMLElement} place in the bar
 * @param {string} address of the exports with the filters
 */
export async function exportInJob(place, address) {
  const stopped = new AbortController();
  const words = h("span", { role: "status" }, t("Writing the GeoPackage"));
  try {
    const { data: started } = /** @type {Answer<Job>} */ (await post(address));
    const cancel = () => {
      stopped.abort();
      setChildren(place);
      remove(`/exports/${started.id}`).catch(failed);
    };
    setChildren(place, words, h("button", { type: "button", class: "text-button", onclick: cancel }, t("Cancel")));
    const job = await followLive(started.id, {
      signal: stopped.signal,
      onProgress: ({ state, progress, message }) => {
        words.textContent =
          state === "running" ? t("Writing the GeoPackage, {share}", { share: percentText(progress * 100) }) : message;
      },
    });
    if (job.state !== "done") return setChildren(place);
    const file = /** @type {{ file_name: string, size_bytes: number }} */ (job.result);
    const link = h(
      "a",
      { class: "text-button", href: `/api/v1/exports/${job.id}`, download: file.file_name },
      icon("download", "small"),
      t("Download {file}, {size} MB", { file: file.file_name, size: numberText(Math.ceil(file.size_bytes / 1e6)) }),
    );
    const close = h(
      "button",
      { type: "button", class: "icon-button tight", "aria-label": t("Close"), onclick: () => setChildren(place) },
      icon("x", "small"),
    );
    setChildren(place, link, close);
    toast(t("The GeoPackage is written."));
  } catch (error) {
    setChildren(place);
    if (!isAbort(error)) failed(error);
  }
}

/** @param {unknown} error */
function failed(error) {
  if (!(error instanceof ApiError)) throw error;
  toast(error.message);
}
