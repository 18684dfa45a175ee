/** Tasks, priority and UAV of targets: texts, and the menu that sets them for one, several or all. */

import { gsdText } from "../../cameras/words.js";
import { h, icon } from "../../dom.js";
import { closeMenu } from "../../page/chrome.js";
import { t, tn } from "../../text.js";
import { durationText, SPEED_UNIT, speedText } from "../../units.js";
import { sensorsKnown, wishesOf } from "../selection.js";
import { canHaveViews, INSPECTION_SPEEDS_MPS, isWhole, MAX_HOLD_S, taskOf } from "../tasks.js";
import { uavsByName } from "../uavs/mission_uavs.js";
import { lockOf, wishedPlace } from "./locks.js";

/** @import { FlownOrder, MissionActions, MissionPageState, MissionSelection, PickedTarget, Task, Wishes } from "../types.d.ts" */

/** @typedef {Pick<MissionPageState, "selection" | "fleet"> & { orders: FlownOrder[] }} Known what the menu is made from */
/** @typedef {{ icon: string, words: string, act: () => unknown }} MenuItem */
/** @typedef {(targets: PickedTarget[]) => void} PlanViews */

/** @type {{ kind: Task["kind"], icon: string, words: () => string, word: () => string }[]} the word is for a chip */
export const TASKS = [
  { kind: "look", icon: "eye", words: () => t("Fly-by"), word: () => t("Fly-by") },
  { kind: "photo", icon: "camera", words: () => t("Take photos"), word: () => t("Photos") },
  { kind: "hold", icon: "timer", words: () => t("Hover"), word: () => t("Hover") },
];

const VIEWS_WORDS = { detail: t("Every part"), overview: t("Overview"), spans: t("Wires") };

/** @param {Task} task */
export function taskIcon(task) {
  if (task.views) return "aperture";
  return (TASKS.find(({ kind }) => kind === task.kind) ?? TASKS[0]).icon;
}

/** "Photos" @param {Task} task */
export function taskWord({ kind, views, speed_mps }) {
  if (views) return VIEWS_WORDS[views.pattern ?? "detail"];
  const word = (TASKS.find((task) => task.kind === kind) ?? TASKS[0]).word();
  return speed_mps ? `${word} ${speedText(speed_mps)}` : word;
}

/** "Take photos, 10 s" @param {Task} task */
export function taskText(task) {
  if (task.views?.pattern === "overview") return t("Overview from four sides");
  if (task.views?.pattern === "spans")
    return t("Photograph the wires from both sides, GSD {gsd}", { gsd: gsdText(task.views.gsd_mm) });
  if (task.views) return t("Photograph every part, GSD {gsd}", { gsd: gsdText(task.views.gsd_mm) });
  const { words } = TASKS.find(({ kind }) => kind === task.kind) ?? TASKS[0];
  return [words(), task.hold_s && secondsText(task.hold_s), task.speed_mps && speedText(task.speed_mps)]
    .filter(Boolean)
    .join(", ");
}

/** @param {number} seconds */
const secondsText = (seconds) => (seconds >= 600 ? durationText(seconds) : `${seconds}\u00a0s`);

/** @type {{ value: Wishes["priority"], words: string, mark: string | null, label: string }[]} */
export const PRIORITIES = [
  { value: "low", words: t("Low"), mark: "chevrons-down", label: t("Low priority") },
  { value: "normal", words: t("Normal"), mark: null, label: "" },
  { value: "high", words: t("High"), mark: "chevrons-up", label: t("High priority") },
];

/** @param {PickedTarget} target */
export const priorityOf = (target) =>
  PRIORITIES.find(({ value }) => value === wishesOf(target).priority) ?? PRIORITIES[1];

/** "needs LiDAR" @param {PickedTarget} target */
export function sensorWords(target) {
  const { sensor } = wishesOf(target);
  return sensor && t("needs {sensor}", { sensor });
}

/** "only Heron · needs LiDAR": who may fly a target. @param {PickedTarget} target */
export function whoMayFly(target) {
  const { uav } = wishesOf(target);
  return [uav !== null && t("only {uav}", { uav }), sensorWords(target)].filter(Boolean).join(" · ");
}

/** @param {string[]} names @returns {[string, string][]} */
const namesToChoose = (names) => names.map((name) => [name, name]);

/** A line of the menu, which closes by it. @param {MenuItem} item */
function menuItem(item) {
  const choose = () => {
    closeMenu();
    item.act();
  };
  return h("button", { type: "button", onclick: choose }, icon(item.icon), item.words);
}

const MIXED = "\u0000"; // the choice of several targets that differ

/**
 * A list to choose from; `values` are what the targets have now.
 *
 * @param {string} label
 * @param {string[]} values
 * @param {[string, string][]} choices
 * @param {(value: string) => unknown} set
 */
function choiceOf(label, values, choices, set) {
  const isMixed = new Set(values).size > 1;
  const list = h(
    "select",
    { class: "input", "aria-label": label },
    isMixed && h("option", { value: MIXED, selected: true, disabled: true }, t("different")),
    choices.map(([value, words]) => h("option", { value, selected: !isMixed && values[0] === value }, words)),
  );
  list.addEventListener("change", () => {
    closeMenu();
    set(list.value);
  });
  return h("label", { class: "target-choice" }, h("span", {}, label), list);
}

/**
 * Choices of priority, UAV and sensor.
 *
 * @param {PickedTarget[]} targets
 * @param {MissionActions} actions
 * @param {Known} known
 */
function wishChoices(targets, actions, { selection, fleet }) {
  const keys = targets.map(({ key }) => key);
  const wishes = targets.map(wishesOf);
  const sensors = sensorsKnown(selection, fleet);
  const uavs = uavsByName(selection);
  return [
    choiceOf(
      t("Priority"),
      wishes.map(({ priority }) => priority),
      PRIORITIES.map(({ value, words }) => [value, words]),
      (priority) => actions.setWish(keys, { priority: /** @type {Wishes["priority"]} */ (priority) }),
    ),
    targets.length > 1 && // of one its row has the choice
      uavs.length > 0 &&
      choiceOf(
        t("Required UAV"),
        wishes.map(({ uav }) => uav ?? ""),
        [["", t("any")], ...namesToChoose(uavs.map(({ name }) => name))],
        (name) => actions.tieTargets(keys, name || null),
      ),
    sensors.length > 0 &&
      !targets.some((target) => taskOf(target).views) && // their camera is needed
      choiceOf(
        t("Required sensor"),
        wishes.map(({ sensor }) => sensors.find((name) => name.toLowerCase() === sensor.trim().toLowerCase()) ?? ""),
        [["", t("none|sensor")], ...namesToChoose(sensors)],
        (sensor) => actions.setWish(keys, { sensor }),
      ),
  ];
}

/**
 * When a target is flown in the order of its UAV: what dragging its pill does. `orders` are the plan's: see locks.js.
 *
 * @param {PickedTarget} target
 * @param {MissionActions} actions
 * @param {Known} known
 */
function placeChoices({ key }, actions, { selection, orders }) {
  const place = wishedPlace(orders, selection, key);
  /** @param {string} image @param {string} words @param {number} step */
  const shift = (image, words, step) => menuItem({ icon: image, words, act: () => actions.shiftTarget(key, step) });
  return [
    place && place.index > 0 && shift("chevron-up", t("Earlier"), -1),
    place && place.index < place.last && shift("chevron-down", t("Later"), 1),
  ].filter(Boolean);
}

/** The UAV that a target is locked or tied to; null: any. @param {PickedTarget} target @param {Pick<MissionSelection, "locks">} selection */
export const uavOfTarget = (target, selection) => lockOf(selection, target.key)?.uav ?? wishesOf(target).uav;

/**
 * The menu that ties a target to one UAV, or to none.
 *
 * @param {PickedTarget} target
 * @param {MissionActions} actions
 * @param {MissionSelection} selection
 */
export function uavMenu(target, actions, selection) {
  const chosen = uavOfTarget(target, selection);
  const names = uavsByName(selection).map(({ name }) => name);
  /** @param {string | null} name */
  const choice = (name) => {
    const choose = () => {
      closeMenu();
      if (name !== chosen) actions.tieTargets([target.key], name);
    };
    return h(
      "button",
      { type: "button", "aria-pressed": String(name === chosen), onclick: choose },
      name ?? t("Any UAV"),
      name === chosen && h("span", { class: "end" }, icon("check", "small")),
    );
  };
  return h(
    "div",
    { class: "menu float target-menu", role: "group", "aria-label": t("UAV of {target}", { target: target.label }) },
    [null, ...names].map(choice),
  );
}

/** @param {number} speed_mps */
const withinLimits = (speed_mps) => Math.min(Math.max(speed_mps, INSPECTION_SPEEDS_MPS[0]), INSPECTION_SPEEDS_MPS[1]);

/**
 * The speed along lines, at most; empty: as the UAV flies.
 *
 * @param {Task[]} tasks
 * @param {(task: Task) => void} set
 */
function speedForm(tasks, set) {
  const speeds = new Set(tasks.map(({ speed_mps }) => speed_mps ?? null));
  const [least, most] = INSPECTION_SPEEDS_MPS;
  /** @param {number} mps */
  const typed = (mps) => String(Math.round((mps / SPEED_UNIT.mps) * 10) / 10);
  const [{ speed_mps: present }] = tasks;
  const input = h("input", {
    class: "input",
    type: "number",
    min: typed(least),
    max: typed(most),
    step: "any",
    placeholder: speeds.size === 1 ? t("any") : t("several"),
    title: t("Empty: as the UAV flies"),
    value: speeds.size === 1 && present ? typed(present) : "",
    id: "task-speed",
  });
  /** @param {SubmitEvent} event */
  const submit = (event) => {
    event.preventDefault();
    const isEmpty = Number.isNaN(input.valueAsNumber);
    if (isEmpty && speeds.size > 1) closeMenu();
    else set({ kind: "look", speed_mps: isEmpty ? null : withinLimits(input.valueAsNumber * SPEED_UNIT.mps) });
  };
  return h(
    "form",
    { class: "task-seconds", onsubmit: submit },
    h("label", { for: "task-speed" }, t("Inspection speed")),
    h("div", { class: "with-unit" }, input, h("span", { class: "unit" }, SPEED_UNIT.unit)),
    h("button", { class: "button" }, t("Set")),
  );
}

/**
 * The menu for these targets; `known` is { selection, fleet, orders }, `more` are additional acts: [{ icon, words, act }]. planViews
 * lets the user plan photos of towers.
 *
 * @param {PickedTarget[]} targets
 * @param {MissionActions} actions
 * @param {Known} known
 * @param {{ more?: MenuItem[], planViews?: PlanViews }} [acts]
 */
export function targetMenu(targets, actions, known, { more = [], planViews } = {}) {
  const keys = targets.map((target) => target.key);
  const tasks = targets.map(taskOf);
  const haveViews = tasks.every((task) => task.views);
  const kinds = new Set(tasks.map((task) => (task.views ? "views" : task.kind)));
  const times = new Set(tasks.map((task) => task.hold_s));
  const only = kinds.size === 1 && !haveViews ? tasks[0].kind : null;
  /** @param {Task} task */
  const set = (task) => {
    closeMenu();
    actions.setTask(keys, task);
  };
  const seconds = h("input", {
    class: "input",
    type: "number",
    min: "0",
    max: String(MAX_HOLD_S),
    step: "1",
    required: true,
    value: times.size === 1 ? String(tasks[0].hold_s) : "",
    id: "task-seconds",
  });
  seconds.addEventListener("keydown", (event) => {
    if (event.key === "ArrowUp" || event.key === "ArrowDown") event.stopPropagation(); // counts, and does not leave the field
  });
  /** @param {SubmitEvent} event */
  const submit = (event) => {
    event.preventDefault();
    set({ kind: haveViews ? "photo" : (only ?? "hold"), hold_s: Math.round(seconds.valueAsNumber) });
  };
  function openViews() {
    closeMenu();
    planViews?.(targets);
  }
  const placing = targets.length === 1 ? placeChoices(targets[0], actions, known) : [];
  const title = targets.length === 1 ? targets[0].label : tn(targets.length, "{count} target", "{count} targets");
  return h(
    "div",
    {
      class: "menu float target-menu",
      role: "group",
      "aria-label":
        targets.length === 1
          ? t("Task, priority: {name}", { name: title })
          : t("Task, priority, UAV: {name}", { name: title }),
    },
    h("p", { class: "caption" }, title),
    TASKS.map(({ kind, icon: sign, words }) =>
      h(
        "button",
        { type: "button", "aria-pressed": String(only === kind), onclick: () => set({ kind }) },
        icon(sign),
        words(),
        only === kind && h("span", { class: "end" }, icon("check", "small")),
      ),
    ),
    planViews &&
      targets.every(canHaveViews) &&
      h(
        "button",
        { type: "button", "aria-pressed": String(haveViews), onclick: openViews },
        icon("aperture"),
        t("Plan photos…"),
        haveViews && h("span", { class: "end" }, icon("check", "small")),
      ),
    h(
      "form",
      { class: "task-seconds", onsubmit: submit },
      h("label", { for: "task-seconds" }, haveViews ? t("Hover time per photo") : t("Hover time")),
      h("div", { class: "with-unit" }, seconds, h("span", { class: "unit" }, "s")),
      h("button", { class: "button" }, t("Set")),
    ),
    targets.every(isWhole) && tasks.every(({ kind }) => kind === "look") && speedForm(tasks, set),
    h("hr", {}),
    h("p", { class: "caption" }, t("Priority and requirements")),
    wishChoices(targets, actions, known),
    placing.length > 0 && [h("hr", {}), h("p", { class: "caption" }, t("Place in the plan"))],
    placing,
    more.length > 0 && h("hr", {}),
    more.map(menuItem),
  );
}
