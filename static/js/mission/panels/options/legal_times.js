/** The dialog "When is this mission legal?": two days as a bar, all zones on top and each in a row; the departure is moved on it. */

import { get, post } from "../../../api.js";
import { h } from "../../../dom.js";
import { scheduleText } from "../../../domain/schedule_words.js";
import { open } from "../../../page/keyboard.js";
import { t } from "../../../text.js";
import { zoneText } from "../../../units.js";
import { departureText } from "../../flight_options.js";
import {
  betterWords,
  legalTimesOf,
  legsText,
  marginText,
  mayDepartBetter,
  momentAt,
  STEP_MS,
  shareOf,
  spanAt,
  spanText,
  stepWithin,
  ticksOf,
  wordsOf,
} from "../../legal_times.js";
import { isPlanCurrent, routesOf } from "../../plan_view.js";
import { requestOf } from "../../selection.js";

const HOUR_MS = 3_600_000;
const [LAST_ROOM, LAST_ROOM_WIDE] = [0.78, 0.93]; // a label that begins later has no room to the right, on a phone and on a desk

/** To which side a label has no room. */
const sideOf = (share) => (share < 0.15 ? "at-begin" : share > 0.85 ? "at-end" : "within");

const waypointOf = ({ position, altitude_agl_m, altitude_amsl_m }) => ({ position, altitude_agl_m, altitude_amsl_m });

/** What the server says of the stored mission while its plan is the one on the page, else of the routes on the page. */
async function ask({ plan, planIsStored, mission }, signal) {
  const from = new Date().toISOString();
  const routes = routesOf(plan);
  if (mission && planIsStored) {
    const { data } = await get(`/missions/${mission.id}/legal-windows?from=${encodeURIComponent(from)}`, { signal });
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
  const { data } = await post("/plans/legal-windows", { from, routes: asked }, { signal });
  return legalTimesOf(data, flown);
}

export function showLegalTimes(store, actions) {
  const said = h("p", { class: "legal-sentence", role: "status" });
  const departure = h("p", { class: "quiet-text", role: "status" });
  const chart = h("div", { class: "legal-chart" });
  const body = h("div", { class: "stack tight" });
  const asking = new AbortController();
  const dialog = h("dialog", { class: "legal", "aria-labelledby": "legal-title" });
  let times = null;

  function askAgain() {
    body.replaceChildren(
      h(
        "div",
        { class: "stack", role: "status", "aria-label": t("Being worked out") },
        [1, 2, 3].map(() => h("div", { class: "skeleton" })),
      ),
    );
    ask(store.state, asking.signal).then(
      (answer) => {
        times = answer;
        body.replaceChildren(said, chart, departure);
        draw();
      },
      (error) =>
        error.name === "AbortError" ||
        body.replaceChildren(
          h("p", { role: "alert" }, error.message),
          h("div", {}, h("button", { type: "button", class: "button", onclick: askAgain }, t("Ask again"))),
        ),
    );
  }

  const depart = (moment) => actions.setOption("departs_at", new Date(moment).toISOString());

  /** Takes a moment from the pointer; a free span keeps it inside. */
  function pointed(event, track) {
    const box = track.getBoundingClientRect();
    return momentAt(times, (event.clientX - box.left) / box.width);
  }

  function draw() {
    const { departs_at } = store.state.selection;
    const words = wordsOf(times, departs_at);
    said.textContent = [words.sentence, marginText(times)].filter(Boolean).join(" ");
    departure.textContent = words.departure;
    const focused = chart.contains(document.activeElement) ? document.activeElement.dataset.part : null;
    const slider = sliderOf(departs_at ? Date.parse(departs_at) : null);
    chart.replaceChildren(
      axis(),
      row(h("strong", {}, t("The mission")), [], unionTrack(), "union"),
      ...times.zones.map((zone) =>
        row(
          h("span", { class: "legal-zone" }, zone.name),
          [
            scheduleText(zone.schedule, { now: times.from_ms, otherwise: zone.schedule_in_words }),
            legsText(zone.legs),
          ].filter(Boolean),
          zoneTrack(zone),
        ),
      ),
      h("div", { class: "legal-over" }, mark(Date.now(), "legal-now", t("now")), slider),
    );
    if (focused) chart.querySelector(`[data-part="${focused}"]`)?.focus();
  }

  const place = (element, { from_ms, to_ms }) => {
    element.style.left = `${shareOf(times, from_ms) * 100}%`;
    element.style.width = `${(shareOf(times, to_ms) - shareOf(times, from_ms)) * 100}%`;
    return element;
  };

  function mark(moment, name, words) {
    const element = h(
      "div",
      { class: name, hidden: moment < times.from_ms || moment > times.to_ms },
      h("small", {}, words),
    );
    element.style.left = `${shareOf(times, moment) * 100}%`;
    return element;
  }

  const row = (name, seconds, track, kind = "") =>
    h(
      "div",
      { class: `legal-row ${kind}`.trim() },
      h(
        "div",
        { class: "legal-name" },
        name,
        seconds.map((words) => h("small", { title: words }, words)),
      ),
      track,
    );

  function axis() {
    const ticks = ticksOf(times).map(({ at_ms, words, isDay }) => {
      const share = shareOf(times, at_ms);
      const tick = h(
        "span",
        {
          class:
            [isDay && "day", share > LAST_ROOM && "late", share > LAST_ROOM_WIDE && "at-end"]
              .filter(Boolean)
              .join(" ") || null,
        },
        words,
      );
      tick.style.left = `${shareOf(times, at_ms) * 100}%`;
      return tick;
    });
    return h(
      "div",
      { class: "legal-row legal-axis", "aria-hidden": "true" },
      h("div", {}),
      h("div", { class: "legal-ticks" }, ticks),
    );
  }

  /** Free spans are buttons: a click takes the moment that was pointed at, Enter the begin of the span. */
  function unionTrack() {
    const track = h("div", { class: "legal-track", role: "group", "aria-label": t("Legal times to depart") });
    times.windows.forEach((free, index) => {
      const button = h("button", {
        type: "button",
        class: "legal-free",
        dataset: { part: `free-${index}` },
        title: spanText(free),
        "aria-label": t("Depart at the begin of {span}", { span: spanText(free) }),
      });
      button.addEventListener("click", (event) =>
        depart(stepWithin(free, event.detail ? pointed(event, track) : free.from_ms)),
      );
      track.append(place(button, free));
    });
    return track;
  }

  function zoneTrack({ name, blocked }) {
    const words = blocked.length ? blocked.map(spanText).join("; ") : t("not in the way in these hours");
    return h(
      "div",
      { class: "legal-track", role: "img", "aria-label": `${name}: ${words}` },
      blocked.map((closed) => place(h("i", { class: "legal-blocked", title: spanText(closed) }), closed)),
    );
  }

  function sliderOf(moment) {
    const [least, most] = [momentAt(times, 0), momentAt(times, 1)];
    const at = Math.min(most, Math.max(least, moment ?? Math.max(least, Date.now())));
    const isLegal = spanAt(times.windows, at) !== null;
    const when = departureText(new Date(at).toISOString());
    const handle = h("span", { class: "legal-handle" });
    const slider = h(
      "div",
      {
        class: `legal-departure${moment === null ? " unset" : isLegal ? "" : " illegal"} ${sideOf(shareOf(times, at))}`,
        role: "slider",
        tabindex: 0,
        dataset: { part: "departure" },
        "aria-label": t("Departure"),
        "aria-valuemin": least,
        "aria-valuemax": most,
        "aria-valuenow": at,
        "aria-valuetext":
          moment === null ? t("any time") : isLegal ? t("{when}, legal", { when }) : t("{when}, not legal", { when }),
      },
      handle,
      h("small", {}, moment === null ? t("Departure") : when),
    );
    slider.style.left = `${shareOf(times, at) * 100}%`;
    slider.addEventListener("keydown", (event) => {
      const steps = {
        ArrowRight: STEP_MS,
        ArrowUp: STEP_MS,
        ArrowLeft: -STEP_MS,
        ArrowDown: -STEP_MS,
        PageUp: HOUR_MS,
        PageDown: -HOUR_MS,
        Home: least - at,
        End: most - at,
      };
      const step =
        event.shiftKey && event.key.startsWith("Arrow") ? Math.sign(steps[event.key]) * HOUR_MS : steps[event.key];
      if (step === undefined) return;
      event.preventDefault();
      depart(Math.min(most, Math.max(least, Math.round((at + step) / STEP_MS) * STEP_MS)));
    });
    slider.addEventListener("pointerdown", (event) => {
      event.preventDefault();
      slider.focus();
      const over = slider.parentElement;
      let moved = null;
      const follow = (move) => {
        moved = pointed(move, over);
        slider.style.left = `${shareOf(times, moved) * 100}%`;
        slider.classList.remove("unset", "at-begin", "at-end");
        slider.classList.add(sideOf(shareOf(times, moved)));
        slider.querySelector("small").textContent = departureText(new Date(moved).toISOString());
        slider.classList.toggle("illegal", spanAt(times.windows, moved) === null);
      };
      const end = (last) => {
        removeEventListener("pointermove", follow);
        removeEventListener("pointerup", end);
        removeEventListener("pointercancel", end);
        if (moved !== null && last.type === "pointerup") depart(moved);
        else draw();
      };
      addEventListener("pointermove", follow);
      addEventListener("pointerup", end);
      addEventListener("pointercancel", end);
    });
    return slider;
  }

  const better = h("div", { class: "stack tight" });

  function offerBetter(words = "", departs_at = null) {
    const look = h(
      "button",
      { type: "button", class: "button", onclick: lookForBetter },
      t("Look for a better departure"),
    );
    const go =
      departs_at &&
      h(
        "button",
        {
          type: "button",
          class: "button primary",
          onclick: () => (actions.setOption("departs_at", departs_at), dialog.close()),
        },
        t("Depart then"),
      );
    better.replaceChildren(
      h(
        "p",
        { class: "quiet-text", role: "status" },
        words || t("Zones bar a part of this plan. After one of them ends, another departure may do better."),
      ),
      h("div", { class: "acts" }, go || look),
    );
  }

  async function lookForBetter() {
    better.replaceChildren(
      h("p", { class: "quiet-text", role: "status" }, t("Plans for other departures are being made.")),
    );
    try {
      const { data } = await post("/plans/later-departure", requestOf(store.state.selection), {
        signal: asking.signal,
      });
      const { words, departs_at } = betterWords(data);
      offerBetter(words, departs_at);
    } catch (error) {
      if (error.name !== "AbortError") offerBetter(error.message);
    }
  }

  const isPlanned = store.state.plan?.result.routes.some((route) => route.geometry);
  dialog.append(
    h(
      "div",
      { class: "stack" },
      h(
        "div",
        {},
        h("h2", { id: "legal-title" }, t("When is this mission legal?")),
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
  const stopListening = store.listen(["selection"], () => times && draw());
  dialog.addEventListener("close", () => {
    stopListening();
    asking.abort();
  });
  open(dialog);
  if (
    store.state.plan &&
    isPlanCurrent(store.state) &&
    mayDepartBetter(store.state.plan.result, store.state.selection.targets.length)
  )
    offerBetter();
  if (isPlanned) askAgain();
  else
    body.replaceChildren(
      h(
        "div",
        { class: "empty" },
        h("strong", {}, t("No route yet")),
        h("span", {}, t("Plan the mission first: which zones it meets, and when, comes from its routes.")),
        h("button", { type: "button", class: "button", onclick: () => (dialog.close(), actions.plan()) }, t("Plan")),
      ),
    );
}
