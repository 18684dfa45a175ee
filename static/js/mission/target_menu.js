/** What is done at targets: words, and the menu that sets it for one, several or all. */

import { h, icon } from "../dom.js";
import { closeMenu } from "../page/chrome.js";
import { t, tn } from "../text.js";
import { durationText } from "../units.js";
import { LONGEST_HOLD_S, taskOf } from "./selection.js";

export const TASKS = [
  { kind: "look", icon: "eye", words: () => t("Look in passing") },
  { kind: "photo", icon: "camera", words: () => t("Take photos") },
  { kind: "hold", icon: "timer", words: () => t("Hold over it") },
];

export function taskIcon(task) {
  return TASKS.find(({ kind }) => kind === task.kind).icon;
}

/** "Take photos, 10 s" */
export function taskText(task) {
  const { words } = TASKS.find(({ kind }) => kind === task.kind);
  return task.hold_s > 0 ? `${words()}, ${secondsText(task.hold_s)}` : words();
}

const secondsText = (seconds) => (seconds >= 600 ? durationText(seconds) : `${seconds}\u00a0s`);

/** The menu for these targets; `more` are acts besides: [{ icon, words, act }]. */
export function targetMenu(targets, actions, more = []) {
  const keys = targets.map((target) => target.key);
  const tasks = targets.map(taskOf);
  const kinds = new Set(tasks.map((task) => task.kind));
  const times = new Set(tasks.map((task) => task.hold_s));
  const only = kinds.size === 1 ? tasks[0].kind : null;
  const set = (task) => {
    closeMenu();
    actions.setTask(keys, task);
  };
  const seconds = h("input", { class: "input", type: "number", min: "0", max: String(LONGEST_HOLD_S), step: "1", required: true, value: times.size === 1 ? String(tasks[0].hold_s) : "", id: "task-seconds" });
  seconds.addEventListener("keydown", (event) => {
    if (event.key === "ArrowUp" || event.key === "ArrowDown") event.stopPropagation(); // counts, and does not leave the field
  });
  const submit = (event) => {
    event.preventDefault();
    set({ kind: only ?? "hold", hold_s: Math.round(seconds.valueAsNumber) });
  };
  const title = targets.length === 1 ? targets[0].label : tn(targets.length, "{count} target", "{count} targets");
  return h(
    "div",
    { class: "menu float target-menu", role: "group", "aria-label": t("Task: {name}", { name: title }) },
    h("p", { class: "caption" }, title),
    TASKS.map(({ kind, icon: sign, words }) =>
      h("button", { type: "button", "aria-pressed": String(only === kind), onclick: () => set({ kind }) }, icon(sign), words(), only === kind && h("span", { class: "end" }, icon("check", "small"))),
    ),
    h(
      "form",
      { class: "task-seconds", onsubmit: submit },
      h("label", { for: "task-seconds" }, t("Stays")),
      h("div", { class: "with-unit" }, seconds, h("span", { class: "unit" }, "s")),
      h("button", { class: "button" }, t("Set")),
    ),
    more.length > 0 && h("hr", {}),
    more.map((item) => h("button", { type: "button", onclick: () => (closeMenu(), item.act()) }, icon(item.icon), item.words)),
  );
}
