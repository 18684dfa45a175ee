/** The fleet: a card for each UAV. Parts that a second changes are renewed in place, so that focus and pointer stay. */

import { byId, h, icon, keyedList, refill } from "../../dom.js";
import { certaintyOf, MEASURED } from "../../domain/certainty.js";
import { commandWords, isOpen, timesOf } from "../../domain/flying.js";
import { routeLetter, routeNumber } from "../../domain/palette.js";
import { profileOf } from "../../domain/route_profile.js";
import { simulatedMark } from "../../simulated.js";
import { t, tn } from "../../text.js";
import { exactClockText, lengthText, numberText } from "../../units.js";
import { numbersOf, pillOf } from "../board.js";
import { rateOf, rateWords } from "../clock_rate.js";
import { liveStrip, progressOf } from "../live_strip.js";
import { alertsInOrder, inOrder, isOpenAlert } from "../order.js";
import { ageWords, estimateWords, figuresOf, nextOf, stateOf } from "../uav_words.js";

const SAID_FOR_MS = 60_000; // a command that is over stays on the card
const rateMark = (rate) =>
  h(
    "span",
    { class: "simulated-mark", title: rateWords(rate) },
    t("{rate}×", { rate: numberText(rate, Number.isInteger(rate) ? 0 : 1) }),
    h("span", { class: "unseen" }, ` ${rateWords(rate)}`),
  );
const LEVEL_ICONS = { critical: "octagon-alert", warning: "triangle-alert", advisory: "info" };

/** What is under way for a UAV, or was until a moment ago; null. */
export function commandOf(uav, commands, now_ms) {
  const own = commands.filter(({ uav: { id } }) => id === uav.id).sort((a, b) => b.sequence - a.sequence);
  return (
    own.find(isOpen) ??
    own.find(({ finished_at }) => finished_at && now_ms - Date.parse(finished_at) < SAID_FOR_MS) ??
    null
  );
}

/** isOfOne: the page is one mission's, which then need not be named; pick(id), jumpTo(id), follow() */
export function mountCards(store, { isOfOne, pick, jumpTo, follow }) {
  const list = byId("uav-cards");
  const parts = new WeakMap();

  function make(uav) {
    const at = {
      letter: h("span", { class: "letter" }),
      name: h("strong", {}),
      chip: h("span", { class: "chip" }),
      age: h("span", { class: "age" }),
      mission: h("p", { class: "caption of-mission" }),
      estimate: h("p", { class: "estimate" }),
      figures: h("dl", { class: "figures" }),
      strip: h("div", { class: "strip-place" }),
      next: h("p", { class: "next" }),
      command: h("p", { class: "card-command" }),
      alerts: h("ul", { class: "card-alerts" }),
      jump: h("button", { type: "button", class: "text-button", onclick: () => jumpTo(uav.id) }, t("Show on the map")),
      follow: h(
        "button",
        { type: "button", class: "text-button", "aria-pressed": "false", onclick: follow },
        t("Follow"),
      ),
    };
    at.acts = h("div", { class: "card-acts" }, at.jump, at.follow);
    at.head = h(
      "button",
      { type: "button", class: "card-head", "aria-pressed": "false", onclick: () => pick(uav.id) },
      at.letter,
      at.name,
      at.chip,
    );
    const card = h(
      "li",
      { class: "card", onclick: (event) => !event.target.closest("button, a") && pick(uav.id) },
      h("div", { class: "card-top" }, at.head, at.age),
      at.mission,
      at.command,
      at.estimate,
      at.figures,
      at.strip,
      at.next,
      at.alerts,
      at.acts,
    );
    parts.set(card, at);
    return card;
  }

  function refresh(card, uav) {
    const { now_ms, chosen, isFollowing, missions, details, commands, alerts } = store.state;
    const at = parts.get(card);
    const certainty = certaintyOf(uav, now_ms);
    const mission = missions.find(({ id }) => id === uav.mission) ?? null;
    const detail = details.get(uav.mission);
    const isChosen = uav.id === chosen;
    card.className = `card ${uav.place === null ? "" : `route-${routeNumber(uav.place)}`} ${isChosen ? "chosen" : ""}`;
    at.head.setAttribute("aria-pressed", `${isChosen}`);
    at.letter.textContent = uav.place === null ? "–" : routeLetter(uav.place);
    at.name.textContent = uav.name;
    const state = stateOf(uav);
    at.chip.textContent = state.words;
    at.chip.className = `chip ${state.level === "warning" ? "aborted" : state.level === "active" ? "draft" : ""}`;
    const age = ageWords(uav, now_ms);
    refill(at.age, `${age.isLate} ${age.words}`, () => [age.isLate && icon("signal", "small"), age.words]);
    at.age.classList.toggle("late", age.isLate);
    const ofMission = mission
      ? !isOfOne && h("a", { href: `/missions/${mission.id}/fly` }, mission.name)
      : t("not in a mission");
    const rate = rateOf(uav);
    const about = [uav.is_simulated && simulatedMark(), rate !== 1 && rateMark(rate), ofMission].filter(Boolean);
    at.mission.hidden = about.length === 0;
    refill(at.mission, JSON.stringify([mission && [mission.id, mission.name], uav.is_simulated, rate]), () =>
      about.flatMap((part, index) => (index ? [" ", part] : [part])),
    );
    const estimate = estimateWords(uav, certainty, now_ms);
    at.estimate.hidden = estimate === null;
    if (estimate)
      refill(at.estimate, `${estimate.strong} ${estimate.rest}`, () => [
        icon("circle-dashed"),
        h("span", {}, h("strong", {}, estimate.strong), ` ${estimate.rest}`),
      ]);
    const figures = figuresOf(uav, certainty);
    refill(at.figures, JSON.stringify(figures), () =>
      figures.map(({ figure, unit, words }) =>
        h("div", {}, h("dt", {}, words), h("dd", {}, figure, unit && h("small", {}, ` ${unit}`))),
      ),
    );
    drawStrip(at, uav, detail, mission, certainty);
    const numbers = numbersOf(detail);
    const next = nextOf(uav, (place) => {
      const target = mission?.targets[place];
      return target ? `${pillOf(target, numbers)} ${target.label}` : t("a target");
    });
    at.next.hidden = !next.next && !next.toGo;
    refill(at.next, JSON.stringify([next, certainty]), () => [
      h(
        "span",
        {},
        next.next && [
          t("Next"),
          " ",
          h("strong", {}, next.next),
          next.at && `, ${certainty === MEASURED ? "" : "~\u2009"}${next.at}`,
        ],
      ),
      h("span", { class: "quiet-text" }, next.toGo),
    ]);
    drawCommand(at.command, commandOf(uav, commands, now_ms));
    const open = alertsInOrder(alerts.filter((alert) => alert.uav === uav.id && isOpenAlert(alert)));
    at.alerts.hidden = open.length === 0;
    refill(
      at.alerts,
      JSON.stringify(open.map(({ id, revision, level, message }) => [id, revision, level, message])),
      () =>
        open.map(({ level, message, acknowledged_at }) =>
          h(
            "li",
            { class: acknowledged_at ? "known" : level },
            icon(acknowledged_at ? "check" : LEVEL_ICONS[level], "small"),
            h("span", {}, message),
          ),
        ),
    );
    at.acts.hidden = !isChosen;
    at.follow.setAttribute("aria-pressed", `${isFollowing && isChosen}`);
    at.follow.textContent = isFollowing && isChosen ? t("Following") : t("Follow");
  }

  /** Drawn again only where it would be another. */
  function drawStrip(at, uav, detail, mission, certainty) {
    const route = uav.place === null ? null : detail?.plan?.routes[uav.place];
    const width_px = Math.round(at.strip.clientWidth || list.clientWidth - 32);
    at.strip.hidden = !route?.geometry;
    if (at.strip.hidden || width_px <= 0) return;
    const states = new Map((mission?.targets ?? []).map(({ place, state }) => [place, state]));
    const progress = progressOf(uav, profileOf(route.waypoints, route.length_m).places);
    const key = JSON.stringify([
      width_px,
      detail.revision,
      certainty,
      progress && [Math.round(progress.at_m / 5), Math.round(progress.within_m / 5)],
      [...states],
    ]);
    if (at.strip.dataset.drawn === key) return;
    at.strip.dataset.drawn = key;
    const done = route.targets.filter((target) => states.get(target) === "complete").length;
    const label = t("{name}: {done} of {targets}, {flown} of {length} flown", {
      name: uav.name,
      done,
      targets: tn(route.targets.length, "{count} target", "{count} targets"),
      flown: progress ? lengthText(progress.at_m) : "—",
      length: lengthText(route.length_m),
    });
    at.strip.replaceChildren(liveStrip({ route, width_px, label, states, progress, certainty }));
  }

  function drawCommand(place, command) {
    place.hidden = command === null;
    if (!command) return;
    const said = commandWords(command);
    place.className = `card-command ${said.level ?? ""}`;
    refill(place, `${command.id} ${command.state} ${said.words}`, () => [
      icon(said.image, "small"),
      h("span", {}, h("strong", {}, said.words), h("small", {}, timesOf(command, exactClockText))),
    ]);
  }

  const draw = keyedList(list, ({ id }) => id, make, refresh);
  store.listen(
    ["uavs", "missions", "details", "alerts", "commands", "chosen", "now_ms", "isFollowing"],
    ({ uavs, alerts, chosen }) => {
      byId("no-uavs").hidden = uavs.length > 0;
      draw(inOrder(uavs, alerts, chosen));
    },
  );
  store.listen(["chosen"], () => (byId("part-uavs").scrollTop = 0)); // it stands first
  new ResizeObserver(() => draw(inOrder(store.state.uavs, store.state.alerts, store.state.chosen))).observe(list);
}
