/** The fleet: a card for each UAV. Parts that a second changes are renewed in place, so that focus and pointer stay. */

import { byId, h, icon, keyedList, refill } from "../../dom.js";
import { certaintyOf, MEASURED } from "../../domain/certainty.js";
import { commandWords, isOpen, KINDS, timesOf } from "../../domain/flying.js";
import { alertsInOrder, inOrder, isOpenAlert } from "../../domain/order.js";
import { routeNumber } from "../../domain/palette.js";
import { profileOf } from "../../domain/route_profile.js";
import { simulatedMark } from "../../simulated.js";
import { t, tn } from "../../text.js";
import { exactClockText, lengthText, numberText } from "../../units.js";
import { numbersOf, pillOf } from "../board.js";
import { letterOf, prefixOf } from "../call_signs.js";
import { rateOf, rateWords } from "../clock_rate.js";
import { grouped } from "../fleet_groups.js";
import { liveStrip, progressOf } from "../live_strip.js";
import { ageWords, batteryWords, estimateWords, figuresOf, nextOf, stateOf, windWords } from "../uav_words.js";
import { makeHead, refreshHead } from "./group_head.js";
import { UavRow } from "./uav_row.js";

/** @import { AlertLevel, Mission } from "../../api_types.d.ts" */
/** @import { Certainty } from "../../domain/certainty.js" */
/** @import { GroupHead } from "../fleet_groups.js" */
/** @import { Alert, Command, Commanding, LiveMission, LiveUav, MonitorState, MonitorStore, UnsentCommand } from "../types.d.ts" */

/**
 * @typedef {object} CardActs
 * @property {boolean} isOfOne the page is one mission's, which then need not be named
 * @property {(uav: number) => void} pick
 * @property {(uav: number) => void} jumpTo
 * @property {() => void} close nothing is chosen any more
 * @property {() => void} follow
 * @property {(shown: number, all: number) => void} tellShown how many the filter lets through
 * @property {Commanding | null} commanding null for who cannot fly
 */
/** What is known of a card's UAV beside itself. @typedef {{ mission: LiveMission | null, detail: Mission | undefined, certainty: Certainty | null }} Known */

const SAID_FOR_MS = 60_000; // a command that is over stays on the card
const STRIP_MARGIN_PX = 32;
const narrow = matchMedia("(max-width: 720px)"); // there, and where several missions fly, a UAV is a row until it is chosen
const STRIP_STEP_M = 5; // a UAV that has moved less is drawn where it was
/** @type {Record<AlertLevel, string>} */
const LEVEL_ICONS = { critical: "octagon-alert", warning: "triangle-alert", advisory: "info" };

/** @param {number} rate */
const rateMark = (rate) =>
  h(
    "span",
    { class: "simulated-mark", title: rateWords(rate) },
    t("{rate}×", { rate: numberText(rate, Number.isInteger(rate) ? 0 : 1) }),
    h("span", { class: "unseen" }, ` ${rateWords(rate)}`),
  );

/**
 * What is under way for a UAV, or was until a moment ago; null.
 *
 * @param {Pick<LiveUav, "id">} uav
 * @param {Command[]} commands
 * @param {number} now_ms
 */
export function commandOf(uav, commands, now_ms) {
  const own = commands.filter(({ uav: { id } }) => id === uav.id).sort((a, b) => b.sequence - a.sequence);
  return (
    own.find(isOpen) ??
    own.find(({ finished_at }) => finished_at && now_ms - Date.parse(finished_at) < SAID_FOR_MS) ??
    null
  );
}

/** @param {MonitorStore} store @param {CardActs} acts */
export function mountCards(store, acts) {
  const list = byId("uav-cards");
  /** @type {WeakMap<HTMLElement, Card>} */
  const cards = new WeakMap();

  /** @param {LiveUav | GroupHead} entry */
  function make(entry) {
    if (isHead(entry)) return makeHead();
    const card = new Card(entry.id, acts);
    cards.set(card.element, card);
    return card.element;
  }

  const drawList = keyedList(
    list,
    ({ id }) => id,
    make,
    (element, entry) => {
      if (isHead(entry)) refreshHead(element, entry, store.state.numbers);
      else cards.get(element)?.show(entry, store.state, list.clientWidth - STRIP_MARGIN_PX);
    },
  );
  const draw = () => {
    const { state } = store;
    list.classList.toggle("compact", narrow.matches || !acts.isOfOne);
    const entries = acts.isOfOne ? inOrder(state.uavs, state.alerts, state.chosen) : grouped(state, state.filter);
    acts.tellShown(entries.filter((entry) => !isHead(entry)).length, state.uavs.length);
    drawList(entries);
  };
  store.listen(
    [
      "uavs",
      "missions",
      "details",
      "alerts",
      "commands",
      "chosen",
      "now_ms",
      "isFollowing",
      "unsent",
      "filter",
      "numbers",
    ],
    ({ uavs }) => {
      byId("no-uavs").hidden = uavs.length > 0;
      draw();
    },
  );
  store.listen(["chosen"], ({ chosen }) => {
    if (acts.isOfOne && !narrow.matches)
      byId("part-uavs").scrollTop = 0; // it stands first
    else if (chosen !== null) list.querySelector(".card.chosen")?.scrollIntoView({ block: "nearest" });
  });
  new ResizeObserver(draw).observe(list);
}

/** @param {LiveUav | GroupHead} entry @returns {entry is GroupHead} */
const isHead = (entry) => typeof entry.id === "string";

class Card {
  #acts;
  #isChosen = false;
  #letter = h("span", { class: "letter" });
  #name = h("strong", {});
  #chip = h("span", { class: "chip" });
  #age = h("span", { class: "age" });
  #about = h("p", { class: "caption of-mission" });
  #estimate = h("p", { class: "estimate" });
  #figures = h("dl", { class: "figures" });
  #strip = h("div", { class: "strip-place" });
  #next = h("p", { class: "next" });
  #battery = h("p", { class: "card-battery" });
  #command = h("p", { class: "card-command" });
  #unsent = h("div", { class: "card-unsent", role: "alert", hidden: true });
  #alerts = h("ul", { class: "card-alerts" });
  #follow;
  #wind = h("p", { class: "caption card-wind" });
  #buttons;
  #head;
  #row;

  /** @param {number} id of the UAV @param {CardActs} acts */
  constructor(id, acts) {
    this.#acts = acts;
    /** @param {string} look @param {() => void} onclick @param {(string | Node)[]} children */
    const button = (look, onclick, ...children) => h("button", { type: "button", class: look, onclick }, children);
    this.#follow = button("text-button", acts.follow, t("Follow"));
    this.#follow.setAttribute("aria-pressed", "false");
    const jump = button("text-button", () => acts.jumpTo(id), t("Show on the map"));
    this.#buttons = h("div", { class: "card-acts" }, jump, this.#follow);
    this.#head = button("card-head", () => acts.pick(id), this.#letter, this.#name, this.#chip);
    this.#head.setAttribute("aria-pressed", "false");
    /** @param {MouseEvent} event */
    const onclick = ({ target }) => {
      if (target instanceof Element && !target.closest("button, a")) acts.pick(id);
    };
    this.#row = new UavRow(() => (this.#isChosen ? acts.close() : acts.pick(id)));
    this.element = h(
      "li",
      { class: "card", onclick },
      this.#row.element,
      h("div", { class: "card-top" }, this.#head, this.#age),
      this.#about,
      this.#unsent,
      this.#command,
      this.#estimate,
      this.#figures,
      this.#battery,
      this.#wind,
      this.#strip,
      this.#next,
      this.#alerts,
      this.#buttons,
    );
  }

  /** @param {LiveUav} uav @param {Readonly<MonitorState>} state @param {number} width_px of its strip, until it has one of its own */
  show(uav, state, width_px) {
    const { now_ms, missions, details, commands, alerts } = state;
    const known = {
      mission: missions.find(({ id }) => id === uav.mission) ?? null,
      detail: details.get(uav.mission ?? ""),
      certainty: certaintyOf(uav, now_ms),
    };
    const isChosen = uav.id === state.chosen;
    this.#isChosen = isChosen;
    this.#drawHead(uav, isChosen, letterOf(uav, state.numbers));
    this.#drawUnsent(uav, state.unsent.get(uav.id) ?? null);
    if (narrow.matches || !this.#acts.isOfOne) {
      const targets = numbersOf(known.detail);
      const prefix = prefixOf(uav.mission, state.numbers);
      this.#row.show(uav, known.certainty, state, (place) => {
        const target = known.mission?.targets[place];
        return target ? pillOf(target, targets, prefix) : t("a target");
      });
      if (!isChosen) return;
    }
    this.#drawAge(uav, now_ms);
    this.#drawAbout(uav, known.mission);
    this.#drawEstimate(uav, known.certainty, now_ms);
    this.#drawFigures(uav, known.certainty);
    this.#drawBattery(uav);
    this.#drawWind(uav, now_ms);
    this.#drawStrip(uav, known, Math.round(this.#strip.clientWidth || width_px));
    this.#drawNext(uav, known, prefixOf(uav.mission, state.numbers));
    this.#drawCommand(commandOf(uav, commands, now_ms));
    this.#drawAlerts(alerts.filter((alert) => alert.uav === uav.id && isOpenAlert(alert)));
    const isFollowed = state.isFollowing && isChosen;
    this.#buttons.hidden = !isChosen;
    this.#follow.setAttribute("aria-pressed", `${isFollowed}`);
    this.#follow.textContent = isFollowed ? t("Following") : t("Follow");
  }

  /** @param {LiveUav} uav @param {boolean} isChosen @param {string} letter */
  #drawHead(uav, isChosen, letter) {
    const route = uav.place === null ? "" : `route-${routeNumber(uav.place)}`;
    this.element.className = `card ${route} ${isChosen ? "chosen" : ""}`;
    this.#head.setAttribute("aria-pressed", `${isChosen}`);
    this.#letter.textContent = letter || "–";
    this.#name.textContent = uav.name;
    const { words, level } = stateOf(uav);
    this.#chip.textContent = words;
    this.#chip.className = `chip ${level === "warning" ? "aborted" : level === "active" ? "draft" : ""}`;
  }

  /** @param {LiveUav} uav @param {number} now_ms */
  #drawAge(uav, now_ms) {
    const { words, isLate } = ageWords(uav, now_ms);
    refill(this.#age, `${isLate} ${words}`, () => [isLate && icon("signal", "small"), words]);
    this.#age.classList.toggle("late", isLate);
  }

  /** Whether it is simulated, and in which mission it flies. @param {LiveUav} uav @param {LiveMission | null} mission */
  #drawAbout(uav, mission) {
    const rate = rateOf(uav);
    const name = mission && h("a", { href: `/missions/${mission.id}/fly` }, mission.name);
    const ofMission = name ? !this.#acts.isOfOne && name : t("not in a mission");
    const about = [uav.is_simulated && simulatedMark(), rate !== 1 && rateMark(rate), ofMission].filter(Boolean);
    this.#about.hidden = about.length === 0;
    refill(this.#about, JSON.stringify([mission && [mission.id, mission.name], uav.is_simulated, rate]), () =>
      about.flatMap((part, index) => (index ? [" ", part] : [part])),
    );
  }

  /** @param {LiveUav} uav @param {Certainty | null} certainty @param {number} now_ms */
  #drawEstimate(uav, certainty, now_ms) {
    const estimate = estimateWords(uav, certainty, now_ms);
    this.#estimate.hidden = estimate === null;
    if (!estimate) return;
    refill(this.#estimate, `${estimate.strong} ${estimate.rest}`, () => [
      icon("circle-dashed"),
      h("span", {}, h("strong", {}, estimate.strong), ` ${estimate.rest}`),
    ]);
  }

  /** @param {LiveUav} uav @param {Certainty | null} certainty */
  #drawFigures(uav, certainty) {
    const figures = figuresOf(uav, certainty);
    refill(this.#figures, JSON.stringify(figures), () =>
      figures.map(({ figure, unit, words, level, title }) =>
        h(
          "div",
          { class: level || null, title: title || null },
          h("dt", {}, words),
          h("dd", {}, figure, unit && h("small", {}, ` ${unit}`)),
        ),
      ),
    );
  }

  /** Minutes to the reserve against minutes home. @param {LiveUav} uav */
  #drawBattery(uav) {
    const words = batteryWords(uav);
    this.#battery.hidden = !words;
    this.#battery.className = `card-battery ${uav.estimated?.battery?.level ?? ""}`;
    refill(this.#battery, words, () => [words]);
  }

  /** A command that could not leave this device, until it is sent or given up. @param {LiveUav} uav @param {UnsentCommand | null} unsent */
  #drawUnsent({ id, name }, unsent) {
    this.#unsent.hidden = unsent === null;
    const key = unsent ? `${unsent.key} ${unsent.isBusy} ${unsent.message}` : "";
    refill(this.#unsent, key, () => {
      if (!unsent) return [];
      const { commanding } = this.#acts;
      const words = t("{act} to {name}: not known to be sent. {why}", {
        act: KINDS[unsent.kind],
        name,
        why: unsent.message,
      });
      /** @param {string} label @param {() => unknown} act */
      const button = (label, act) =>
        h(
          "button",
          { type: "button", class: "button small", disabled: unsent.isBusy, onclick: () => void act() },
          label,
        );
      return [
        icon("cloud-off", "small"),
        h("span", {}, h("strong", {}, words)),
        button(unsent.isBusy ? t("Sending…") : t("Try again"), () => commanding?.tryAgain(id)),
        button(t("Give up"), () => commanding?.giveUp(id)),
      ];
    });
  }

  /** Drawn again only where it would be another. @param {LiveUav} uav @param {Known} known @param {number} width_px */
  #drawStrip(uav, { mission, detail, certainty }, width_px) {
    const route = uav.place === null ? null : detail?.plan?.routes[uav.place];
    this.#strip.hidden = !route?.geometry;
    if (!route || this.#strip.hidden || width_px <= 0) return;
    const states = new Map((mission?.targets ?? []).map(({ place, state }) => [place, state]));
    const progress = progressOf(uav, profileOf(route.waypoints, route.length_m).places);
    const key = JSON.stringify([
      width_px,
      detail?.revision,
      certainty,
      progress && [Math.round(progress.at_m / STRIP_STEP_M), Math.round(progress.within_m / STRIP_STEP_M)],
      [...states],
    ]);
    if (this.#strip.dataset.drawn === key) return;
    this.#strip.dataset.drawn = key;
    const label = t("{name}: {done} of {targets}, {flown} of {length} flown", {
      name: uav.name,
      done: route.targets.filter((target) => states.get(target) === "complete").length,
      targets: tn(route.targets.length, "{count} target", "{count} targets"),
      flown: progress ? lengthText(progress.at_m) : "—",
      length: lengthText(route.length_m),
    });
    this.#strip.replaceChildren(liveStrip({ route, width_px, label, states, progress, certainty }));
  }

  /** As the UAV reports it. @param {LiveUav} uav @param {number} now_ms */
  #drawWind(uav, now_ms) {
    const words = windWords(uav, now_ms);
    this.#wind.hidden = !words;
    refill(this.#wind, words, () => [words]);
  }

  /** @param {LiveUav} uav @param {Known} known @param {string} prefix */
  #drawNext(uav, { mission, detail, certainty }, prefix) {
    const numbers = numbersOf(detail);
    const said = nextOf(uav, (place) => {
      const target = mission?.targets[place];
      return target ? `${pillOf(target, numbers, prefix)} ${target.label}` : t("a target");
    });
    this.#next.hidden = !said.next && !said.toGo;
    const at = said.at && `, ${certainty === MEASURED ? "" : "~\u2009"}${said.at}`;
    refill(this.#next, JSON.stringify([said, certainty]), () => [
      h("span", {}, said.next && [t("Next"), " ", h("strong", {}, said.next), at]),
      h("span", { class: "quiet-text" }, said.toGo),
    ]);
  }

  /** @param {Command | null} command */
  #drawCommand(command) {
    this.#command.hidden = command === null;
    if (!command) return;
    const said = commandWords(command);
    this.#command.className = `card-command ${said.level ?? ""}`;
    refill(this.#command, `${command.id} ${command.state} ${said.words}`, () => [
      icon(said.image, "small"),
      h("span", {}, h("strong", {}, said.words), h("small", {}, timesOf(command, exactClockText))),
    ]);
  }

  /** @param {Alert[]} alerts open ones of the UAV */
  #drawAlerts(alerts) {
    const open = alertsInOrder(alerts);
    this.#alerts.hidden = open.length === 0;
    const key = JSON.stringify(open.map(({ id, revision, level, message }) => [id, revision, level, message]));
    refill(this.#alerts, key, () =>
      open.map(({ level, message, acknowledged_at }) =>
        h(
          "li",
          { class: acknowledged_at ? "known" : level },
          icon(acknowledged_at ? "check" : LEVEL_ICONS[level], "small"),
          h("span", {}, message),
        ),
      ),
    );
  }
}
