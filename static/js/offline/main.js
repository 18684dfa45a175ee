/** The page without a connection: lists the missions that this browser has kept, and reloads once the server answers. */

import { byId, h } from "../dom.js";
import { COPY_HEADER } from "../offline_copy.js";
import { t } from "../text.js";
import { clockText, exactText } from "../units.js";
import { watchServer } from "./server_watch.js";

/** @typedef {{ id: string, name: string, keptAt: string }} KeptMission */

const MISSION = /^\/api\/v1\/missions\/([0-9a-f-]+)$/;

/** @returns {Promise<KeptMission[]>} by name */
async function keptMissions() {
  /** @type {KeptMission[]} */
  const found = [];
  for (const name of (await caches.keys()).filter((one) => one.startsWith("spanwise-copy-"))) {
    const cache = await caches.open(name);
    for (const request of await cache.keys()) {
      const id = MISSION.exec(new URL(request.url).pathname)?.[1];
      const answer = id && (await cache.match(request));
      if (answer) found.push({ id, name: (await answer.json()).name, keptAt: answer.headers.get(COPY_HEADER) ?? "" });
    }
  }
  return found.sort((a, b) => a.name.localeCompare(b.name));
}

/** @param {KeptMission} mission */
const rowOf = ({ id, name, keptAt }) =>
  h(
    "li",
    {},
    h(
      "span",
      {},
      h("strong", {}, name),
      h("small", { title: exactText(keptAt) }, t("Offline copy from {time}", { time: clockText(keptAt) })),
    ),
    h("a", { class: "button", href: `/missions/${id}`, "aria-label": `${t("Plan|stage")}: ${name}` }, t("Plan|stage")),
    h("a", { class: "button", href: `/missions/${id}/fly`, "aria-label": `${t("Fly")}: ${name}` }, t("Fly")),
  );

byId("try-again").addEventListener("click", () => location.reload());
byId("signed-out-here").hidden = location.pathname !== "/sign-out";
watchServer();
const missions = await keptMissions().catch(() => []); // storage is closed
byId("kept-missions").replaceChildren(...missions.map(rowOf));
byId("kept").hidden = missions.length === 0;
document.documentElement.dataset.loaded = "true";
