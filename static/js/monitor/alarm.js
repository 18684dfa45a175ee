/** Sound and the browser's notifications for alerts: only after somebody has asked for them, one sound for critical, another for warning. */

import { t } from "../text.js";

/** @import { Alert, AlertLevel } from "../api_types.d.ts" */

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

/**
 * Those that have come since the last look and that somebody is to be told of: one cause once, and again where it has become worse.
 *
 * @param {Alert[]} alerts
 * @param {Map<number, AlertLevel>} told level by id
 */
export function newAlerts(alerts, told) {
  /** @param {Alert} alert */
  const isNew = ({ id, level, closed_at, acknowledged_at }) =>
    closed_at === null && acknowledged_at === null && told.get(id) !== level;
  return alerts.filter(isNew);
}

export function createAlarm() {
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
    /** By a click: browsers let nothing sound before one. @param {boolean} isOn */
    setSound(isOn) {
      keep({ sound: isOn });
      if (isOn) play("warning");
    },
    /** Resolves to whether the browser lets us. @param {boolean} isOn */
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
