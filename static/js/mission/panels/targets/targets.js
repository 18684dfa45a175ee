/** The list of targets, and acts on several of them at once. */

import { byId, h, keyedList } from "../../../dom.js";
import { toggleMenu } from "../../../page/chrome.js";
import { t, tn } from "../../../text.js";
import { openViewPlan } from "../../../view_plan/panel.js";
import { inPlanOrder, isPlanCurrent, shownPlaces } from "../../plan/plan_view.js";
import { arrivalsOf } from "../../plan/route_times.js";
import { lockOf, ordersOf, wishedPlace } from "../../targets/locks.js";
import { targetMenu, taskIcon, taskText, taskWord, uavMenu } from "../../targets/target_menu.js";
import { isWhole, taskOf } from "../../tasks.js";
import { createChoosing } from "./choosing.js";
import { mountChosenBar } from "./chosen_bar.js";
import { createGroups } from "./group.js";
import { refreshRow, targetRow } from "./row.js";

/** @import { FlownOrder, MissionActions, MissionPageState, MissionStore, PickedTarget } from "../../types.d.ts" */
/** @import { mountMap } from "../../map/map_panel.js" */
/** @import { PlanViews } from "../../targets/target_menu.js" */
/** @import { Choosing } from "./choosing.js" */
/** @typedef {Awaited<ReturnType<typeof mountMap>["ground"]>} MapGround */
/** @import { GroupActs } from "./group.js" */

/**
 * What the rows are drawn from.
 *
 * @typedef {object} Shown
 * @property {ReturnType<typeof shownPlaces>["places"]} places
 * @property {ReturnType<typeof shownPlaces>["missed"]} missed
 * @property {string[]} order keys
 * @property {string[]} visible keys of the rows
 * @property {ReturnType<typeof arrivalsOf>} arrivals
 * @property {FlownOrder[]} orders of the plan
 */

const SHOWN_FIRST = 40;

/**
 * @param {MissionStore} store
 * @param {MissionActions} actions
 * @param {boolean} canPlan
 * @param {{ show: (target: PickedTarget) => unknown, ground: Promise<MapGround> }} map
 */
export function mountTargets(store, actions, canPlan, map) {
  let showAll = false;
  /** @type {Shown} */
  let shown = { places: new Map(), missed: new Set(), order: [], visible: [], arrivals: new Map(), orders: [] };
  const list = byId("target-list");
  const planViews = viewPlanning(list, actions, map);
  const groups = createGroups(() => refresh(store.state), SHOWN_FIRST, groupActs(store, actions, canPlan, planViews));
  const choosing = createChoosing(store, { canPlan, order: () => shown.order });
  const bar = canPlan
    ? mountChoosing(list, store, actions, { choosing, planViews, refresh: () => refresh(store.state) })
    : null;

  /** @param {MouseEvent} event @param {PickedTarget} target */
  function press(event, target) {
    if (canPlan && event.shiftKey) choosing.upTo(target);
    else if (canPlan && (event.ctrlKey || event.metaKey || choosing.isOn())) choosing.toggle(target);
    else {
      choosing.only(target);
      map.show(target);
    }
  }

  /** @param {PickedTarget} target */
  const make = (target) =>
    targetRow(target, {
      canPlan,
      light: (isLit) => store.update({ litTarget: isLit ? target.key : null }),
      press: (event) => press(event, target),
      pressKey: (event, row) =>
        pressKey(event, row, target, {
          store,
          actions,
          canPlan,
          choosing,
          groups,
          keyAt: (index) => shown.visible[index],
        }),
      toggle: () => choosing.toggle(target),
      chooseUpTo: () => choosing.upTo(target),
      ...menusOf(target.key, store, actions, planViews),
      remove: () => actions.removeTargets([target.key]),
    });

  const draw = keyedList(
    list,
    /** @param {PickedTarget} target */ (target) => target.key,
    make,
    (row, target) => {
      refreshRow(row, target, {
        place: shown.places.get(target.key),
        isMissed: shown.missed.has(target.key),
        index: shown.order.indexOf(target.key),
        arrival: shown.arrivals.get(target.key) ?? "",
        isChosen: choosing.isChosen(target),
        canPlan,
        selection: store.state.selection,
        wished: wishedPlace(shown.orders, store.state.selection, target.key),
      });
      groups.refresh(row, target, shown.places);
    },
  );

  /** @param {MissionPageState} state */
  function refresh(state) {
    const { targets } = state.selection;
    const { places, missed } = shownPlaces(state);
    const all = inPlanOrder(targets, places);
    const arrivals = isPlanCurrent(state) ? arrivalsOf(state.plan) : new Map();
    if (targets.length <= 1) choosing.turn(false);
    list.classList.toggle("choosing", choosing.isOn());
    const unfolded = choosing.isOn() ? groups.none(all) : groups.unfolded(all, places);
    const visible = showAll ? unfolded : unfolded.slice(0, SHOWN_FIRST);
    const [order, rows] = [all, visible].map((listed) => listed.map((target) => target.key));
    shown = { places, missed, order, visible: rows, arrivals, orders: ordersOf(state.plan) };
    draw(visible);
    const rest = unfolded.length - visible.length;
    byId("show-more").hidden = rest === 0;
    byId("show-more").textContent = tn(rest, "Show {count} more", "Show {count} more");
    byId("target-count").textContent = all.length ? `${all.length}` : "";
    byId("targets-empty").hidden = all.length > 0 || state.arrival !== "whole";
    bar?.refresh(state);
  }

  byId("show-more").addEventListener("click", () => {
    showAll = true;
    refresh(store.state);
  });
  keepChosenKnown(store);
  store.listen(["selection", "plan", "chosenTargets", "canUndo", "canRedo", "arrival"], refresh);
}

/**
 * The buttons over the list, and the bar below it for several.
 *
 * @param {HTMLElement} list
 * @param {MissionStore} store
 * @param {MissionActions} actions
 * @param {{ choosing: Choosing, planViews: PlanViews, refresh: () => void }} how
 */
function mountChoosing(list, store, actions, { choosing, planViews, refresh }) {
  const keys = () => store.state.selection.targets.map((target) => target.key);
  const choose = byId("choose-targets");
  const clear = byId("clear-targets");
  const stop = () => {
    choosing.turn(false);
    choosing.choose([]);
    refresh();
  };
  const bar = mountChosenBar(store, actions, { chooseAll: choosing.all, done: stop, planViews });
  choose.addEventListener("click", () => {
    if (choosing.isOn()) {
      stop();
      return;
    }
    choosing.turn(true);
    refresh();
    /** @type {HTMLElement | null} */ (list.querySelector(".check"))?.focus();
  });
  clear.addEventListener("click", () => actions.removeTargets(keys()));
  byId("undo").addEventListener("click", actions.undo);
  byId("redo").addEventListener("click", actions.redo);
  return {
    /** @param {MissionPageState} state */
    refresh({ selection, canUndo, canRedo }) {
      choose.hidden = selection.targets.length < 2;
      clear.hidden = selection.targets.length < 2;
      choose.setAttribute("aria-pressed", String(choosing.isOn()));
      byId("undo", HTMLButtonElement).disabled = !canUndo;
      byId("redo", HTMLButtonElement).disabled = !canRedo;
      bar.refresh(choosing.isOn());
    },
  };
}

/**
 * What can be done with a folded group: its tasks at once, and what can be done with the whole line.
 *
 * @param {MissionStore} store
 * @param {MissionActions} actions
 * @param {boolean} canPlan
 * @param {PlanViews} planViews
 * @returns {GroupActs | null} null for those who may not change the mission
 */
function groupActs(store, actions, canPlan, planViews) {
  /** @param {string[]} keys */
  function targetsOf(keys) {
    const wanted = new Set(keys);
    return store.state.selection.targets.filter(({ key }) => wanted.has(key));
  }
  if (!canPlan) return null;
  return {
    remove: actions.removeTargets,
    taskOf(keys) {
      const tasks = targetsOf(keys).map(taskOf);
      return new Set(tasks.map(taskText)).size === 1
        ? { image: taskIcon(tasks[0]), word: taskWord(tasks[0]), words: taskText(tasks[0]) }
        : { image: "list-checks", word: t("several"), words: t("several tasks") };
    },
    openTask(keys, opener) {
      const targets = targetsOf(keys);
      const known = { ...store.state, orders: ordersOf(store.state.plan) };
      toggleMenu(opener, () => targetMenu(targets, actions, known, { more: more(targets[0], actions), planViews }));
    },
  };
}

/** What else can be picked of a line or railway, and whether UAVs share it. @param {PickedTarget} target @param {MissionActions} actions */
function more(target, actions) {
  const { asset } = target;
  if (!isWhole(target) || asset === null) return [];
  const share = target.stretch
    ? { icon: target.kind, words: t("One UAV flies it whole"), act: () => void actions.flyWhole(asset) }
    : { icon: "replace", words: t("Share it among UAVs"), act: () => void actions.share(target) };
  return target.kind === "line"
    ? [share, { icon: "tower", words: t("Add every tower of it"), act: () => actions.addTowersOf(asset) }]
    : [share, { icon: "bridge", words: t("Add every bridge of it"), act: () => actions.addBridgesOf(asset) }];
}

/**
 * The photos of towers: a panel over the list, for the first of them; all get its camera and figures.
 *
 * @param {HTMLElement} list
 * @param {MissionActions} actions
 * @param {{ ground: Promise<MapGround> }} map
 * @returns {PlanViews}
 */
function viewPlanning(list, actions, { ground }) {
  const place = h("div", {});
  list.before(place);
  return async (targets) => {
    const [{ asset, kind, label, task }] = targets;
    if (asset === null) return;
    const keys = targets.map(({ key }) => key);
    const opener = document.activeElement;
    openViewPlan(place, { id: asset, kind }, await ground, {
      title: t("Photos of {name}", { name: label }),
      views: task?.views ?? null,
      take: {
        words: tn(targets.length, "Use for this target", "Use for {count} targets"),
        act: (views) => actions.setViews(keys, views),
      },
      closed() {
        if (opener instanceof HTMLElement && opener.isConnected) opener.focus();
      },
    });
  };
}

/**
 * What a row's chips do; a row is made once, and its target changes.
 *
 * @param {string} key
 * @param {MissionStore} store
 * @param {MissionActions} actions
 * @param {PlanViews} planViews
 */
function menusOf(key, store, actions, planViews) {
  const known = () => store.state.selection.targets.find((target) => target.key === key);
  /** @param {HTMLElement} opener @param {(target: PickedTarget) => HTMLElement} make */
  function open(opener, make) {
    const target = known();
    if (target) toggleMenu(opener, () => make(target));
  }
  return {
    /** @param {HTMLElement} opener */
    openTask: (opener) =>
      open(opener, (target) =>
        targetMenu(
          [target],
          actions,
          { ...store.state, orders: ordersOf(store.state.plan) },
          { more: more(target, actions), planViews },
        ),
      ),
    /** @param {HTMLElement} opener */
    openUav: (opener) => open(opener, (target) => uavMenu(target, actions, store.state.selection)),
    turnLock() {
      if (lockOf(store.state.selection, key)) actions.unlockTarget(key);
      else actions.lockTarget(key);
    },
  };
}

/**
 * Delete removes, the head of a folded group all of its targets; arrows go from row to row, with Alt they move the target in its route.
 *
 * @param {KeyboardEvent} event
 * @param {HTMLElement} row
 * @param {PickedTarget} target
 * @param {{ store: MissionStore, actions: MissionActions, canPlan: boolean, choosing: Choosing, groups: Pick<ReturnType<typeof createGroups>, "foldedAt">,
 *   keyAt: (index: number) => string }} context
 */
function pressKey(event, row, target, { store, actions, canPlan, choosing, groups, keyAt }) {
  const at = /** @type {Element} */ (event.target);
  if (event.key === "Delete" && canPlan) {
    event.preventDefault();
    event.stopPropagation();
    const withIt = choosing.isChosen(target) ? store.state.chosenTargets : [target.key];
    actions.removeTargets(groups.foldedAt(target) ?? withIt);
    return;
  }
  const isArrow = event.key === "ArrowDown" || event.key === "ArrowUp";
  if (isArrow && event.altKey && canPlan && at.closest(".what")) {
    event.preventDefault();
    actions.shiftTarget(target.key, event.key === "ArrowDown" ? 1 : -1);
    return;
  }
  const part = [".what", ".check", ".group-head"].find((name) => at.matches(name));
  if (!isArrow || event.altKey || !part) return;
  const next = event.key === "ArrowDown" ? row.nextElementSibling : row.previousElementSibling;
  if (!next) return;
  event.preventDefault();
  const partThere = next.matches(".folded") ? ".group-head" : part === ".group-head" ? ".what" : part;
  /** @type {HTMLElement | null} */ (next.querySelector(partThere))?.focus();
  const key = keyAt([...(row.parentElement?.children ?? [])].indexOf(next));
  const reached = store.state.selection.targets.find((candidate) => candidate.key === key);
  if (event.shiftKey && canPlan && reached) choosing.upTo(reached, target);
}

/**
 * A target chosen elsewhere, such as by a pill on the map, is chosen alone; removed targets are not chosen.
 *
 * @param {MissionStore} store
 */
function keepChosenKnown(store) {
  store.listen(["chosenTarget", "selection"], ({ chosenTarget, chosenTargets, selection }) => {
    const known = new Set(selection.targets.map((target) => target.key));
    const kept = chosenTargets.filter((key) => known.has(key));
    if (chosenTarget !== null && known.has(chosenTarget) && !kept.includes(chosenTarget))
      store.update({ chosenTargets: [chosenTarget] });
    else if (chosenTarget === null && kept.length) store.update({ chosenTargets: [] });
    else if (kept.length !== chosenTargets.length)
      store.update({ chosenTargets: kept, chosenTarget: kept.at(-1) ?? null });
  });
}
