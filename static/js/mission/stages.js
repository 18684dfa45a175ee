/** The stages of a mission, once a mission that was begun on this page is stored. */

import { byId, h } from "../dom.js";
import { t } from "../text.js";

/** @import { MissionStore } from "./types.d.ts" */

const STAGES = [
  ["", t("Plan")],
  ["/rehearse", t("Rehearse")],
  ["/fly", t("Fly")],
  ["/report", t("Report")],
  ["/3d", "3D"],
];

/** @param {MissionStore} store */
export function mountStages(store) {
  if (document.querySelector(".stages")) return; // the page was made with them
  store.listen(["mission"], ({ mission }) => {
    if (!mission || document.querySelector(".stages")) return;
    const links = STAGES.map(([rest, words]) =>
      h("a", { href: `/missions/${mission.id}${rest}`, "aria-current": rest ? null : "page" }, words),
    );
    byId("others").after(h("nav", { class: "page-tabs stages", "aria-label": t("Stages of the mission") }, links));
  });
}
