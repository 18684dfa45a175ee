/** The fleet: a card for each UAV. Parts that a second changes are renewed in place, so that focus and pointer stay. */

import { byId, h, icon, keyedList, refill } from "../../dom.js";
import { certaintyOf } from "../../domain/certainty.js";
import { commandWords, isOpen, KINDS, timesOf } from "../../domain/flying.js";
import { alarmOf, alertsInOrder, isOpenAlert } from "../../domain/order.js";
import { colourClass } from "../../domain/palette.js";
import { profileOf } from "../../domain/route_profile.js";
import { simulatedMark } from "../../simulated.js";
import { t, tn } from "../../text.js";
import { exactClockText, lengthText, numberText } from "../../units.js";
import { isNone } from "../arrival.js";
import { numbersOf, pillOf } from "../board.js";
import { letterOf, prefixOf } from "../call_signs.js";
import { batteryWords, figuresOf } from "../card_figures.js";
import { rateOf, rateWords } from "../clock_rate.js";
import { isHead, listed } from "../fleet_groups.js";
import { liveStrip, progressOf } from "../live_strip.js";
import { CONTACT_MEANS, messageWords } from "../text/alert_text.js";
import { estimateWords, stateOf, windWords } from "../text/uav_text.js";
import { makeHead, refreshHead, UavRow } from "./list_rows.js";

/** @import { AlertLevel, Mission } from "../../api_types.d.ts" */
/** @import { Certainty } from "../../domain/certainty.js" */
/** @import { Beside, Figure } from "../card_figures.js" */
/** @import { GroupHead } from "../fleet_groups.js" */
/** @import { Alert, Command, Commanding, LiveMission, LiveUav, MonitorState, MonitorStore, SendingCommand, UnsentCommand } from "../types.d.ts" */

/**
 * @typedef {object} CardActs
 * @property {boolean} isOfOne the page is one mission's, which then need not be named
 * @property {(uav: number) => void} pick
 * @property {(uav: number) => void} jumpTo
 * @property {() => void} close clears the selection
 * @property {() => void} follow
 * @property {(shown: number, all: number) => void} showShown count of UAVs that pass the filter
 * @property {Commanding | null} commanding null for who cannot fly
 */
/** Facts on a card's UAV from other sources. @typedef {{ mission: LiveMission | null, detail: Mission | undefined, certainty: Certainty | null }} Known */

const SHOWN_FOR_MS = 60_000; // a command that is over stays on the card
const STRIP_MARGIN_PX = 32;
const narrow = matchMedia("(max-width: 720px)"); // there, and where several missions fly, a UAV is a row until it is chosen
const STRIP_STEP_M = 5; // a UAV that has moved less is drawn where it was
const FIGURES = ["battery", "height", "speed", "home", "next", "age"]; // in the order of figuresOf
/** @type {Record<AlertLevel, string>} */
const LEVEL_ICONS = { critical: "octagon-alert", warning: "triangle-alert", advisory: "info" };

/** @type {Record<AlertLevel, string>} */
const LEVEL_WORDS = { critical: t("Critical alert"), warning: t("Warning"), advisory: t("Advisory") };
/** @param {string} words */
const unseen = (words) => h("span", { class: "unseen" }, words);

/** @param {number} rate */
const rateMark = (rate) =>
  h(
    "span",
    { class: "simulated-mark", title: rateWords(rate) },
    t("{rate}×", { rate: numberText(rate, Number.isInteger(rate) ? 0 : 1) }),
    h("span", { class: "unseen" }, ` ${rateWords(rate)}`),
  );

/**
 * The running command of a UAV, or one that ended a moment ago; null without one.
 *
 * @param {Pick<LiveUav, "id">} uav
 * @param {Command[]} commands
 * @param {number} now_ms
 */
export function commandOf(uav, commands, now_ms) {
  const own = commands.filter(({ uav: { id } }) => id === uav.id).sort((a, b) => b.sequence - a.sequence);
  return (
    own.find(isOpen) ??
    own.find(({ finished_at }) => finished_at && now_ms - Date.parse(finished_at) < SHOWN_FOR_MS) ??
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
    const entries = listed(state, acts.isOfOne);
    acts.showShown(entries.filter((entry) => !isHead(entry)).length, state.uavs.length);
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
      "sending",
      "filter",
      "numbers",
      "isWhole",
    ],
    (state) => {
      byId("no-uavs").hidden = !isNone(state, state.uavs);
      byId("uavs-loading").hidden = state.isWhole;
      draw();
    },
  );
  store.listen(["chosen"], () => list.querySelector(".card.chosen")?.scrollIntoView({ block: "nearest" }));
  new ResizeObserver(draw).observe(list);
}

/** @param {LiveUav} uav @param {Known} known @param {Readonly<MonitorState>} state @returns {Beside} */
function besideOf(uav, { mission, detail }, { now_ms, numbers }) {
  const targets = numbersOf(detail);
  const place = uav.place ?? -1;
  return {
    now_ms,
    home: detail?.uavs[place]?.position ?? null,
    route: detail?.plan?.routes[place] ?? null,
    targetOf(sequence) {
      const target = mission?.targets[sequence];
      return target ? { pill: pillOf(target, targets, prefixOf(uav.mission, numbers)), label: target.label } : null;
    },
  };
}

class Card {
  #acts;
  #isChosen = false;
  #letter = h("span", { class: "letter" });
  #name = h("strong", {});
  #chip = h("span", { class: "chip" });
  #alarm = h("span", { class: "card-alarm", hidden: true });
  #about = h("p", { class: "caption of-mission" });
  #estimate = h("p", { class: "estimate" });
  #figures = h("dl", { class: "figures" });
  #strip = h("div", { class: "strip-place" });
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
      h("div", { class: "card-top" }, this.#head, this.#alarm),
      this.#about,
      this.#figures,
      this.#strip,
      this.#unsent,
      this.#command,
      this.#estimate,
      this.#battery,
      this.#wind,
      this.#alerts,
      this.#buttons,
    );
  }

  /** @param {LiveUav} uav @param {Readonly<MonitorState>} state @param {number} width_px of its strip, until that has been measured */
  show(uav, state, width_px) {
    const { now_ms, missions, details, commands, alerts } = state;
    const known = {
      mission: missions.find(({ id }) => id === uav.mission) ?? null,
      detail: details.get(uav.mission ?? ""),
      certainty: certaintyOf(uav, now_ms),
    };
    const isChosen = uav.id === state.chosen;
    this.#isChosen = isChosen;
    const alarm = alarmOf(uav.id, alerts);
    this.#drawHead(uav, isChosen, alarm, letterOf(uav, state.numbers));
    this.#drawUnsent(uav, state.unsent.get(uav.id) ?? null);
    const figures = figuresOf(uav, known.certainty, besideOf(uav, known, state));
    if (narrow.matches || !this.#acts.isOfOne) {
      this.#row.show(uav, state, figures);
      if (!isChosen) return;
    }
    this.#drawAbout(uav, known.mission);
    this.#drawEstimate(uav, known.certainty, now_ms);
    this.#drawFigures(figures);
    this.#drawBattery(uav);
    this.#drawWind(uav, now_ms);
    this.#drawStrip(uav, known, Math.round(this.#strip.clientWidth || width_px));
    this.#drawCommand(commandOf(uav, commands, now_ms), state.sending.get(uav.id) ?? null);
    const open = alerts.filter((alert) => alert.uav === uav.id && isOpenAlert(alert));
    this.#drawAlerts(open.map((alert) => ({ ...alert, message: messageWords(alert, uav, now_ms) })));
    const isFollowed = state.isFollowing && isChosen;
    this.#buttons.hidden = !isChosen;
    this.#follow.setAttribute("aria-pressed", `${isFollowed}`);
    this.#follow.textContent = isFollowed ? t("Following") : t("Follow");
  }

  /** An alert marks the card in its place. @param {LiveUav} uav @param {boolean} isChosen @param {AlertLevel | null} alarm @param {string} letter */
  #drawHead(uav, isChosen, alarm, letter) {
    const route = colourClass(uav.colour);
    this.element.className = `card ${route} ${isChosen ? "chosen" : ""} ${alarm ? `alarm-${alarm}` : ""}`;
    this.#alarm.hidden = alarm === null;
    refill(this.#alarm, alarm ?? "", () => (alarm ? [icon(LEVEL_ICONS[alarm]), unseen(LEVEL_WORDS[alarm])] : []));
    this.#head.setAttribute("aria-pressed", `${isChosen}`);
    this.#letter.textContent = letter || "–";
    this.#name.textContent = uav.name;
    const { words, level } = stateOf(uav);
    this.#chip.textContent = words;
    this.#chip.className = `chip ${level === "warning" ? "aborted" : level === "active" ? "draft" : ""}`;
  }

  /** Show whether it is simulated, and its mission. @param {LiveUav} uav @param {LiveMission | null} mission */
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
    this.#estimate.title = uav.estimated?.contact_expected_at ? CONTACT_MEANS : "";
    refill(this.#estimate, `${estimate.strong} ${estimate.rest}`, () => [
      icon("circle-dashed"),
      h("span", {}, h("strong", {}, estimate.strong), ` ${estimate.rest}`),
    ]);
  }

  /** @param {Figure[]} figures */
  #drawFigures(figures) {
    refill(this.#figures, JSON.stringify(figures), () =>
      figures.map(({ figure, unit, words, level, title }, number) =>
        h(
          "div",
          { class: level || null, title: title || null, "data-figure": FIGURES[number] },
          h("dt", {}, words),
          h("dd", {}, figure, unit && h("small", {}, ` ${unit}`)),
        ),
      ),
    );
  }

  /** Minutes to the reserve against minutes home, once that is urgent. @param {LiveUav} uav */
  #drawBattery(uav) {
    const level = uav.estimated?.battery?.level ?? "";
    const words = level && batteryWords(uav);
    this.#battery.hidden = !words;
    this.#battery.className = `card-battery ${level}`;
    refill(this.#battery, words, () => [words]);
  }

  /** Show a command that could not be sent, until it is sent or dropped. @param {LiveUav} uav @param {UnsentCommand | null} unsent */
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
        button(t("Discard"), () => commanding?.giveUp(id)),
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

  /**
   * One line: the command that is being sent, else the last command, its times in the tooltip.
   * @param {Command | null} command @param {SendingCommand | null} sending
   */
  #drawCommand(command, sending) {
    this.#command.hidden = command === null && sending === null;
    if (sending) {
      this.#command.className = "card-command";
      this.#command.title = "";
      const words = t("{act}: being sent …", { act: KINDS[sending.kind] });
      refill(this.#command, words, () => [icon("loader-circle", "small"), h("strong", {}, words)]);
    } else if (command) {
      const summary = commandWords(command);
      this.#command.className = `card-command ${summary.level ?? ""}`;
      this.#command.title = timesOf(command, exactClockText);
      refill(this.#command, `${command.id} ${command.state} ${summary.words}`, () => [
        icon(summary.image, "small"),
        h("strong", {}, summary.words),
      ]);
    }
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
