/** Alerts: the worst on top, each with one act and Acknowledge; filters, and what is over. */

import { ApiError, get, post } from "../../api.js";
import { byId, h, icon, keyedList } from "../../dom.js";
import { toggleMenu } from "../../page/chrome.js";
import { confirmAct } from "../../page/confirm.js";
import { say, toast } from "../../page/toast.js";
import { simulatedMark } from "../../simulated.js";
import { t, tn } from "../../text.js";
import { exactClockText, exactText } from "../../units.js";
import { createAlarm, newAlerts } from "../alarm.js";
import { alertsInOrder, isOpenAlert, isUnanswered } from "../order.js";

const LEVELS = {
  critical: { words: t("Critical"), image: "octagon-alert" },
  warning: { words: t("Warning"), image: "triangle-alert" },
  advisory: { words: t("Advisory"), image: "info" },
};
const ACTS = {
  "battery-short": "return",
  "no-progress": "hold",
  "off-route": "pause",
  zone: "hold",
  converging: "hold",
  weather: "return",
  gps: "hold",
  "height-off": "hold",
};
const ACT_WORDS = {
  return: (name) => t("Return {name}", { name }),
  hold: (name) => t("Hold {name}", { name }),
  pause: (name) => t("Pause {name}", { name }),
};
const HISTORY_AT_ONCE = 50;

/** pick(uav id); commanding: null for who cannot fly; showBoard() shows them. Returns keys. */
export function mountAlerts(store, page, { pick, commanding, showBoard }) {
  const alarm = createAlarm();
  const list = byId("alert-list");
  const told = new Map(); // alert → level that was said
  const canFly = page.canFly;
  let past = []; // read from the history

  async function tried(act, words) {
    try {
      await act();
      say(words);
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      toast(error.message);
    }
  }

  const acknowledge = (alert) => tried(() => post(`/alerts/${alert.id}/acknowledge`, {}), t("Acknowledged."));

  async function note(alert) {
    const asked = await confirmAct({
      title: t("A note to this alert"),
      lines: [alert.message],
      field: { name: "text", label: t("Note; it is kept and never changed"), isNeeded: true },
      act: t("Write it down"),
      keep: t("Cancel"),
    });
    if (asked?.text) await tried(() => post(`/alerts/${alert.id}/notes`, { text: asked.text }), t("The note is kept."));
  }

  function make() {
    return h("li", { class: "alert" });
  }

  function refresh(row, alert) {
    const uav = store.state.uavs.find(({ id }) => id === alert.uav);
    const key = JSON.stringify([
      alert.revision,
      alert.message,
      alert.notes,
      alert.acknowledged_at,
      alert.closed_at,
      alert.is_simulated,
      uav?.name,
      uav?.place,
    ]);
    if (row.dataset.key === key) return;
    row.dataset.key = key;
    const isKnown = !isUnanswered(alert);
    row.className = `alert ${isKnown ? "known" : alert.level} ${isOpenAlert(alert) ? "" : "over"}`;
    const level = LEVELS[alert.level];
    const kind = canFly && isUnanswered(alert) && uav ? ACTS[alert.code] : null;
    const said = [
      alert.closed_at && t("Over since {time}.", { time: exactClockText(alert.closed_at) }),
      alert.acknowledged_at &&
        t("Acknowledged by {who}, {time}.", {
          who: alert.acknowledged_by ?? t("somebody who has left"),
          time: exactClockText(alert.acknowledged_at),
        }),
      alert.notes > 0 && tn(alert.notes, "{count} note.", "{count} notes."),
    ]
      .filter(Boolean)
      .join(" ");
    const act =
      kind &&
      h(
        "button",
        {
          type: "button",
          class: "button small",
          onclick: (event) => (pick(uav.id), void commanding.ask(uav.id, kind, event.currentTarget)),
        },
        ACT_WORDS[kind](uav.name),
      );
    const known =
      canFly &&
      isUnanswered(alert) &&
      h(
        "button",
        {
          type: "button",
          class: `button small ${act ? "quiet" : ""}`,
          "data-act": "acknowledge",
          onclick: () => void acknowledge(alert),
        },
        t("Acknowledge"),
      );
    const write =
      canFly &&
      h(
        "button",
        {
          type: "button",
          class: "icon-button tight",
          "aria-label": t("A note to this alert"),
          title: t("Note"),
          onclick: () => void note(alert),
        },
        icon("message-square", "small"),
      );
    const hadFocus = row.contains(document.activeElement);
    row.replaceChildren(
      icon(isKnown ? "check" : level.image),
      h(
        "div",
        { class: "alert-said" },
        h(
          "p",
          { class: "alert-title" },
          h("span", { class: "unseen" }, `${level.words}: `),
          uav ? h("button", { type: "button", class: "alert-uav", onclick: () => pick(uav.id) }, uav.name) : null,
          h("span", {}, alert.message),
          alert.is_simulated && [" ", simulatedMark()],
        ),
        said && h("p", { class: "caption" }, said),
        (act || known) && h("div", { class: "alert-acts" }, act, known),
      ),
      h(
        "div",
        { class: "alert-side" },
        h("time", { datetime: alert.opened_at, title: exactText(alert.opened_at) }, exactClockText(alert.opened_at)),
        write,
      ),
    );
    if (hadFocus) row.querySelector("button")?.focus({ preventScroll: true });
  }

  const draw = keyedList(list, ({ id }) => id, make, refresh);

  // Filters and history

  const levels = h(
    "select",
    { class: "input", "aria-label": t("Level") },
    h("option", { value: "" }, t("All levels")),
    Object.entries(LEVELS).map(([value, { words }]) => h("option", { value }, words)),
  );
  const uavs = h("select", { class: "input", "aria-label": t("UAV") });
  const history = h(
    "button",
    { type: "button", class: "button small", "aria-pressed": "false", onclick: () => void readHistory() },
    t("History"),
  );
  byId("alert-filters").append(levels, uavs, history);
  for (const select of [levels, uavs]) select.addEventListener("change", () => drawAll(store.state));
  byId("alert-filter").addEventListener("click", () => {
    const filters = byId("alert-filters");
    filters.hidden = !filters.hidden;
    byId("alert-filter").setAttribute("aria-expanded", `${!filters.hidden}`);
  });

  async function readHistory() {
    const isOn = history.getAttribute("aria-pressed") !== "true";
    history.setAttribute("aria-pressed", `${isOn}`);
    past = [];
    if (isOn)
      await tried(
        async () =>
          (past = (
            await get(`/alerts?state=closed&limit=${HISTORY_AT_ONCE}${page.mission ? `&mission=${page.mission}` : ""}`)
          ).data.results),
        t("The history is shown."),
      );
    drawAll(store.state);
  }

  function drawUavChoice(state) {
    const key = state.uavs.map(({ id, name }) => `${id} ${name}`).join();
    if (uavs.dataset.key === key) return;
    uavs.dataset.key = key;
    const chosen = uavs.value;
    uavs.replaceChildren(
      h("option", { value: "" }, t("All UAVs")),
      ...state.uavs.map(({ id, name }) => h("option", { value: `${id}` }, name)),
    );
    uavs.value = chosen;
  }

  function drawAll(state) {
    drawUavChoice(state);
    const isShown = ({ level, uav }) =>
      (!levels.value || level === levels.value) && (!uavs.value || `${uav}` === uavs.value);
    const live = state.alerts.filter((alert) => isOpenAlert(alert) || history.getAttribute("aria-pressed") === "true");
    const ids = new Set(live.map(({ id }) => id));
    const shown = alertsInOrder([...live, ...past.filter(({ id }) => !ids.has(id))].filter(isShown));
    const open = state.alerts.filter(isUnanswered).length;
    byId("alert-count").textContent = open ? t("{count} open", { count: open }) : "";
    byId("alert-badge").hidden = open === 0;
    byId("alert-badge").textContent = open;
    byId("open-alerts").setAttribute(
      "aria-label",
      open ? tn(open, "{count} open alert", "{count} open alerts") : t("Alerts"),
    );
    byId("no-alerts").hidden = shown.length > 0;
    draw(shown);
  }

  // What is said and sounded, once a cause

  function tell({ alerts, isWhole }) {
    const fresh = newAlerts(alerts, told);
    for (const { id, level } of alerts) told.set(id, level);
    if (!isWhole || !fresh.length) return;
    const critical = fresh.filter(({ level }) => level === "critical");
    if (critical.length) byId("critical-spoken").textContent = critical.map(({ message }) => message).join(" ");
    alarm.sound(fresh);
    alarm.notify(fresh);
  }

  const sound = byId("alert-sound");
  function drawSound() {
    const { sound: isOn } = alarm.choice();
    sound.replaceChildren(icon(isOn ? "volume-2" : "volume-x"));
    sound.setAttribute("aria-label", isOn ? t("Sound and notifications: on") : t("Sound and notifications: off"));
    sound.title = sound.getAttribute("aria-label");
  }
  const choiceRow = (words, isOn, onchange) =>
    h(
      "label",
      { class: "switch-row" },
      h("span", {}, words),
      h("input", { class: "switch", type: "checkbox", role: "switch", checked: isOn, onchange }),
    );
  sound.addEventListener("click", () =>
    toggleMenu(sound, () =>
      h(
        "div",
        { class: "menu float alarm-menu", role: "group", "aria-label": t("Sound and notifications") },
        choiceRow(
          t("Sound for critical alerts and warnings"),
          alarm.choice().sound,
          ({ target }) => (alarm.setSound(target.checked), drawSound()),
        ),
        choiceRow(t("Notifications of the browser"), alarm.choice().notify, async ({ target }) => {
          if (await alarm.setNotify(target.checked)) return;
          target.checked = false;
          toast(t("The browser does not allow notifications here."));
        }),
      ),
    ),
  );
  drawSound();

  byId("open-alerts").addEventListener("click", showBoard);
  store.listen(["alerts", "uavs"], drawAll);
  store.listen(["alerts", "isWhole"], tell);
  return canFly
    ? [
        {
          keys: ["a"],
          words: t("Acknowledge the alert that has focus, or the first"),
          act: () =>
            (
              document.activeElement?.closest?.(".alert")?.querySelector("[data-act=acknowledge]") ??
              list.querySelector("[data-act=acknowledge]")
            )?.click(),
        },
      ]
    : [];
}
