/** The list of targets: pill, kind, name, second fact, remove. */

import { byId, h, icon, keyedList } from "../../dom.js";
import { routeNumber } from "../../map/palette.js";
import { inPlanOrder, isPlanCurrent, placesOf, unreachedOf } from "../plan_view.js";
import { nameOf } from "../selection.js";

const SHOWN_FIRST = 40;
const ICONS = { tower: "tower", line: "line", railway: "railway", bridge: "bridge", place: "map-pin" };

export function mountTargets(store, actions, canPlan, showOnMap) {
  let showAll = false;
  const list = byId("target-list");
  const draw = keyedList(
    list,
    (target) => target.key,
    (target) => {
      const row = h(
        "li",
        {
          class: "target",
          onpointerenter: () => store.update({ litTarget: target.key }),
          onpointerleave: () => store.update({ litTarget: null }),
          onfocusin: () => store.update({ litTarget: target.key }),
          onfocusout: () => store.update({ litTarget: null }),
        },
        h("span", { class: "pill" }),
        icon(ICONS[target.kind] ?? "map-pin"),
        h("button", { type: "button", class: "what", onclick: () => choose(target) }, h("span", {}, target.label), h("small", {})),
        canPlan &&
          h(
            "button",
            { type: "button", class: "icon-button tight", "aria-label": `Remove ${target.label}`, title: "Remove (Del)", onclick: () => actions.removeTargets([target.key]) },
            icon("x", "small"),
          ),
      );
      row.addEventListener("keydown", (event) => {
        if (event.key === "Delete" && canPlan) {
          event.preventDefault();
          event.stopPropagation();
          actions.removeTargets([target.key]);
        } else if ((event.key === "ArrowDown" || event.key === "ArrowUp") && event.target.classList.contains("what")) {
          const next = event.key === "ArrowDown" ? row.nextElementSibling : row.previousElementSibling;
          if (next) event.preventDefault();
          next?.querySelector(".what").focus();
        }
      });
      return row;
    },
    (row, target, index) => {
      const { places, missed, chosenTarget } = shown;
      const place = places.get(target.key);
      const pill = row.querySelector(".pill");
      pill.className = `pill ${place ? `route-${routeNumber(place.sequence)}` : missed.has(target.key) ? "missed" : "waiting"}`;
      pill.textContent = place ? `${place.letter}${place.number}` : missed.has(target.key) ? "×" : `${index + 1}`;
      pill.setAttribute("aria-label", place ? `Target ${place.number} of UAV ${place.letter}` : missed.has(target.key) ? "Not reached" : "Not planned yet");
      row.querySelector("small").textContent = target.detail;
      row.querySelector(".what").title = nameOf(target);
      row.classList.toggle("chosen", chosenTarget === target.key);
    },
  );

  let shown = { places: new Map(), missed: new Set(), chosenTarget: null };

  function choose(target) {
    store.update({ chosenTarget: target.key });
    showOnMap(target);
  }

  function refresh(state) {
    const isCurrent = isPlanCurrent(state);
    shown = {
      places: isCurrent ? placesOf(state.plan) : new Map(),
      missed: new Set(isCurrent ? unreachedOf(state.plan).map(({ target }) => target.key) : []),
      chosenTarget: state.chosenTarget,
    };
    const all = inPlanOrder(state.selection.targets, shown.places);
    const visible = showAll ? all : all.slice(0, SHOWN_FIRST);
    draw(visible);
    const rest = all.length - visible.length;
    byId("show-more").hidden = rest === 0;
    byId("show-more").textContent = `Show ${rest} more`;
    byId("target-count").textContent = all.length || "";
    byId("targets-empty").hidden = all.length > 0;
    byId("clear-targets").hidden = all.length < 2 || !canPlan;
    byId("undo").disabled = !state.canUndo;
    byId("redo").disabled = !state.canRedo;
  }

  byId("show-more").addEventListener("click", () => {
    showAll = true;
    refresh(store.state);
  });
  byId("clear-targets").addEventListener("click", () => actions.removeTargets(store.state.selection.targets.map((target) => target.key)));
  byId("undo").addEventListener("click", actions.undo);
  byId("redo").addEventListener("click", actions.redo);
  document.getElementById("pick-line")?.addEventListener("click", () => store.update({ tool: "line" }));
  document.getElementById("tools")?.addEventListener("change", (event) => store.update({ tool: event.target.value }));

  store.listen(["tool"], ({ tool }) => {
    const radio = document.querySelector(`#tools [value="${tool}"]`);
    if (radio) radio.checked = true;
  });
  store.listen(["selection", "plan", "chosenTarget", "canUndo", "canRedo"], refresh);
}
