/** Alerts: what is open, the worst and newest first; acknowledged with one click, with a note where somebody has one. */

import { post } from "../api.js";
import { byId, h, icon, keyedList } from "../dom.js";
import { toast } from "../page/toast.js";
import { t, tn } from "../text.js";
import { exactText } from "../units.js";

const RANK = { critical: 0, warning: 1, advisory: 2 };
const ICONS = { critical: "octagon-alert", warning: "triangle-alert", advisory: "info" };
const LEVELS = { critical: t("Critical"), warning: t("Warning"), advisory: t("Advisory") };

const isQuiet = (alert) => Boolean(alert.acknowledged_at || alert.closed_at);

/** Open ones by level, the newest first; then those that are acknowledged or over. */
export function inOrder(alerts) {
  return [...alerts].sort((a, b) => Number(isQuiet(a)) - Number(isQuiet(b)) || (isQuiet(a) ? 0 : RANK[a.level] - RANK[b.level]) || Date.parse(b.opened_at) - Date.parse(a.opened_at));
}

/** canAct: whether whoever looks may acknowledge. names(alert) → the UAV's name. */
export function mountAlerts({ canAct, timeText, onLook, names }) {
  const list = byId("live-alerts");
  let filter = "";
  const busy = new Set();

  async function acknowledge(alert, note = "") {
    if (busy.has(alert.id)) return;
    busy.add(alert.id);
    try {
      await post(`/alerts/${alert.id}/acknowledge`, note ? { note } : {});
    } catch (error) {
      toast(error.message);
    } finally {
      busy.delete(alert.id);
    }
  }

  async function note(alert, form) {
    const text = form.elements.note.value.trim();
    if (!text) return;
    try {
      await post(`/alerts/${alert.id}/notes`, { text });
      form.reset();
      form.closest("details").open = false;
    } catch (error) {
      toast(error.message);
    }
  }

  const make = () => h("li", { class: "alert-row", tabindex: "-1" });

  function refresh(row, alert) {
    const said = `${alert.revision} ${alert.acknowledged_at} ${alert.closed_at} ${alert.notes} ${alert.message}`;
    if (row.dataset.said === said) return;
    const hadFocus = row.contains(document.activeElement);
    row.dataset.said = said;
    row.dataset.alert = alert.id;
    row.className = `alert-row ${isQuiet(alert) ? "quiet" : alert.level}`;
    const state = alert.closed_at ? t("over since {time}", { time: timeText(alert.closed_at) }) : alert.acknowledged_at ? t("acknowledged by {name}, {time}", { name: alert.acknowledged_by ?? t("somebody"), time: timeText(alert.acknowledged_at) }) : "";
    row.replaceChildren(
      icon(isQuiet(alert) ? "check" : ICONS[alert.level]),
      h("div", { class: "alert-said" },
        h("div", { class: "alert-head" }, h("button", { type: "button", class: "alert-title", onclick: () => onLook(alert) }, h("span", { class: "unseen" }, `${LEVELS[alert.level]}: `), names(alert)), h("time", { datetime: alert.opened_at, title: exactText(alert.opened_at) }, timeText(alert.opened_at))),
        h("p", {}, alert.message),
        state && h("p", { class: "caption" }, state, alert.notes > 0 && ` · ${tn(alert.notes, "{count} note", "{count} notes")}`),
        canAct && h("div", { class: "alert-acts" },
          !isQuiet(alert) && h("button", { type: "button", class: "button small", onclick: () => void acknowledge(alert) }, t("Acknowledge")),
          h("details", { class: "alert-note" }, h("summary", {}, t("Add a note")), h("form", { onsubmit: (event) => (event.preventDefault(), void note(alert, event.currentTarget)) }, h("input", { class: "input", name: "note", maxlength: 1000, "aria-label": t("Note") }), h("button", { class: "button small" }, t("Save")))))),
    );
    if (hadFocus) (row.querySelector("button") ?? row).focus({ preventScroll: true });
  }

  const draw = keyedList(list, (alert) => alert.id, make, refresh);
  let alerts = [];
  function show() {
    const shown = inOrder(alerts).filter((alert) => !filter || (filter === "open" ? !isQuiet(alert) : alert.level === filter));
    draw(shown);
    const open = alerts.filter((alert) => !alert.closed_at);
    byId("live-alert-count").textContent = open.length ? tn(open.length, "{count} open", "{count} open") : "";
    byId("live-no-alerts").hidden = shown.length > 0;
    byId("live-no-alerts").textContent = alerts.length ? t("No alert is like that.") : t("No alerts. What needs a hand is said here.");
  }
  byId("live-alert-filter").addEventListener("change", (event) => {
    filter = event.currentTarget.value;
    show();
  });

  return {
    show(next) {
      alerts = next;
      show();
    },
    /** A: the alert that has focus, or the first open one. */
    acknowledgeFocused() {
      const row = document.activeElement?.closest?.(".alert-row");
      const alert = alerts.find(({ id }) => `${id}` === row?.dataset.alert) ?? inOrder(alerts).find((one) => !isQuiet(one));
      if (!alert || isQuiet(alert) || !canAct) return false;
      void acknowledge(alert);
      return true;
    },
  };
}
