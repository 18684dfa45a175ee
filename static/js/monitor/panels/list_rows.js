/**
 * Rows of the list: the head of a mission's UAVs, and a UAV in one row of 56 px: call sign, state, battery, height, age, next target and
 * its time.
 */

import { h, icon, refill } from "../../dom.js";
import { alarmOf } from "../../domain/order.js";
import { t } from "../../text.js";
import { letterOf } from "../call_signs.js";
import { UNKNOWN } from "../card_figures.js";
import { stateOf } from "../text/uav_text.js";

/** @import { AlertLevel } from "../../api_types.d.ts" */
/** @import { Figure } from "../card_figures.js" */
/** @import { MissionNumbers } from "../call_signs.js" */
/** @import { GroupHead } from "../fleet_groups.js" */
/** @import { LiveUav, MonitorState } from "../types.d.ts" */

/** @type {Record<AlertLevel, { image: string, words: string }>} */
const LEVELS = {
  critical: { image: "octagon-alert", words: t("Critical alert") },
  warning: { image: "triangle-alert", words: t("Warning") },
  advisory: { image: "info", words: t("Advisory") },
};

/** @param {Pick<Figure, "figure" | "unit">} figure */
const inOneLine = ({ figure, unit }) => (unit ? `${figure}\u00a0${unit}` : figure);

export class UavRow {
  #letter = h("span", { class: "letter" });
  #name = h("strong", {});
  #alarm = h("span", { class: "row-alarm" });
  #state = h("span", { class: "row-state" });
  #age = h("span", { class: "age" });
  #figures = h("span", { class: "row-figures" });
  #next = h("span", { class: "row-next" });

  /** @param {() => void} onclick */
  constructor(onclick) {
    this.element = h(
      "button",
      { type: "button", class: "card-row", "aria-pressed": "false", onclick },
      h("span", { class: "row-line" }, this.#letter, this.#name, this.#alarm, this.#state, this.#age),
      h("span", { class: "row-line row-facts" }, this.#figures, this.#next),
    );
  }

  /**
   * @param {LiveUav} uav
   * @param {Readonly<MonitorState>} state
   * @param {Figure[]} figures of its card
   */
  show(uav, { alerts, chosen, numbers }, [battery, height, , , next, age]) {
    this.element.setAttribute("aria-pressed", `${uav.id === chosen}`);
    this.#letter.textContent = letterOf(uav, numbers) || "–";
    this.#name.textContent = uav.name;
    const level = alarmOf(uav.id, alerts);
    this.#alarm.className = `row-alarm ${level ?? ""}`;
    refill(this.#alarm, `${level}`, () =>
      level ? [icon(LEVELS[level].image, "small"), h("span", { class: "unseen" }, LEVELS[level].words)] : [],
    );
    const summary = stateOf(uav);
    this.#state.textContent = summary.words;
    this.#state.className = `row-state ${summary.level ?? ""}`;
    this.#age.textContent = inOneLine(age);
    this.#age.classList.toggle("late", age.level !== "");
    this.#age.title = age.title;
    refill(this.#figures, JSON.stringify([battery, height]), () =>
      [battery, height].map(({ figure, unit, words, level: own }) =>
        h("span", { class: own || null }, h("span", { class: "unseen" }, `${words} `), inOneLine({ figure, unit })),
      ),
    );
    refill(this.#next, JSON.stringify(next), () =>
      next.figure === UNKNOWN ? [] : [`${next.words} `, h("strong", {}, inOneLine(next))],
    );
  }
}

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
