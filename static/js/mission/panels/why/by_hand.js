/** The small panel beside the strips while a route is changed by hand: the chosen waypoint, what is wrong, undo, keep. */

import { h, icon } from "../../../dom.js";
import { t, tn } from "../../../text.js";
import { SHORT_UNIT, SPEED_UNIT } from "../../../units.js";
import { figuresOfLook, speedWords } from "../../hand_figures.js";
import { changesOf, isFlownTo, isFree } from "../../hand_route.js";

const MOST_SAID = 4;
const typed = (metres) => Number((metres / SHORT_UNIT.metres).toFixed(1));
const typedSpeed = (mps) => Number((mps / SPEED_UNIT.mps).toFixed(1));

/** Returns { element, focus() }; it follows store.state.hand. */
export function createByHand(store, actions) {
  const hand = () => store.state.hand;
  const said = h("p", { class: "why-sentence", role: "status" });
  const figures = h("p", { class: "hand-figures" });
  const faults = h("ul", { class: "hand-faults", "aria-label": t("What is wrong") });
  const which = h("span", { class: "hand-which" });
  const go = (step) => () =>
    actions.chooseByHand(
      Math.min(hand().points.length - 1, Math.max(0, (hand().chosen ?? (step > 0 ? -1 : hand().points.length)) + step)),
    );
  const before = h(
    "button",
    { type: "button", class: "icon-button tight", "aria-label": t("Waypoint before"), onclick: go(-1) },
    icon("arrow-left", "small"),
  );
  const after = h(
    "button",
    { type: "button", class: "icon-button tight turned", "aria-label": t("Next waypoint"), onclick: go(1) },
    icon("arrow-left", "small"),
  );
  const number = (id, how, onchange) =>
    h("input", { class: "input", type: "number", step: "any", id, ...how, onchange });
  const height = number(
    "hand-height",
    { min: 0 },
    () =>
      height.value &&
      height.validity.valid &&
      actions.raiseByHand(hand().chosen, height.valueAsNumber * SHORT_UNIT.metres),
  );
  const speed = number(
    "hand-speed",
    { min: 0 },
    () =>
      speed.validity.valid &&
      actions.paceByHand(
        hand().chosen,
        speed.value && speed.valueAsNumber > 0 ? speed.valueAsNumber * SPEED_UNIT.mps : null,
      ),
  );
  const speedSaid = h("p", { class: "caption", id: "hand-speed-said" });
  speed.setAttribute("aria-describedby", speedSaid.id);
  const toPlace = () =>
    latitude.value &&
    longitude.value &&
    latitude.validity.valid &&
    longitude.validity.valid &&
    actions.moveByHand(hand().chosen, [longitude.valueAsNumber, latitude.valueAsNumber]);
  const latitude = number("hand-latitude", { min: -90, max: 90 }, toPlace);
  const longitude = number("hand-longitude", { min: -180, max: 180 }, toPlace);
  const field = (label, input, unit) =>
    h(
      "div",
      { class: "field" },
      h("label", { for: input.id }, label),
      h("div", { class: "with-unit" }, input, h("span", { class: "unit" }, unit)),
    );
  const put = h(
    "button",
    { type: "button", class: "button", onclick: () => actions.insertByHand(hand().chosen) },
    icon("plus", "small"),
    t("Put one in after it"),
  );
  const drop = h(
    "button",
    { type: "button", class: "button", onclick: () => actions.removeByHand(hand().chosen) },
    icon("trash-2", "small"),
    t("Remove"),
  );
  const one = h(
    "div",
    { class: "stack hand-one" },
    h(
      "div",
      { class: "hand-fields" },
      field(t("Height above ground"), height, SHORT_UNIT.unit),
      field(t("Speed on the way here"), speed, SPEED_UNIT.unit),
      speedSaid,
      field(t("Latitude"), latitude, "°"),
      field(t("Longitude"), longitude, "°"),
    ),
    h("div", { class: "hand-acts" }, put, drop),
  );
  const hint = h(
    "p",
    { class: "quiet-text" },
    t("Drag a waypoint on the map, or pull a new one out of the middle of a leg. Start, end and targets stay."),
  );
  const undo = h(
    "button",
    {
      type: "button",
      class: "icon-button tight",
      "aria-label": t("Undo"),
      title: t("Undo (Ctrl+Z)"),
      onclick: actions.undoByHand,
    },
    icon("undo-2", "small"),
  );
  const redo = h(
    "button",
    {
      type: "button",
      class: "icon-button tight",
      "aria-label": t("Redo"),
      title: t("Redo (Ctrl+Shift+Z)"),
      onclick: actions.redoByHand,
    },
    icon("redo-2", "small"),
  );
  const keep = h("button", { type: "button", class: "button primary", onclick: actions.keepByHand }, t("Keep|route"));
  const leave = h("button", { type: "button", class: "button", onclick: actions.endByHand }, t("Drop the changes"));
  const takeBack = h(
    "button",
    { type: "button", class: "button", onclick: actions.takeBackByHand },
    icon("undo-2", "small"),
    t("Take back the last change"),
  );
  const backSaid = h("p", { class: "quiet-text" });
  const back = h("div", { class: "stack hand-back" }, backSaid, h("div", { class: "hand-acts" }, takeBack));
  const element = h(
    "div",
    { class: "stack by-hand" },
    said,
    faults,
    h("div", { class: "hand-walk" }, before, which, after, undo, redo),
    one,
    hint,
    back,
    h("div", { class: "hand-end" }, figures, h("div", { class: "hand-acts" }, keep, leave)),
  );

  const ownSpeed = () => store.state.mission?.uavs[hand().sequence]?.cruise_speed_mps ?? null;

  /** Of the leg to a point as the server flies it; null while that is not known. */
  const flownSpeed = ({ look, points }, index) =>
    look?.waypoints.length === points.length ? (look.waypoints[index]?.speed_mps ?? null) : null;

  function kindWords(point, plan) {
    if (point.kind === "start") return t("start");
    if (point.kind === "end") return t("end");
    if (point.kind === "base") return t("between two flights");
    const hand = point.isByHand ? t("by hand") : t("as planned");
    return point.kind === "target"
      ? `${plan.targets[point.target]?.label ?? t("Target")}${point.isByHand ? `, ${hand}` : ""}`
      : hand;
  }

  function faultsNow({ faults: told, points, unknown }) {
    const leg = (index) => t("Leg {from} to {to}", { from: index + 1, to: index + 2 });
    const ofLegs = [...told.legs].map(([index, words]) => `${leg(Math.min(index, points.length - 2))}: ${words}`);
    const ofPoints = [...told.points].map(
      ([index, words]) => `${t("Waypoint {number}", { number: index + 1 })}: ${words}`,
    );
    return [...(unknown ? [unknown] : []), ...told.other, ...ofLegs, ...ofPoints];
  }

  let shownPoint = null;
  /** What somebody is typing stays, whatever the server answers meanwhile. */
  function write(input, value, chosen) {
    if (input !== document.activeElement || chosen !== shownPoint) input.value = value;
  }

  function refresh({ hand: now, plan }) {
    if (!now) return;
    const { original, chosen } = now;
    const points = now.dragged ?? now.points;
    const list = faultsNow(now);
    const isAsking = now.isLookOld && !now.unknown;
    const changes = changesOf(points, original);
    const parts = [
      changes
        ? tn(changes, "{count} waypoint is changed.", "{count} waypoints are changed.")
        : t("Nothing is changed yet."),
    ];
    if (isAsking) parts.push(t("The route is being checked."));
    else if (changes && !list.length) parts.push(t("The whole route is clear."));
    said.textContent = parts.join(" ");
    const told = figuresOfLook(now.look, plan?.result.routes[now.sequence]);
    figures.hidden = !told;
    figures.textContent = told;
    figures.classList.toggle("old", now.isLookOld);
    const rest = list.length - MOST_SAID;
    faults.hidden = list.length === 0;
    faults.replaceChildren(
      ...[...list.slice(0, MOST_SAID), ...(rest > 0 ? [tn(rest, "and {count} more", "and {count} more")] : [])].map(
        (words) => h("li", {}, icon("circle-x", "small"), h("span", {}, words)),
      ),
    );
    const point = points[chosen] ?? null;
    which.textContent = point
      ? t("{number} of {total}: {kind}", { number: chosen + 1, total: points.length, kind: kindWords(point, plan) })
      : tn(points.length, "{count} waypoint", "{count} waypoints");
    before.disabled = chosen === 0;
    after.disabled = chosen === points.length - 1;
    one.hidden = !point;
    hint.hidden = Boolean(point);
    undo.disabled = !now.canUndo;
    redo.disabled = !now.canRedo;
    keep.setAttribute("aria-busy", String(now.isSaving));
    keep.disabled = changes === 0;
    const steps = plan?.result.routes[now.sequence]?.hand_steps ?? 0;
    back.hidden = steps === 0;
    backSaid.textContent = changes
      ? t("Changes that were kept can be taken back once these are kept or dropped.")
      : tn(
          steps,
          "{count} change by hand is kept and can be taken back.",
          "{count} changes by hand are kept and can be taken back, the last one first.",
        );
    takeBack.disabled = changes > 0 || now.isSaving;
    if (!point) return;
    const free = isFree(point);
    write(height, typed(point.altitude_agl_m), chosen);
    [longitude, latitude].forEach((input, axis) => write(input, Number(point.position[axis].toFixed(6)), chosen));
    write(speed, point.speed_mps === null ? "" : typedSpeed(point.speed_mps), chosen);
    shownPoint = chosen;
    const flown_mps = flownSpeed(now, chosen);
    const usual_mps = point.speed_mps === null ? (flown_mps ?? ownSpeed()) : ownSpeed();
    speed.placeholder = usual_mps && isFlownTo(point) ? typedSpeed(usual_mps) : "";
    speed.disabled = !isFlownTo(point);
    speedSaid.textContent = speedWords(point, ownSpeed(), flown_mps);
    latitude.disabled = longitude.disabled = !free;
    drop.disabled = !free;
    put.disabled = chosen === points.length - 1;
  }

  store.listen(["hand"], refresh);
  return { element };
}
