/** The row of a target: check box, pill, kind, name, second fact, deviations from the defaults, arrival, task, remove. */

import { find, h, icon } from "../../../dom.js";
import { routeNumber } from "../../../domain/palette.js";
import { t } from "../../../text.js";
import { nameOf } from "../../selection.js";
import { lockOf } from "../../targets/locks.js";
import {
  priorityOf,
  sensorWords,
  taskIcon,
  taskText,
  taskWord,
  uavOfTarget,
  whoMayFly,
} from "../../targets/target_menu.js";
import { isUsualTask, taskOf } from "../../tasks.js";

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
 * @property {(opener: HTMLElement) => void} openUav
 * @property {() => void} turnLock
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
 * @property {{ uav: string, index: number } | null} wished its place in the plan with its locks
 */

/** @type {Record<string, string>} */
const ICONS = { tower: "tower", line: "line", railway: "railway", bridge: "bridge", place: "map-pin" };

/** @param {PickedTarget} target @param {RowHandlers} handlers */
export function targetRow(
  target,
  { canPlan, light, press, pressKey, toggle, chooseUpTo, openTask, openUav, turnLock, remove },
) {
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
    canPlan && uavLine({ openUav, turnLock }),
  );
  row.addEventListener("keydown", (event) => pressKey(event, row));
  return row;
}

/** The second line: who flies it, and whether it stays there. @param {Pick<RowHandlers, "openUav" | "turnLock">} handlers */
const uavLine = ({ openUav, turnLock }) =>
  h(
    "span",
    { class: "target-uav", hidden: true },
    h("button", {
      type: "button",
      class: "task-chip uav-chip",
      "aria-haspopup": "true",
      "aria-expanded": "false",
      onclick: (event) => openUav(/** @type {HTMLElement} */ (event.currentTarget)),
    }),
    h("button", { type: "button", class: "icon-button tight lock", onclick: turnLock }),
  );

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
export function refreshRow(row, target, { place, isMissed, index, arrival, isChosen, canPlan, selection, wished }) {
  const pill = find(row, ":scope > .pill", HTMLElement);
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
  const second = [canPlan ? sensorWords(target) : whoMayFly(target), target.detail].filter(Boolean).join(" · ");
  find(row, ".what small").textContent = second;
  find(row, ".what", HTMLElement).title = nameOf({ ...target, detail: second });
  refreshMarks(find(row, ".target-marks", HTMLElement), target, canPlan ? null : lockOf(selection, target.key));
  const when = find(row, ".target-when", HTMLElement);
  when.textContent = arrival;
  when.title = arrival && t("Reached at {time}", { time: arrival });
  row.classList.toggle("chosen", isChosen);
  if (!canPlan) return;
  find(row, ".check", HTMLInputElement).checked = isChosen;
  refreshTask(find(row, ".task", HTMLElement), target);
  refreshUav(row, target, selection, wished);
}

/** @param {HTMLElement} row @param {PickedTarget} target @param {MissionSelection} selection @param {RowState["wished"]} wished */
function refreshUav(row, target, selection, wished) {
  const uav = uavOfTarget(target, selection);
  const isLocked = lockOf(selection, target.key) !== null;
  find(row, ".target-uav", HTMLElement).hidden = selection.uavs.length < 2 && uav === null;
  const chip = find(row, ".uav-chip", HTMLElement);
  const words = t("UAV: {name}", { name: uav ?? t("any") });
  if (chip.textContent !== words) {
    chip.replaceChildren(words, icon("chevron-down", "small"));
    chip.setAttribute("aria-label", `${words}, ${target.label}`);
    chip.classList.toggle("own", uav !== null);
  }
  const lock = find(row, ".lock", HTMLElement);
  lock.hidden = !wished && !isLocked;
  const place = { number: (wished?.index ?? 0) + 1, uav: wished?.uav ?? uav ?? "" };
  const title = isLocked
    ? t("Locked as target {number} of {uav}: unlock", place)
    : t("Lock as target {number} of {uav}", place);
  if (lock.title === title) return;
  lock.replaceChildren(icon(isLocked ? "lock" : "lock-open", "small"));
  lock.title = title;
  lock.setAttribute("aria-label", `${target.label}: ${title}`);
  lock.setAttribute("aria-pressed", String(isLocked));
}

/**
 * Show deviations from the defaults; empty without any.
 *
 * @param {HTMLElement} place
 * @param {PickedTarget} target
 * @param {ReturnType<typeof lockOf>} lock shown as a mark
 */
function refreshMarks(place, target, lock) {
  const { mark, label } = priorityOf(target);
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
  const title = t("{task}. Change task, priority", { task: words });
  if (button.title === title) return;
  button.replaceChildren(icon(taskIcon(task), "small"), h("span", { class: "task-word" }, taskWord(task)));
  button.title = title;
  button.setAttribute("aria-label", t("Task, priority of {name}: {task}", { name: target.label, task: words }));
  button.classList.toggle("own", !isUsualTask(target));
}
