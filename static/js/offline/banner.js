/** The banner of an offline copy: its time, and that nothing can be sent. It disappears once the server answers. */

import { h, icon } from "../dom.js";
import { t } from "../text.js";
import { clockText, exactText } from "../units.js";
import { watchServer } from "./server_watch.js";

/** @param {string} keptAt ISO 8601 */
export function showCopyBanner(keptAt) {
  const words = h("strong", {}, t("Offline copy from {time}", { time: clockText(keptAt) }));
  const rest = t("The server cannot be reached. Nothing here is live, and commands are off until it answers.");
  const banner = h(
    "p",
    { class: "notice warning copy-banner", role: "status", title: exactText(keptAt) },
    icon("cloud-off"),
    h("span", {}, words, ". ", rest),
  );
  document.querySelector("header.bar")?.after(banner);
  disableActs(t("Offline copy: commands need a connection."));
  watchServer();
}

/** Buttons that the server wrote into the page for acts, which its script would have made work. @param {string} why */
function disableActs(why) {
  const acts = document.querySelectorAll(".side .foot-buttons button");
  for (const button of /** @type {NodeListOf<HTMLButtonElement>} */ (acts)) {
    button.disabled = true;
    button.title = why;
  }
}
