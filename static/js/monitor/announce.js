/** Critical alerts are said once; sounds and notifications only after somebody has asked for them. */

import { byId } from "../dom.js";
import { t } from "../text.js";

const KEPT = "spanwise-alert-sounds";
const TONES = { critical: [[880, 0.18], [0, 0.08], [880, 0.18], [0, 0.08], [880, 0.3]], warning: [[523, 0.22], [659, 0.3]] }; // Hz and s

function play(context, level) {
  let at = context.currentTime + 0.02;
  for (const [frequency, lasts_s] of TONES[level]) {
    if (frequency) {
      const [tone, volume] = [context.createOscillator(), context.createGain()];
      tone.frequency.value = frequency;
      volume.gain.setValueAtTime(0.0001, at);
      volume.gain.exponentialRampToValueAtTime(0.25, at + 0.02);
      volume.gain.exponentialRampToValueAtTime(0.0001, at + lasts_s);
      tone.connect(volume).connect(context.destination);
      tone.start(at);
      tone.stop(at + lasts_s);
    }
    at += lasts_s;
  }
}

/** take(alerts) after each word; what was there at first is not announced. */
export function createAnnouncing({ names }) {
  const button = byId("live-sounds");
  const told = new Map(); // alert → its level when it was told
  let isFirst = true;
  let context = null;
  let isOn = false;

  function show() {
    button.setAttribute("aria-pressed", String(isOn));
    button.textContent = isOn ? t("Sounds on") : t("Sounds off");
  }

  async function turn(on) {
    isOn = on;
    localStorage.setItem(KEPT, on ? "on" : "");
    if (on) {
      context ??= new AudioContext();
      await context.resume();
      if ("Notification" in globalThis && Notification.permission === "default") await Notification.requestPermission();
    }
    show();
  }
  button.addEventListener("click", () => void turn(!isOn));
  show();
  if (localStorage.getItem(KEPT)) addEventListener("pointerdown", () => void turn(true), { once: true }); // a browser makes no sound before somebody has touched the page

  return function take(alerts) {
    for (const alert of alerts) {
      const isNew = told.get(alert.id) !== alert.level;
      told.set(alert.id, alert.level);
      if (isFirst || !isNew || alert.closed_at || alert.acknowledged_at) continue;
      const words = `${names(alert)}: ${alert.message}`;
      if (alert.level === "critical") byId("live-spoken").textContent = words;
      if (!isOn || alert.level === "advisory") continue;
      if (context) play(context, alert.level);
      if (document.hidden && "Notification" in globalThis && Notification.permission === "granted") new Notification(words, { tag: `alert-${alert.id}` });
    }
    isFirst = false;
  };
}
