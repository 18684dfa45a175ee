/** The dialog "When is this mission legal?": the chart of two days, and the search for a better departure. */

import { get, post } from "../../../api.js";
import { h } from "../../../dom.js";
import { open } from "../../../page/keyboard.js";
import { t } from "../../../text.js";
import { zoneText } from "../../../units.js";
import { betterWords, legalTimesOf, marginText, mayDepartBetter, wordsOf } from "../../options/legal_times.js";
import { isPlanCurrent, routesOf } from "../../plan/plan_view.js";
import { requestOf } from "../../selection.js";
import { drawLegalChart } from "./legal_chart.js";

/** @import { Answer } from "../../../api.js" */
/** @import { LaterDeparture, LegalWindows, Waypoint } from "../../../api_types.d.ts" */
/** @import { MissionActions, MissionPageState, MissionStore } from "../../types.d.ts" */
/** @import { LegalTimes } from "./legal_chart.js" */

/** @param {unknown} error */
const isAbort = (error) => error instanceof DOMException && error.name === "AbortError";
/** @param {unknown} error */
const messageOf = (error) => (error instanceof Error ? error.message : "");

/** @param {Waypoint} waypoint */
const waypointOf = ({ position, altitude_agl_m, altitude_amsl_m }) => ({ position, altitude_agl_m, altitude_amsl_m });

/**
 * The server's answer for the stored mission while its plan is the one on the page, else for the routes on the page.
 *
 * @param {MissionPageState} state
 * @param {AbortSignal} signal
 */
async function ask({ plan, planIsStored, mission }, signal) {
  const from = new Date().toISOString();
  const routes = routesOf(plan);
  if (mission && planIsStored) {
    const address = `/missions/${mission.id}/legal-windows?from=${encodeURIComponent(from)}`;
    const { data } = /** @type {Answer<LegalWindows>} */ (await get(address, { signal }));
    return legalTimesOf(data, routes);
  }
  const flown = routes.filter(({ geometry }) => geometry);
  const asked = flown.map(({ end_action, departs_s, duration_s, arrival_s, waypoints }) => ({
    end_action,
    departs_s: departs_s ?? 0,
    duration_s,
    arrival_s: arrival_s ?? [],
    waypoints: waypoints.map(waypointOf),
  }));
  const { data } = /** @type {Answer<LegalWindows>} */ (
    await post("/plans/legal-windows", { from, routes: asked }, { signal })
  );
  return legalTimesOf(data, flown);
}

/** @param {MissionStore} store @param {MissionActions} actions */
export function showLegalTimes(store, actions) {
  const asking = new AbortController();
  const dialog = h("dialog", { class: "legal", "aria-labelledby": "legal-title" });
  const body = h("div", { class: "stack tight" });
  const better = h("div", { class: "stack tight" });
  dialog.append(
    h(
      "div",
      { class: "stack" },
      h(
        "div",
        {},
        h("h2", { id: "legal-title" }, t("When are the zones open?")),
        h(
          "p",
          { class: "quiet-text" },
          t("For the routes as planned, by the clock of {zone}.", { zone: zoneText(new Date().toISOString()) }),
        ),
      ),
      body,
      better,
      h(
        "div",
        { class: "acts" },
        h("button", { type: "button", class: "button", onclick: () => dialog.close() }, t("Close")),
      ),
    ),
  );
  const stop = fillBody(body, store, actions, { signal: asking.signal, close: () => dialog.close() });
  dialog.addEventListener("close", () => {
    stop();
    asking.abort();
  });
  open(dialog);
  const { plan, selection } = store.state;
  if (plan && isPlanCurrent(store.state) && mayDepartBetter(plan.result, selection.targets.length))
    offerBetter(better, store, actions, { signal: asking.signal, close: () => dialog.close() });
}

/**
 * The chart, once the server has answered. Returns a function that ends following the store.
 *
 * @param {HTMLElement} body
 * @param {MissionStore} store
 * @param {MissionActions} actions
 * @param {{ signal: AbortSignal, close: () => void }} dialog
 */
function fillBody(body, store, actions, { signal, close }) {
  const summary = h("p", { class: "legal-sentence", role: "status" });
  const departure = h("p", { class: "quiet-text", role: "status" });
  const chart = h("div", { class: "legal-chart" });
  /** @type {LegalTimes | null} */
  let times = null;

  function draw() {
    if (!times) return;
    const { departs_at } = store.state.selection;
    const words = wordsOf(times, departs_at);
    summary.textContent = [words.sentence, marginText(times)].filter(Boolean).join(" ");
    departure.textContent = words.departure;
    drawLegalChart(chart, times, departs_at, {
      depart: (moment) => void actions.setOption("departs_at", new Date(moment).toISOString()),
      redraw: draw,
    });
  }

  async function load() {
    body.replaceChildren(
      h(
        "div",
        { class: "stack", role: "status", "aria-label": t("Being worked out") },
        [1, 2, 3].map(() => h("div", { class: "skeleton" })),
      ),
    );
    try {
      times = await ask(store.state, signal);
    } catch (error) {
      if (isAbort(error)) return;
      body.replaceChildren(
        h("p", { role: "alert" }, messageOf(error)),
        h("div", {}, h("button", { type: "button", class: "button", onclick: load }, t("Ask again"))),
      );
      return;
    }
    body.replaceChildren(summary, chart, departure);
    draw();
  }

  const plan = () => {
    close();
    actions.plan();
  };
  if (store.state.plan?.result.routes.some((route) => route.geometry)) void load();
  else
    body.replaceChildren(
      h(
        "div",
        { class: "empty" },
        h("strong", {}, t("No route yet")),
        h("span", {}, t("Plan the mission first: which zones it meets, and when, comes from its routes.")),
        h("button", { type: "button", class: "button", onclick: plan }, t("Plan")),
      ),
    );
  return store.listen(["selection"], draw);
}

/**
 * Offer the search for a better departure, or show the one that was found.
 *
 * @param {HTMLElement} place
 * @param {MissionStore} store
 * @param {MissionActions} actions
 * @param {{ signal: AbortSignal, close: () => void }} dialog
 */
function offerBetter(place, store, actions, { signal, close }) {
  /** @param {string} words @param {string | null} departs_at */
  function offer(words, departs_at) {
    const go = () => {
      actions.setOption("departs_at", departs_at);
      close();
    };
    place.replaceChildren(
      h("p", { class: "quiet-text", role: "status" }, words),
      h(
        "div",
        { class: "acts" },
        departs_at
          ? h("button", { type: "button", class: "button primary", onclick: go }, t("Depart then"))
          : h("button", { type: "button", class: "button", onclick: look }, t("Look for a better departure")),
      ),
    );
  }

  async function look() {
    place.replaceChildren(
      h("p", { class: "quiet-text", role: "status" }, t("Plans for other departures are being made.")),
    );
    try {
      const { data } = /** @type {Answer<LaterDeparture>} */ (
        await post("/plans/later-departure", requestOf(store.state.selection), { signal })
      );
      const { words, departs_at } = betterWords(data);
      offer(words, departs_at);
    } catch (error) {
      if (!isAbort(error)) offer(messageOf(error), null);
    }
  }

  offer(t("Zones bar a part of this plan. After one of them ends, another departure may do better."), null);
}
