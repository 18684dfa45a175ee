/** The row of a UAV of the fleet: whether it flies in this mission, its letter, its abilities and its battery level. */

import { find, h, icon } from "../../../dom.js";
import { routeNumber } from "../../../domain/palette.js";
import { markSimulated } from "../../../simulated.js";
import { t } from "../../../text.js";
import { percentText } from "../../../units.js";
import { canFly, factsOfUav } from "../../uavs/fleet.js";

/** @import { StandingUav } from "../../types.d.ts" */

/** @typedef {StandingUav & { grounded: string }} ShownUav `grounded`: why the plan does not use it */
/**
 * @typedef {object} RowActs
 * @property {() => void} look
 * @property {() => void} leave
 * @property {(isChosen: boolean) => void} choose
 * @property {() => void} change
 */

const LOW_BATTERY_PERCENT = 30;

/** @param {boolean} canPlan @param {RowActs} acts */
export function uavRow(canPlan, { look, leave, choose, change }) {
  const box = h("input", { type: "checkbox", class: "check" });
  box.addEventListener("change", () => choose(box.checked));
  return h(
    "li",
    { class: "uav", onpointerenter: look, onpointerleave: leave },
    h(
      canPlan ? "label" : "div",
      { class: "who" },
      canPlan && box,
      h("span", { class: "letter" }),
      h("span", { class: "name" }, h("span", { class: "called" }), h("small", {}), h("span", { class: "facts" })),
    ),
    h("span", { class: "battery" }),
    canPlan &&
      h(
        "button",
        {
          type: "button",
          class: "icon-button tight",
          title: t("Start, range, speed, battery, end, targets"),
          onclick: change,
        },
        icon("pencil", "small"),
      ),
  );
}

/** @param {HTMLElement} row @param {ShownUav} uav @param {{ canPlan: boolean, returnsToStart: boolean }} how */
export function refreshRow(row, uav, { canPlan, returnsToStart }) {
  const isChosen = uav.sequence !== null;
  if (canPlan) {
    const box = find(row, "input", HTMLInputElement);
    box.checked = isChosen;
    box.disabled = !isChosen && !canFly(uav);
  }
  const letter = find(row, ".letter");
  letter.className = `letter ${uav.sequence === null ? "none" : `route-${routeNumber(uav.sequence)}`}`;
  letter.textContent = uav.letter;
  const called = find(row, ".called");
  called.textContent = uav.name;
  markSimulated(called, Boolean(uav.is_simulated));
  find(row, "small").textContent = uav.base_name ?? "";
  const facts = find(row, ".facts");
  const trouble = uav.grounded || troubleOf(uav);
  const words = trouble || factsOfUav(uav, returnsToStart);
  facts.classList.toggle("grounded", Boolean(trouble));
  facts.textContent = words;
  find(row, ".name", HTMLElement).title = [uav.name, uav.base_name, words].filter(Boolean).join(", ");
  showBattery(find(row, ".battery", HTMLElement), uav.battery_percent ?? null);
  const change = row.querySelector("button");
  change?.setAttribute("aria-label", t("Change {name} in this mission", { name: uav.name }));
  change?.classList.toggle("absent", !isChosen);
}

/** @param {HTMLElement} place @param {number | null} percent */
function showBattery(place, percent) {
  const words = percent === null ? "" : percentText(percent);
  place.textContent = words;
  place.title = words && t("Battery {percent}", { percent: words });
  place.classList.toggle("low", percent !== null && percent < LOW_BATTERY_PERCENT);
}

/** Why a UAV cannot take off with any plan. @param {StandingUav} uav */
function troubleOf({ state, missing, isGone }) {
  if (isGone) return t("No longer in the fleet, or retired");
  if (state === "maintenance") return t("In maintenance");
  return missing?.length ? t("Incomplete: see its page") : "";
}
