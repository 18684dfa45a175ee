/** The row of a target: check box, pill, kind, name, second fact, deviations from the defaults, arrival, task, remove. */

import { find, h, icon } from "../../../dom.js";
import { routeNumber } from "../../../domain/palette.js";
import { t } from "../../../text.js";
import { isUsualTask, nameOf, taskOf } from "../../selection.js";
import { lockOf } from "../../targets/locks.js";
import { priorityOf, taskIcon, taskText, taskWord, whoMayFly } from "../../targets/target_menu.js";

/** @import { MissionSelection, PickedTarget } from "../../types.d.ts" */

/**
 * @typedef {object} RowHandlers
 * @property {boolean} canPlan
 * @property {(isLit: boolean) => void} light
 * @property {(event: MouseEvent) => void} press
 * @property {(event: KeyboardEvent, row: HTMLElement) => void} pressKey
 * @property {() => void} toggle
 * @property {() => void} chooseUpTo
 * @property {(opener: HTMLElement) => void} openTask
 * @property {() => void} remove
 */
/**
 * @typedef {object} RowState
 * @property {{ sequence: number, letter: string, number: number } | undefined} place in the plan
 * @property {boolean} isMissed
 * @property {number} index in the list
 * @property {string} arrival
 * @property {boolean} isChosen
 * @property {boolean} canPlan
 * @property {MissionSelection} selection
 */

/** @type {Record<string, string>} */
const ICONS = { tower: "tower", line: "line", railway: "railway", bridge: "bridge", place: "map-pin" };

/** @param {PickedTarget} target @param {RowHandlers} handlers */
export function targetRow(target, { canPlan, light, press, pressKey, toggle, chooseUpTo, openTask, remove }) {
  const row = h(
    "li",
    {
      class: "target",
      onpointerenter: () => light(true),
      onpointerleave: () => light(false),
      onfocusin: () => light(true),
      onfocusout: () => light(false),
    },
    canPlan && checkBox(target, { toggle, chooseUpTo }),
    h("span", { class: "pill" }),
    icon(ICONS[target.kind] ?? "map-pin"),
    h("button", { type: "button", class: "what", onclick: press }, h("span", {}, target.label), h("small", {})),
    h("span", { class: "target-marks" }),
    h("span", { class: "target-when" }),
    canPlan &&
      h("button", {
        type: "button",
        class: "task-chip task",
        "aria-haspopup": "true",
        "aria-expanded": "false",
        onclick: (event) => openTask(/** @type {HTMLElement} */ (event.currentTarget)),
      }),
    canPlan &&
      h(
        "button",
        {
          type: "button",
          class: "icon-button tight",
          "aria-label": t("Remove {name}", { name: target.label }),
          title: t("Remove (Del)"),
          onclick: remove,
        },
        icon("x", "small"),
      ),
  );
  row.addEventListener("keydown", (event) => pressKey(event, row));
  return row;
}

/** @param {PickedTarget} target @param {Pick<RowHandlers, "toggle" | "chooseUpTo">} handlers */
function checkBox({ label }, { toggle, chooseUpTo }) {
  const box = h("input", { type: "checkbox", class: "check", "aria-label": t("Choose {name}", { name: label }) });
  box.addEventListener("click", (event) => {
    if (!event.shiftKey) return;
    event.preventDefault();
    chooseUpTo();
  });
  box.addEventListener("change", toggle);
  return box;
}

/** @param {HTMLElement} row @param {PickedTarget} target @param {RowState} state */
export function refreshRow(row, target, { place, isMissed, index, arrival, isChosen, canPlan, selection }) {
  const pill = find(row, ".pill", HTMLElement);
  pill.className = `pill ${place ? `route-${routeNumber(place.sequence)}` : isMissed ? "missed" : "waiting"}`;
  pill.textContent = place ? `${place.letter}${place.number}` : isMissed ? "×" : `${index + 1}`;
  pill.setAttribute(
    "aria-label",
    place
      ? t("Target {number} of UAV {letter}", { number: place.number, letter: place.letter })
      : isMissed
        ? t("Not reached")
        : t("Not planned yet"),
  );
  const second = [whoMayFly(target), target.detail].filter(Boolean).join(" · ");
  find(row, ".what small").textContent = second;
  find(row, ".what", HTMLElement).title = nameOf({ ...target, detail: second });
  refreshMarks(find(row, ".target-marks", HTMLElement), target, selection);
  const when = find(row, ".target-when", HTMLElement);
  when.textContent = arrival;
  when.title = arrival && t("Reached at {time}", { time: arrival });
  row.classList.toggle("chosen", isChosen);
  if (!canPlan) return;
  find(row, ".check", HTMLInputElement).checked = isChosen;
  refreshTask(find(row, ".task", HTMLElement), target);
}

/**
 * Show deviations from the defaults; empty without any.
 *
 * @param {HTMLElement} place
 * @param {PickedTarget} target
 * @param {MissionSelection} selection
 */
function refreshMarks(place, target, selection) {
  const { mark, label } = priorityOf(target);
  const lock = lockOf(selection, target.key);
  /** @type {[string, string][]} */
  const marks = [
    .../** @type {[string, string][]} */ (mark ? [[mark, label]] : []),
    .../** @type {[string, string][]} */ (lock ? [["lock", t("Locked to {uav}", { uav: lock.uav })]] : []),
  ];
  const key = marks.join("|");
  if (place.dataset.key === key) return;
  place.dataset.key = key;
  place.replaceChildren(
    ...marks.map(([image, words]) =>
      h("span", { role: "img", "aria-label": words, title: words }, icon(image, "small")),
    ),
  );
}

/** @param {HTMLElement} button @param {PickedTarget} target */
function refreshTask(button, target) {
  const task = taskOf(target);
  const words = taskText(task);
  const title = t("{task}. Change task, priority, UAV", { task: words });
  if (button.title === title) return;
  button.replaceChildren(icon(taskIcon(task), "small"), h("span", { class: "task-word" }, taskWord(task)));
  button.title = title;
  button.setAttribute("aria-label", t("Task, priority, UAV of {name}: {task}", { name: target.label, task: words }));
  button.classList.toggle("own", !isUsualTask(target));
}
