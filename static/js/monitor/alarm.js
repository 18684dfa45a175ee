/** Sound and the browser's notifications for alerts: only after somebody has asked for them, one sound for critical, another for warning. */

import { t } from "../text.js";

const KEY = "spanwise.alarm";
const SOUNDS = {
  critical: [
    [880, 0, 0.16],
    [660, 0.2, 0.16],
    [880, 0.4, 0.16],
    [660, 0.6, 0.22],
  ],
  warning: [[520, 0, 0.28]],
}; // [Hz, after s, for s]
const LOUDNESS = 0.18;

function remembered() {
  try {
    return { sound: false, notify: false, ...JSON.parse(localStorage.getItem(KEY) ?? "{}") };
  } catch {
    return { sound: false, notify: false };
  }
}

/** Those that have come since the last look and that somebody is to be told of: one cause once, and again where it has become worse. */
export function newAlerts(alerts, told) {
  const isNew = ({ id, level, closed_at, acknowledged_at }) =>
    closed_at === null && acknowledged_at === null && told.get(id) !== level;
  return alerts.filter(isNew);
}

export function createAlarm() {
  let choice = remembered();
  let audio = null;

  function play(level) {
    const notes = SOUNDS[level];
    if (!notes || !choice.sound) return;
    audio ??= new AudioContext();
    void audio.resume();
    for (const [hertz, after_s, for_s] of notes) {
      const [tone, volume] = [audio.createOscillator(), audio.createGain()];
      const begin_s = audio.currentTime + after_s;
      tone.type = level === "critical" ? "square" : "sine";
      tone.frequency.value = hertz;
      volume.gain.setValueAtTime(LOUDNESS, begin_s);
      volume.gain.exponentialRampToValueAtTime(0.001, begin_s + for_s);
      tone.connect(volume).connect(audio.destination);
      tone.start(begin_s);
      tone.stop(begin_s + for_s);
    }
  }

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
    /** By a click: browsers let nothing sound before one. */
    setSound(isOn) {
      keep({ sound: isOn });
      if (isOn) play("warning");
    },
    /** Resolves to whether the browser lets us. */
    async setNotify(isOn) {
      const isAllowed = isOn && "Notification" in globalThis && (await Notification.requestPermission()) === "granted";
      keep({ notify: isAllowed });
      return isAllowed === isOn;
    },
    sound: (alerts) => {
      if (alerts.some(({ level }) => level === "critical")) play("critical");
      else if (alerts.some(({ level }) => level === "warning")) play("warning");
    },
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
