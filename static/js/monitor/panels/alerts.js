/** Alerts: the worst on top, each with one act and Acknowledge; filters, and closed ones. */

import { get } from "../../api.js";
import { byId, h, icon, keyedList, setChildren } from "../../dom.js";
import { alertsInOrder, downAt, isEndedUnseen, isOpenAlert, isUnanswered, pinnedAlerts } from "../../domain/order.js";
import { feedBell, showAlertCount } from "../../page/bell.js";
import { simulatedMark } from "../../simulated.js";
import { t, tn } from "../../text.js";
import { exactClockText, exactText } from "../../units.js";
import { mountAlarm } from "../alarm.js";
import { isNone } from "../arrival.js";
import { actsNow, besideWords, createSeenLevels, isMoving, messageWords, SEEN_AFTER_MS } from "../text/alert_text.js";
import { acknowledge, acknowledgeEnded, close, note, positionActs, takeOver, tried } from "./alert_acts.js";

/** @import { Answer } from "../../api.js" */
/** @import { AlertLevel, AlertPage } from "../../api_types.d.ts" */
/** @import { Binding } from "../../page/keyboard.js" */
/** @import { Alert, Commanding, LiveUav, MonitorPage, MonitorState, MonitorStore } from "../types.d.ts" */

/**
 * @typedef {object} AlertActs
 * @property {(uav: number) => void} pick
 * @property {Commanding | null} commanding null for who cannot fly
 * @property {() => void} showBoard shows the alerts where they are folded
 */

/** @type {Record<AlertLevel, { words: string, image: string }>} */
const LEVELS = {
  critical: { words: t("Critical"), image: "octagon-alert" },
  warning: { words: t("Warning"), image: "triangle-alert" },
  advisory: { words: t("Advisory"), image: "info" },
};
/** @type {Record<Alert["acts"][number]["kind"], (name: string) => string>} */
const ACT_WORDS = {
  return: (name) => t("Return {name}", { name }),
  hold: (name) => t("Hold {name}", { name }),
  land: (name) => t("Land {name} here", { name }),
  "take-over": () => t("Pilot takes over"),
};
const HISTORY_AT_ONCE = 50;
const MAX_ACKNOWLEDGED = 500; // in one request of the API

/** @param {Alert} alert */
const closeButton = (alert) =>
  h(
    "button",
    { type: "button", class: "button small quiet", "data-act": "close", onclick: () => void close(alert) },
    t("Close"),
  );

/** The history of an alert. @param {Alert} alert */
function historyWords(alert) {
  const summary = [
    alert.closed_at && t("Ended {time}.", { time: exactClockText(alert.closed_at) }),
    worstWords(alert),
    alert.acknowledged_at &&
      t("Acknowledged by {who}, {time}.", {
        who: alert.acknowledged_by ?? t("somebody who has left"),
        time: exactClockText(alert.acknowledged_at),
      }),
    alert.notes > 0 && tn(alert.notes, "{count} note.", "{count} notes."),
  ];
  return summary.filter(Boolean).join(" ");
}

/** The text at the alert's worst level. @param {Alert} alert */
const worstWords = ({ worst, message }) =>
  worst &&
  worst.message !== message &&
  t("Worst, {time}: {message}", { time: exactClockText(worst.at), message: worst.message });

/**
 * Key of a row: it is redrawn only if this changes; words that change with time are updated in place. A button that is redrawn would lose
 * its press.
 *
 * @param {Alert} alert
 * @param {LiveUav | undefined} uav
 * @param {LiveUav[]} uavs
 */
const rowKey = (alert, uav, uavs) =>
  JSON.stringify([
    alert.level,
    isMoving(alert) || alert.message,
    actsNow(alert, uavs).map((act) => [act.kind, act.uav.id]),
    alert.advice,
    alert.own_act,
    downAt(alert),
    alert.worst?.message,
    alert.notes,
    alert.acknowledged_at,
    alert.closed_at,
    alert.is_simulated,
    uav?.name,
    uav?.place,
  ]);

/** @param {Alert} alert */
const noteButton = (alert) =>
  h(
    "button",
    {
      type: "button",
      class: "icon-button tight",
      "aria-label": t("Add note"),
      title: t("Note"),
      onclick: () => void note(alert),
    },
    icon("message-square", "small"),
  );

/** @param {boolean} isQuiet whether there is another act beside it @param {() => void} onclick */
const acknowledgeButton = (isQuiet, onclick) =>
  h(
    "button",
    {
      type: "button",
      class: `button small ${isQuiet ? "quiet" : ""}`,
      "data-act": "acknowledge",
      onclick,
    },
    t("Acknowledge"),
  );

/** @param {MonitorStore} store @param {MonitorPage} page @param {AlertActs} acts @returns {Binding[]} */
export function mountAlerts(store, page, acts) {
  const panel = new AlertPanel(store, page, acts);
  mountAlarm(store);
  feedBell(acts.showBoard);
  if (!page.canFly) return [];
  const words = t("Acknowledge the alert that has focus, or the first");
  return [{ keys: ["a"], words, act: () => panel.acknowledgeFirst() }];
}

class AlertPanel {
  #store;
  #page;
  #acts;
  #list = byId("alert-list");
  #seen = createSeenLevels();
  /** @type {Map<number, (now_ms: number) => void>} */
  #moving = new Map(); // by alert: writes what moves with the time
  /** @type {Alert[]} */
  #ended = []; // shown, and not acknowledged
  /** @type {Map<number, number>} by id: since when it has been shown as ended [ms] */
  #endedSince = new Map();
  #acknowledgeEnded = h("button", {
    type: "button",
    class: "text-button ended-alerts",
    hidden: true,
    onclick: () => void acknowledgeEnded(this.#endedAndSeen()),
  });
  /** @type {Alert[]} */
  #past = []; // read from the history
  #levels = h(
    "select",
    { class: "input", "aria-label": t("Level") },
    h("option", { value: "" }, t("All levels")),
    Object.entries(LEVELS).map(([value, { words }]) => h("option", { value }, words)),
  );
  #uavs = h("select", { class: "input", "aria-label": t("UAV") });
  #history = h(
    "button",
    { type: "button", class: "button small", "aria-pressed": "false", onclick: () => void this.#readHistory() },
    t("History"),
  );
  #drawList = keyedList(
    this.#list,
    (/** @type {Alert} */ { id }) => id,
    (alert) => h("li", { class: "alert", onclick: (/** @type {MouseEvent} */ event) => this.#open(alert, event) }),
    (row, alert) => this.#refresh(row, alert),
  );

  /** @param {MonitorStore} store @param {MonitorPage} page @param {AlertActs} acts */
  constructor(store, page, acts) {
    this.#store = store;
    this.#page = page;
    this.#acts = acts;
    this.#list.before(this.#acknowledgeEnded);
    const filters = byId("alert-filters");
    filters.append(this.#levels, this.#uavs, this.#history);
    for (const select of [this.#levels, this.#uavs]) select.addEventListener("change", () => this.#draw(store.state));
    const opener = byId("alert-filter");
    opener.addEventListener("click", () => {
      filters.hidden = !filters.hidden;
      opener.setAttribute("aria-expanded", `${!filters.hidden}`);
    });
    store.listen(["alerts", "uavs", "isWhole"], (state) => this.#draw(state));
    store.listen(["now_ms"], ({ now_ms }) => {
      for (const write of this.#moving.values()) write(now_ms);
    });
  }

  /** Acknowledge the alert with focus, or the first. */
  acknowledgeFirst() {
    const own = document.activeElement?.closest(".alert");
    const wanted = "[data-act=acknowledge]";
    const button = own?.querySelector(wanted) ?? this.#list.querySelector(wanted);
    if (button instanceof HTMLElement) button.click();
  }

  /** Opening an alert selects its UAV. @param {Alert} alert @param {MouseEvent} event */
  #open({ uav }, { target }) {
    const isControl = target instanceof Element && target.closest("button, a") !== null;
    if (uav !== null && !isControl && this.#store.state.uavs.some(({ id }) => id === uav)) this.#acts.pick(uav);
  }

  get #showsHistory() {
    return this.#history.getAttribute("aria-pressed") === "true";
  }

  /** @param {HTMLElement} row @param {Alert} alert */
  #refresh(row, alert) {
    const uav = this.#store.state.uavs.find(({ id }) => id === alert.uav);
    const key = rowKey(alert, uav, this.#store.state.uavs);
    if (row.dataset.key === key) return;
    row.dataset.key = key;
    const isKnown = !isUnanswered(alert);
    const level = LEVELS[alert.level];
    row.className = `alert ${isKnown || isEndedUnseen(alert) ? "known" : alert.level} ${isOpenAlert(alert) ? "" : "over"}`;
    const hadFocus = row.contains(document.activeElement);
    const time = h(
      "time",
      { datetime: alert.opened_at, title: exactText(alert.opened_at) },
      exactClockText(alert.opened_at),
    );
    setChildren(
      row,
      icon(isKnown ? "check" : level.image),
      this.#summary(alert, uav),
      h("div", { class: "alert-side" }, time, this.#page.canFly && noteButton(alert)),
    );
    if (hadFocus) row.querySelector("button")?.focus({ preventScroll: true });
  }

  /** @param {Alert} alert @param {LiveUav | undefined} uav */
  #summary(alert, uav) {
    const answers = this.#actButtons(alert);
    const seenLevel = () => this.#seen.of(alert.id, performance.now());
    const known =
      this.#page.canFly &&
      isUnanswered(alert) &&
      acknowledgeButton(answers.length > 0, () => void acknowledge(alert, seenLevel()));
    const closing = this.#page.canFly && alert.code === "down-off-plan" && isOpenAlert(alert) && closeButton(alert);
    const recovery = positionActs(alert);
    const past = historyWords(alert);
    const pick = () => uav && this.#acts.pick(uav.id);
    const [message, beside] = [h("span", {}), h("p", { class: "caption" })];
    this.#write(alert, message, beside);
    return h(
      "div",
      { class: "alert-said" },
      h(
        "p",
        { class: "alert-title" },
        h("span", { class: "unseen" }, `${LEVELS[alert.level].words}: `),
        uav && h("button", { type: "button", class: "alert-uav", onclick: pick }, uav.name),
        message,
        alert.is_simulated && [" ", simulatedMark()],
      ),
      beside,
      past && h("p", { class: "caption" }, past),
      (answers.length > 0 || known || closing || recovery.length > 0) &&
        h("div", { class: "alert-acts" }, answers, known, closing, recovery),
    );
  }

  /**
   * Write the texts now, and again over time where they change.
   * @param {Alert} alert @param {HTMLElement} message @param {HTMLElement} beside
   */
  #write(alert, message, beside) {
    /** @param {number} now_ms */
    const write = (now_ms) => {
      const uav = this.#store.state.uavs.find(({ id }) => id === alert.uav);
      const more = besideWords(alert, uav, now_ms);
      message.textContent = messageWords(alert, uav, now_ms);
      beside.textContent = more;
      beside.hidden = more === "";
    };
    write(this.#store.state.now_ms);
    if (isMoving(alert)) this.#moving.set(alert.id, write);
    else this.#moving.delete(alert.id);
  }

  /** What the operator would answer this cause with. @param {Alert} alert */
  #actButtons(alert) {
    if (!this.#page.canFly || !isUnanswered(alert) || !isOpenAlert(alert)) return [];
    return actsNow(alert, this.#store.state.uavs).map(({ kind, uav }) => {
      /** @param {Event} event */
      const ask = ({ currentTarget }) => {
        const opener = /** @type {HTMLElement} */ (currentTarget);
        this.#acts.pick(uav.id);
        if (kind === "take-over") void takeOver(alert, uav.name, this.#seen.of(alert.id, performance.now()), opener);
        else void this.#acts.commanding?.ask(uav.id, kind, opener);
      };
      return h("button", { type: "button", class: "button small", onclick: ask }, ACT_WORDS[kind](uav.name));
    });
  }

  async #readHistory() {
    const isOn = !this.#showsHistory;
    this.#history.setAttribute("aria-pressed", `${isOn}`);
    this.#past = [];
    const mission = this.#page.mission ? `&mission=${this.#page.mission}` : "";
    if (isOn)
      await tried(async () => {
        const answer = await get(`/alerts?state=closed&limit=${HISTORY_AT_ONCE}${mission}`);
        this.#past = /** @type {Answer<AlertPage>} */ (answer).data.results;
      }, t("The history is shown."));
    this.#draw(this.#store.state);
  }

  /** @param {LiveUav[]} uavs */
  #drawUavChoice(uavs) {
    const key = uavs.map(({ id, name }) => `${id} ${name}`).join();
    if (this.#uavs.dataset.key === key) return;
    this.#uavs.dataset.key = key;
    const chosen = this.#uavs.value;
    setChildren(
      this.#uavs,
      h("option", { value: "" }, t("All UAVs")),
      uavs.map(({ id, name }) => h("option", { value: `${id}` }, name)),
    );
    this.#uavs.value = chosen;
  }

  /** @param {Alert} alert */
  #isShown({ level, uav }) {
    const [wantedLevel, wantedUav] = [this.#levels.value, this.#uavs.value];
    return (!wantedLevel || level === wantedLevel) && (!wantedUav || `${uav}` === wantedUav);
  }

  /** One that ended just before the click was not read. */
  #endedAndSeen() {
    const latest = Date.now() - SEEN_AFTER_MS;
    return this.#ended.filter(({ id }) => (this.#endedSince.get(id) ?? Infinity) <= latest);
  }

  /** @param {Alert[]} ended shown ones that are not acknowledged */
  #drawAcknowledgeEnded(ended) {
    this.#ended = ended.slice(0, MAX_ACKNOWLEDGED);
    this.#endedSince = new Map(this.#ended.map(({ id }) => [id, this.#endedSince.get(id) ?? Date.now()]));
    this.#showAcknowledgeEnded();
    if (this.#acknowledgeEnded.hidden && this.#ended.length >= 2)
      setTimeout(() => this.#showAcknowledgeEnded(), SEEN_AFTER_MS);
    this.#acknowledgeEnded.textContent = t("Acknowledge all ended ({count})", { count: this.#ended.length });
  }

  /** Not before one of them can have been read. */
  #showAcknowledgeEnded() {
    this.#acknowledgeEnded.hidden = !this.#page.canFly || this.#ended.length < 2 || this.#endedAndSeen().length === 0;
  }

  /** @param {Readonly<MonitorState>} state */
  #draw(state) {
    this.#drawUavChoice(state.uavs);
    const live = this.#showsHistory ? state.alerts : pinnedAlerts(state.alerts);
    const ids = new Set(live.map(({ id }) => id));
    const past = this.#past.filter(({ id }) => !ids.has(id));
    const shown = alertsInOrder([...live, ...past].filter((alert) => this.#isShown(alert)));
    const unanswered = pinnedAlerts(state.alerts).filter(isUnanswered);
    this.#drawAcknowledgeEnded(shown.filter(isEndedUnseen));
    this.#seen.show(shown, performance.now());
    const ids_shown = new Set(shown.map(({ id }) => id));
    for (const id of this.#moving.keys()) if (!ids_shown.has(id)) this.#moving.delete(id);
    const open = unanswered.length;
    byId("alert-count").textContent = open ? t("{count} open", { count: open }) : "";
    showAlertCount({ all: open, critical: unanswered.filter(({ level }) => level === "critical").length });
    byId("no-alerts").hidden = !isNone(state, shown);
    this.#drawList(shown);
  }
}
