/** The small panel beside the strips during manual editing: the chosen waypoint, faults, undo, save. */

import { h, icon } from "../../../dom.js";
import { t, tn } from "../../../text.js";
import { figuresOfCheck } from "../../hand/hand_figures.js";
import { changesOf, isFree } from "../../hand/hand_route.js";
import { createHandFields } from "./hand_fields.js";

/** @import { HandEdit, HandPoint, MissionActions, MissionPageState, MissionStore, ShownPlan } from "../../types.d.ts" */

const MAX_SHOWN = 4;

/** @param {string} image @param {string} label @param {{ title?: string, class?: string, act: () => unknown }} how */
const iconButton = (image, label, { title, class: more = "", act }) =>
  h(
    "button",
    { type: "button", class: `icon-button tight ${more}`.trim(), "aria-label": label, title, onclick: act },
    icon(image, "small"),
  );

/** @param {HandPoint} point @param {ShownPlan | null} plan */
function kindWords(point, plan) {
  if (point.kind === "start") return t("start");
  if (point.kind === "end") return t("end");
  if (point.kind === "base") return t("between two flights");
  const how = point.isManual ? t("by hand") : t("as planned");
  if (point.kind !== "target") return how;
  const label = (point.target === null ? null : plan?.targets[point.target]?.label) ?? t("Target");
  return point.isManual ? `${label}, ${how}` : label;
}

/** @param {HandEdit} hand */
function faultsOf({ faults: { legs, points: ofPoints, other }, points, unknown }) {
  /** @param {number} index */
  const leg = (index) => t("Leg {from} to {to}", { from: index + 1, to: index + 2 });
  return [
    ...(unknown ? [unknown] : []),
    ...other,
    ...[...legs].map(([index, words]) => `${leg(Math.min(index, points.length - 2))}: ${words}`),
    ...[...ofPoints].map(([index, words]) => `${t("Waypoint {number}", { number: index + 1 })}: ${words}`),
  ];
}

/**
 * The number of changes, and whether the route can be flown.
 *
 * @param {HandEdit} hand
 * @param {number} changes
 * @param {string[]} faults
 */
function sentenceOf(hand, changes, faults) {
  const parts = [
    changes
      ? tn(changes, "{count} waypoint is changed.", "{count} waypoints are changed.")
      : t("Nothing is changed yet."),
  ];
  if (hand.isCheckOld && !hand.unknown) parts.push(t("The route is being checked."));
  else if (changes && !faults.length) parts.push(t("The whole route is clear."));
  return parts.join(" ");
}

/** Create the undo of a change that was stored before. @param {MissionActions} actions */
function createTakeBack(actions) {
  const button = h(
    "button",
    { type: "button", class: "button", onclick: actions.takeBackManually },
    icon("undo-2", "small"),
    t("Take back the last change"),
  );
  const explanation = h("p", { class: "quiet-text" });
  const element = h("div", { class: "stack hand-back" }, explanation, h("div", { class: "hand-acts" }, button));
  return {
    element,
    /** @param {number} steps that are kept @param {number} changes that are not @param {boolean} isSaving */
    refresh(steps, changes, isSaving) {
      element.hidden = steps === 0;
      explanation.textContent = changes
        ? t("Changes that were kept can be taken back once these are kept or dropped.")
        : tn(
            steps,
            "{count} change by hand is kept and can be taken back.",
            "{count} changes by hand are kept and can be taken back, the last one first.",
          );
      button.disabled = changes > 0 || isSaving;
    },
  };
}

/** From one waypoint to the next, undo and redo. @param {MissionStore} store @param {MissionActions} actions */
function createWalk(store, actions) {
  /** @param {1 | -1} step */
  const go = (step) => () => {
    const { hand } = store.state;
    if (!hand) return;
    const { points, chosen } = hand;
    const next = (chosen ?? (step > 0 ? -1 : points.length)) + step;
    actions.chooseManually(Math.min(points.length - 1, Math.max(0, next)));
  };
  const which = h("span", { class: "hand-which" });
  const before = iconButton("arrow-left", t("Waypoint before"), { act: go(-1) });
  const after = iconButton("arrow-left", t("Next waypoint"), { class: "turned", act: go(1) });
  const undo = iconButton("undo-2", t("Undo"), { title: t("Undo (Ctrl+Z)"), act: actions.undoManualEdit });
  const redo = iconButton("redo-2", t("Redo"), { title: t("Redo (Ctrl+Shift+Z)"), act: actions.redoManualEdit });
  return {
    element: h("div", { class: "hand-walk" }, before, which, after, undo, redo),
    /** @param {HandEdit} hand @param {HandPoint[]} points @param {ShownPlan | null} plan */
    refresh({ chosen, canUndo, canRedo }, points, plan) {
      const point = chosen === null ? null : (points[chosen] ?? null);
      which.textContent =
        point && chosen !== null
          ? t("{number} of {total}: {kind}", {
              number: chosen + 1,
              total: points.length,
              kind: kindWords(point, plan),
            })
          : tn(points.length, "{count} waypoint", "{count} waypoints");
      before.disabled = chosen === 0;
      after.disabled = chosen === points.length - 1;
      undo.disabled = !canUndo;
      redo.disabled = !canRedo;
    },
  };
}

/**
 * The chosen waypoint: its fields, and buttons that insert one after it and remove it.
 *
 * @param {MissionStore} store
 * @param {MissionActions} actions
 */
function createChosenPoint(store, actions) {
  const chosen = () => store.state.hand?.chosen ?? 0; // there is one while its fields are shown
  const fields = createHandFields(actions, chosen);
  const put = h(
    "button",
    { type: "button", class: "button", onclick: () => actions.insertManually(chosen()) },
    icon("plus", "small"),
    t("Put one in after it"),
  );
  const drop = h(
    "button",
    { type: "button", class: "button", onclick: () => actions.removeManually(chosen()) },
    icon("trash-2", "small"),
    t("Remove"),
  );
  const element = h("div", { class: "stack hand-one" }, fields.element, h("div", { class: "hand-acts" }, put, drop));
  return {
    element,
    /** @param {HandEdit} hand @param {HandPoint[]} points @param {MissionPageState} state */
    refresh(hand, points, { mission }) {
      const point = hand.chosen === null ? null : points[hand.chosen];
      element.hidden = !point;
      if (!point || hand.chosen === null) return;
      fields.refresh(hand, point, hand.chosen, mission?.uavs[hand.sequence]?.cruise_speed_mps ?? null);
      drop.disabled = !isFree(point);
      put.disabled = hand.chosen === points.length - 1;
    },
  };
}

/** Returns its element; it follows store.state.hand. @param {MissionStore} store @param {MissionActions} actions */
export function createManualEdit(store, actions) {
  const explanation = h("p", { class: "why-sentence", role: "status" });
  const figures = h("p", { class: "hand-figures" });
  const faults = h("ul", { class: "hand-faults", "aria-label": t("What is wrong") });
  const walk = createWalk(store, actions);
  const chosenPoint = createChosenPoint(store, actions);
  const hint = h(
    "p",
    { class: "quiet-text" },
    t("Drag a waypoint on the map, or pull a new one out of the middle of a leg. Start, end and targets stay."),
  );
  const takeBack = createTakeBack(actions);
  const keep = h("button", { type: "button", class: "button primary", onclick: actions.keepManually }, t("Apply"));
  const leave = h("button", { type: "button", class: "button", onclick: actions.endManually }, t("Discard"));

  /** @param {string[]} list */
  function drawFaults(list) {
    const rest = list.length - MAX_SHOWN;
    const more = rest > 0 ? [tn(rest, "and {count} more", "and {count} more")] : [];
    faults.hidden = list.length === 0;
    faults.replaceChildren(
      ...[...list.slice(0, MAX_SHOWN), ...more].map((words) =>
        h("li", {}, icon("circle-x", "small"), h("span", {}, words)),
      ),
    );
  }

  store.listen(["hand"], (state) => {
    const { hand, plan } = state;
    if (!hand) return;
    const points = hand.dragged ?? hand.points;
    const changes = changesOf(points, hand.original);
    const list = faultsOf(hand);
    const stored = plan?.result.routes[hand.sequence];
    const reported = figuresOfCheck(hand.look, stored);
    explanation.textContent = sentenceOf(hand, changes, list);
    figures.hidden = !reported;
    figures.textContent = reported;
    figures.classList.toggle("old", hand.isCheckOld);
    drawFaults(list);
    walk.refresh(hand, points, plan);
    hint.hidden = hand.chosen !== null && Boolean(points[hand.chosen]);
    keep.setAttribute("aria-busy", String(hand.isSaving));
    keep.disabled = changes === 0;
    takeBack.refresh(stored?.hand_steps ?? 0, changes, hand.isSaving);
    chosenPoint.refresh(hand, points, state);
  });

  return {
    element: h(
      "div",
      { class: "stack by-hand" },
      explanation,
      faults,
      walk.element,
      chosenPoint.element,
      hint,
      takeBack.element,
      h("div", { class: "hand-end" }, figures, h("div", { class: "hand-acts" }, keep, leave)),
    ),
  };
}
