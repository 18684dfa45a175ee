/** The list of targets: pill, kind, name, second fact, task, remove; and what is done with several of them at once. */

import { byId, h, icon, keyedList } from "../../../dom.js";
import { routeNumber } from "../../../domain/palette.js";
import { toggleMenu } from "../../../page/chrome.js";
import { t, tn } from "../../../text.js";
import { lockOf, ordersOf } from "../../locks.js";
import { inPlanOrder, isPlanCurrent, shownPlaces } from "../../plan_view.js";
import { arrivalsOf } from "../../route_times.js";
import { isUsualTask, isWhole, nameOf, taskOf } from "../../selection.js";
import { priorityOf, targetMenu, taskIcon, taskText, whoMayFly } from "../../target_menu.js";
import { mountChosenBar } from "./chosen_bar.js";

const SHOWN_FIRST = 40;
const ICONS = { tower: "tower", line: "line", railway: "railway", bridge: "bridge", place: "map-pin" };

export function mountTargets(store, actions, canPlan, showOnMap) {
  let showAll = false;
  let isChoosing = false;
  let anchor = null; // where a range with Shift begins
  let shown = { places: new Map(), missed: new Set(), order: [], arrivals: new Map() };
  const list = byId("target-list");
  const isChosen = (target) => store.state.chosenTargets.includes(target.key);

  function setChosen(keys) {
    if (canPlan && keys.length > 1) isChoosing = true;
    store.update({ chosenTargets: keys, chosenTarget: keys.at(-1) ?? null });
  }

  function toggle(target) {
    anchor = target.key;
    const { chosenTargets } = store.state;
    setChosen(isChosen(target) ? chosenTargets.filter((key) => key !== target.key) : [...chosenTargets, target.key]);
  }

  function chooseUpTo(target) {
    const from = Math.max(0, shown.order.indexOf(anchor ?? target.key));
    const to = shown.order.indexOf(target.key);
    const range = shown.order.slice(Math.min(from, to), Math.max(from, to) + 1);
    setChosen(from <= to ? range : range.reverse());
  }

  function press(event, target) {
    if (canPlan && event.shiftKey) chooseUpTo(target);
    else if (canPlan && (event.ctrlKey || event.metaKey || isChoosing)) toggle(target);
    else {
      anchor = target.key;
      setChosen([target.key]);
      showOnMap(target);
    }
  }

  /** What Delete means in a row: all that are chosen with it. */
  function removeFrom(target) {
    actions.removeTargets(isChosen(target) ? store.state.chosenTargets : [target.key]);
  }

  function more(target) {
    if (!isWhole(target) || target.asset === null) return [];
    if (target.kind === "line")
      return [{ icon: "tower", words: t("Add every tower of it"), act: () => actions.addTowersOf(target.asset) }];
    return [{ icon: "bridge", words: t("Add every bridge of it"), act: () => actions.addBridgesOf(target.asset) }];
  }

  function openTask(opener, key) {
    const target = store.state.selection.targets.find((candidate) => candidate.key === key);
    toggleMenu(opener, () =>
      targetMenu([target], actions, { ...store.state, orders: ordersOf(store.state.plan) }, more(target)),
    );
  }

  function make(target) {
    const check =
      canPlan &&
      h("input", { type: "checkbox", class: "check", "aria-label": t("Choose {name}", { name: target.label }) });
    const row = h(
      "li",
      {
        class: "target",
        onpointerenter: () => store.update({ litTarget: target.key }),
        onpointerleave: () => store.update({ litTarget: null }),
        onfocusin: () => store.update({ litTarget: target.key }),
        onfocusout: () => store.update({ litTarget: null }),
      },
      check,
      h("span", { class: "pill" }),
      icon(ICONS[target.kind] ?? "map-pin"),
      h(
        "button",
        { type: "button", class: "what", onclick: (event) => press(event, target) },
        h("span", {}, target.label),
        h("small", {}),
      ),
      h("span", { class: "target-marks" }),
      h("span", { class: "target-when" }),
      canPlan &&
        h("button", {
          type: "button",
          class: "icon-button tight task",
          "aria-haspopup": "true",
          "aria-expanded": "false",
          onclick: (event) => openTask(event.currentTarget, target.key),
        }),
      canPlan &&
        h(
          "button",
          {
            type: "button",
            class: "icon-button tight",
            "aria-label": t("Remove {name}", { name: target.label }),
            title: t("Remove (Del)"),
            onclick: () => actions.removeTargets([target.key]),
          },
          icon("x", "small"),
        ),
    );
    if (check) {
      check.addEventListener("click", (event) => {
        if (!event.shiftKey) return;
        event.preventDefault();
        chooseUpTo(target);
      });
      check.addEventListener("change", () => toggle(target));
    }
    row.addEventListener("keydown", (event) => pressKey(event, row, target));
    return row;
  }

  function pressKey(event, row, target) {
    if (event.key === "Delete" && canPlan) {
      event.preventDefault();
      event.stopPropagation();
      removeFrom(target);
      return;
    }
    const isArrow = event.key === "ArrowDown" || event.key === "ArrowUp";
    if (isArrow && event.altKey && canPlan && event.target.closest(".what")) {
      event.preventDefault();
      actions.shiftTarget(target.key, event.key === "ArrowDown" ? 1 : -1);
      return;
    }
    const part = [".what", ".check"].find((name) => event.target.matches(name));
    if (!isArrow || event.altKey || !part) return;
    const next = event.key === "ArrowDown" ? row.nextElementSibling : row.previousElementSibling;
    if (!next) return;
    event.preventDefault();
    next.querySelector(part).focus();
    const key = shown.order[[...list.children].indexOf(next)];
    const reached = store.state.selection.targets.find((candidate) => candidate.key === key);
    if (event.shiftKey && canPlan && reached) {
      anchor ??= target.key;
      chooseUpTo(reached);
    }
  }

  function refreshRow(row, target, index) {
    const place = shown.places.get(target.key);
    const isMissed = shown.missed.has(target.key);
    const pill = row.querySelector(".pill");
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
    row.querySelector("small").textContent = second;
    row.querySelector(".what").title = nameOf({ ...target, detail: second });
    refreshMarks(row.querySelector(".target-marks"), target);
    const when = row.querySelector(".target-when");
    when.textContent = shown.arrivals.get(target.key) ?? "";
    when.title = when.textContent && t("Reached at {time}", { time: when.textContent });
    row.classList.toggle("chosen", isChosen(target));
    if (!canPlan) return;
    row.querySelector(".check").checked = isChosen(target);
    refreshTask(row.querySelector(".task"), target);
  }

  /** What is not as usual, without a word where everything is. */
  function refreshMarks(place, target) {
    const { mark, said } = priorityOf(target);
    const lock = lockOf(store.state.selection, target.key);
    const marks = [mark && [mark, said], lock && ["lock", t("Locked to {uav}", { uav: lock.uav })]].filter(Boolean);
    const key = marks.join("|");
    if (place.dataset.key === key) return;
    place.dataset.key = key;
    place.replaceChildren(
      ...marks.map(([image, words]) =>
        h("span", { role: "img", "aria-label": words, title: words }, icon(image, "small")),
      ),
    );
  }

  function refreshTask(button, target) {
    const task = taskOf(target);
    const words = taskText(task);
    if (button.title === words) return;
    button.replaceChildren(icon(taskIcon(task), "small"));
    button.title = words;
    button.setAttribute("aria-label", t("Task of {name}: {task}", { name: target.label, task: words }));
    button.classList.toggle("own", !isUsualTask(target));
  }

  const draw = keyedList(list, (target) => target.key, make, refreshRow);

  function refresh(state) {
    const { targets } = state.selection;
    const { places, missed } = shownPlaces(state);
    const all = inPlanOrder(targets, places);
    shown = {
      places,
      missed,
      order: all.map((target) => target.key),
      arrivals: isPlanCurrent(state) ? arrivalsOf(state.plan) : new Map(),
    };
    isChoosing &&= targets.length > 1;
    list.classList.toggle("choosing", isChoosing);
    const visible = showAll ? all : all.slice(0, SHOWN_FIRST);
    draw(visible);
    const rest = all.length - visible.length;
    byId("show-more").hidden = rest === 0;
    byId("show-more").textContent = tn(rest, "Show {count} more", "Show {count} more");
    byId("target-count").textContent = all.length || "";
    byId("targets-empty").hidden = all.length > 0;
    if (!canPlan) return;
    byId("choose-targets").hidden = byId("clear-targets").hidden = all.length < 2;
    byId("choose-targets").setAttribute("aria-pressed", String(isChoosing));
    byId("undo").disabled = !state.canUndo;
    byId("redo").disabled = !state.canRedo;
    bar?.refresh(isChoosing);
  }

  let bar = null;
  byId("show-more").addEventListener("click", () => {
    showAll = true;
    refresh(store.state);
  });
  if (canPlan) {
    const stopChoosing = () => {
      isChoosing = false;
      setChosen([]);
      refresh(store.state);
    };
    bar = mountChosenBar(store, actions, { chooseAll: () => setChosen(shown.order), done: stopChoosing });
    byId("choose-targets").addEventListener("click", () => {
      if (isChoosing) return stopChoosing();
      isChoosing = true;
      refresh(store.state);
      return list.querySelector(".check")?.focus();
    });
    byId("clear-targets").addEventListener("click", () =>
      actions.removeTargets(store.state.selection.targets.map((target) => target.key)),
    );
    byId("undo").addEventListener("click", actions.undo);
    byId("redo").addEventListener("click", actions.redo);
  }

  // What is chosen elsewhere, such as by a pill on the map, is chosen alone; what is no longer picked is not chosen.
  store.listen(["chosenTarget", "selection"], ({ chosenTarget, chosenTargets, selection }) => {
    const known = new Set(selection.targets.map((target) => target.key));
    const kept = chosenTargets.filter((key) => known.has(key));
    if (chosenTarget !== null && known.has(chosenTarget) && !kept.includes(chosenTarget))
      store.update({ chosenTargets: [chosenTarget] });
    else if (chosenTarget === null && kept.length) store.update({ chosenTargets: [] });
    else if (kept.length !== chosenTargets.length)
      store.update({ chosenTargets: kept, chosenTarget: kept.at(-1) ?? null });
  });
  store.listen(["selection", "plan", "chosenTargets", "canUndo", "canRedo"], refresh);
}
