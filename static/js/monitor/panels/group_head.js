/** The head of a mission's UAVs in the list of the live page. */

import { h, refill } from "../../dom.js";
import { t } from "../../text.js";

/** @import { MissionNumbers } from "../call_signs.js" */
/** @import { GroupHead } from "../fleet_groups.js" */

export const makeHead = () => h("li", { class: "group-head" });

/** @param {HTMLElement} element @param {GroupHead} head @param {MissionNumbers} numbers */
export function refreshHead(element, { mission, uavs, flying }, numbers) {
  const number = mission && numbers.size > 1 ? `${numbers.get(mission.id) ?? ""}` : "";
  const words = t("{flying} of {uavs} in the air", { flying, uavs });
  refill(element, JSON.stringify([mission?.name, number, words]), () => [
    number && h("span", { class: "mission-number" }, number),
    mission ? h("a", { href: `/missions/${mission.id}/fly` }, mission.name) : h("span", {}, t("Not in a mission")),
    h("span", { class: "quiet-text" }, words),
  ]);
}
