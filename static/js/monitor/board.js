/** Every target of a mission and what became of it: what is under way first, then what is to come, then what is done, the newest first. */

import { byId, h, icon, keyedList } from "../dom.js";
import { routeNumber } from "../map/palette.js";
import { t } from "../text.js";
import { clockText } from "../units.js";
import { reasonWords, TARGET_STATES } from "./words.js";

const ORDER = { "in-progress": 0, pending: 1, failed: 2, skipped: 3, complete: 4 };

/** arrivals: place of a target → when it will be reached, ISO. */
export function inOrder(targets, arrivals) {
  const time = (target) => Date.parse(target.state === "pending" || target.state === "in-progress" ? (arrivals.get(target.place) ?? "") : (target.state_at ?? "")) || Infinity;
  return [...targets].sort((a, b) => ORDER[a.state] - ORDER[b.state] || (ORDER[a.state] < 2 ? time(a) - time(b) : time(b) - time(a)) || a.place - b.place);
}

export function mountBoard({ onMission, onTarget }) {
  const body = byId("live-board");
  const select = byId("live-board-mission");
  select.addEventListener("change", () => onMission(select.value));

  const make = () => h("tr", {});
  function refresh(row, { target, label, place, arrival }) {
    const state = TARGET_STATES[target.state];
    const isOpen = target.state === "pending" || target.state === "in-progress";
    const at = isOpen ? (arrival ? `~ ${clockText(arrival)}` : "—") : target.state_at ? clockText(target.state_at) : "—";
    const said = JSON.stringify([target, label, at]);
    if (row.dataset.said === said) return;
    row.dataset.said = said;
    row.className = target.state;
    row.replaceChildren(
      h("td", {}, label ? h("button", { type: "button", class: `pill-button route-${routeNumber(place)} ${target.state}`, "aria-label": t("Show target {label}", { label }), onclick: () => onTarget(target.place) }, h("span", { class: "pill" }, label)) : h("span", { class: "caption" }, "—")),
      h("td", { class: "board-name" }, target.label, target.state_reason && h("span", { class: "caption" }, reasonWords(target.state_reason))),
      h("td", { class: "board-state" }, icon(state.image, "small"), state.words),
      h("td", { class: "number" }, at),
    );
  }
  const draw = keyedList(body, ({ target }) => target.place, make, refresh);

  /** missions: that may be looked at; shown: the one that is; labels, arrivals: by place of the target. */
  return ({ missions, shown, labels, arrivals }) => {
    select.hidden = missions.length < 2;
    if (!select.hidden) {
      const known = [...select.options].map(({ value, text }) => `${value}${text}`).join();
      if (known !== missions.map(({ id, name }) => `${id}${name}`).join()) select.replaceChildren(...missions.map(({ id, name }) => h("option", { value: id }, name)));
      if (shown) select.value = shown.id;
    }
    const targets = shown?.targets ?? [];
    byId("live-no-board").hidden = targets.length > 0;
    body.parentElement.hidden = targets.length === 0;
    byId("live-board-count").textContent = shown ? t("{done} of {all} complete", { done: shown.counts.complete, all: shown.counts.all }) : "";
    draw(inOrder(targets, arrivals).map((target) => ({ target, ...(labels.get(target.place) ?? { label: "", place: 0 }), arrival: arrivals.get(target.place) })));
  };
}
