/** Sound and browser notifications for alerts: only after the user has enabled them, one sound for critical, another for warning. */

import { byId, h, icon } from "../dom.js";
import { newAlerts } from "../domain/order.js";
import { toggleMenu } from "../page/chrome.js";
import { toast } from "../page/toast.js";
import { t } from "../text.js";

/** @import { Alert, AlertLevel } from "../api_types.d.ts" */
/** @import { MonitorStore } from "./types.d.ts" */

const KEY = "spanwise.alarm";
/** [Hz, after s, for s] @type {Partial<Record<AlertLevel, [number, number, number][]>>} */
const SOUNDS = {
  critical: [
    [880, 0, 0.16],
    [660, 0.2, 0.16],
    [880, 0.4, 0.16],
    [660, 0.6, 0.22],
  ],
  warning: [[520, 0, 0.28]],
};
const LOUDNESS = 0.18;

/** @returns {{ sound: boolean, notify: boolean }} */
function remembered() {
  try {
    return { sound: false, notify: false, ...JSON.parse(localStorage.getItem(KEY) ?? "{}") };
  } catch {
    return { sound: false, notify: false };
  }
}

function createAlarm() {
  let choice = remembered();
  /** @type {AudioContext | null} */
  let audio = null;

  /** @param {AlertLevel} level */
  function play(level) {
    const notes = SOUNDS[level];
    if (!notes || !choice.sound) return;
    audio ??= new AudioContext();
    const output = audio;
    void output.resume();
    for (const [hertz, after_s, for_s] of notes) {
      const [tone, volume] = [output.createOscillator(), output.createGain()];
      const begin_s = output.currentTime + after_s;
      tone.type = level === "critical" ? "square" : "sine";
      tone.frequency.value = hertz;
      volume.gain.setValueAtTime(LOUDNESS, begin_s);
      volume.gain.exponentialRampToValueAtTime(0.001, begin_s + for_s);
      tone.connect(volume).connect(output.destination);
      tone.start(begin_s);
      tone.stop(begin_s + for_s);
    }
  }

  /** @param {Partial<ReturnType<typeof remembered>>} change */
  function keep(change) {
    choice = { ...choice, ...change };
    try {
      localStorage.setItem(KEY, JSON.stringify(choice));
    } catch {
      /* storage is closed: the choice lasts as long as the page */
    }
  }

  return {
    choice: () => choice,
    /** Set by a click: browsers allow no sound before one. @param {boolean} isOn */
    setSound(isOn) {
      keep({ sound: isOn });
      if (isOn) play("warning");
    },
    /** Resolves to whether the browser grants the permission. @param {boolean} isOn */
    async setNotify(isOn) {
      const isAllowed = isOn && "Notification" in globalThis && (await Notification.requestPermission()) === "granted";
      keep({ notify: isAllowed });
      return isAllowed === isOn;
    },
    /** @param {Alert[]} alerts */
    sound: (alerts) => {
      if (alerts.some(({ level }) => level === "critical")) play("critical");
      else if (alerts.some(({ level }) => level === "warning")) play("warning");
    },
    /** @param {Alert[]} alerts */
    notify(alerts) {
      if (
        !choice.notify ||
        !document.hidden ||
        !("Notification" in globalThis) ||
        Notification.permission !== "granted"
      )
        return;
      for (const { id, level, message } of alerts.filter((alert) => alert.level !== "advisory"))
        new Notification(level === "critical" ? t("Critical alert") : t("Warning"), {
          body: message,
          tag: `spanwise-alert-${id}`,
        });
    },
  };
}

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

/** Announce new alerts, once a cause, after the first snapshot. @param {MonitorStore} store */
export function mountAlarm(store) {
  const alarm = createAlarm();
  /** @type {Map<number, AlertLevel>} */
  const reported = new Map(); // alert → level that was announced
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
    const fresh = newAlerts(alerts, reported);
    for (const { id, level } of alerts) reported.set(id, level);
    if (!isWhole || !fresh.length) return;
    const critical = fresh.filter(({ level }) => level === "critical");
    if (critical.length) byId("critical-spoken").textContent = critical.map(({ message }) => message).join(" ");
    alarm.sound(fresh);
    alarm.notify(fresh);
  });
}
