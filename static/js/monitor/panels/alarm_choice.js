/** Sound, notifications and the announcement of new alerts, and the menu that turns them on and off. */

import { byId, h, icon } from "../../dom.js";
import { toggleMenu } from "../../page/chrome.js";
import { toast } from "../../page/toast.js";
import { t } from "../../text.js";
import { createAlarm, newAlerts } from "../alarm.js";

/** @import { AlertLevel } from "../../api_types.d.ts" */
/** @import { MonitorStore } from "../types.d.ts" */

/** @param {string} words @param {boolean} isOn @param {(input: HTMLInputElement) => void} onChange */
function choiceRow(words, isOn, onChange) {
  const input = h("input", { class: "switch", type: "checkbox", role: "switch", checked: isOn });
  input.addEventListener("change", () => onChange(input));
  return h("label", { class: "switch-row" }, h("span", {}, words), input);
}

/** @param {ReturnType<typeof createAlarm>} alarm @param {() => void} onChange */
function makeMenu(alarm, onChange) {
  const { sound, notify } = alarm.choice();
  /** @param {HTMLInputElement} input */
  async function changeNotify(input) {
    if (await alarm.setNotify(input.checked)) return;
    input.checked = false;
    toast(t("The browser does not allow notifications here."));
  }
  return h(
    "div",
    { class: "menu float alarm-menu", role: "group", "aria-label": t("Sound and notifications") },
    choiceRow(t("Sound for critical alerts and warnings"), sound, (input) => {
      alarm.setSound(input.checked);
      onChange();
    }),
    choiceRow(t("Notifications of the browser"), notify, (input) => void changeNotify(input)),
  );
}

/** Announces what comes in, once a cause, after the first snapshot. @param {MonitorStore} store */
export function mountAlarm(store) {
  const alarm = createAlarm();
  /** @type {Map<number, AlertLevel>} */
  const told = new Map(); // alert → level that was said
  const button = byId("alert-sound");

  function drawButton() {
    const { sound } = alarm.choice();
    const words = sound ? t("Sound and notifications: on") : t("Sound and notifications: off");
    button.replaceChildren(icon(sound ? "volume-2" : "volume-x"));
    button.setAttribute("aria-label", words);
    button.title = words;
  }
  button.addEventListener("click", () => toggleMenu(button, () => makeMenu(alarm, drawButton)));
  drawButton();

  store.listen(["alerts", "isWhole"], ({ alerts, isWhole }) => {
    const fresh = newAlerts(alerts, told);
    for (const { id, level } of alerts) told.set(id, level);
    if (!isWhole || !fresh.length) return;
    const critical = fresh.filter(({ level }) => level === "critical");
    if (critical.length) byId("critical-spoken").textContent = critical.map(({ message }) => message).join(" ");
    alarm.sound(fresh);
    alarm.notify(fresh);
  });
}
