/** The bell of every page: the count of unacknowledged alerts, also in the title of the browser's tab. */

import { ApiError, get } from "../api.js";
import { byId } from "../dom.js";
import { t, tn } from "../text.js";

/** @import { Answer } from "../api.js" */
/** @import { UnansweredAlerts } from "../api_types.d.ts" */

const ASK_EVERY_MS = 10_000;
const MARKED = /^\(\d+!?\) /;

let mark = "";
let isFed = false; // by the page's own live feed

/** A title with the number before it: "(2!) Live · Spanwise"; "!" where one is critical. @param {string} title @param {string} before */
export const markedTitle = (title, before) => before + title.replace(MARKED, "");

function markTitle() {
  const title = markedTitle(document.title, mark);
  if (document.title !== title) document.title = title;
}

/** @param {{ all: number, critical: number }} counts unacknowledged alerts */
export function showAlertCount({ all, critical }) {
  const [bell, badge] = [byId("open-alerts"), byId("alert-badge")];
  badge.hidden = all === 0;
  badge.textContent = `${all}`;
  bell.classList.toggle("critical", critical > 0);
  const words = all ? tn(all, "{count} open alert", "{count} open alerts") : t("Alerts");
  const summary = critical ? `${words}, ${t("{count} critical", { count: critical })}` : words;
  bell.setAttribute("aria-label", summary);
  bell.title = summary;
  mark = all ? `(${all}${critical ? "!" : ""}) ` : "";
  markTitle();
}

async function ask() {
  try {
    const { critical, warning, advisory } = /** @type {Answer<UnansweredAlerts>} */ (await get("/alerts/counts")).data;
    if (!isFed) showAlertCount({ all: critical + warning + advisory, critical });
  } catch (error) {
    if (!(error instanceof ApiError)) throw error; // the server is unavailable: keep the number
  }
}

/** Use the page's own feed: it updates the number, and the bell opens the alerts on the page. @param {() => void} open */
export function feedBell(open) {
  isFed = true;
  byId("open-alerts").addEventListener("click", (event) => {
    event.preventDefault();
    open();
  });
}

/** Poll the server on pages without a feed, also while they are hidden, for the tab's title. */
export function startBell() {
  if (!document.getElementById("open-alerts")) return;
  new MutationObserver(markTitle).observe(/** @type {Node} */ (document.querySelector("title")), { childList: true });
  setTimeout(() => {
    if (isFed) return;
    void ask();
    setInterval(() => void ask(), ASK_EVERY_MS);
  });
}
