/** The time of the view: play, the events, and a slider. The same player as on the record page. */

import { h, icon, svg } from "../dom.js";
import { routeNumber } from "../domain/palette.js";
import { SPEEDS } from "../record/player.js";
import { eventFrom, ticksOf } from "../record/timeline.js";
import { t } from "../text.js";
import { clockText, dateText, exactClockText, minutesAheadOfUtc, numberText, sinceText } from "../units.js";

/** @import { Player, TimeSpan } from "../record/player.js" */
/** @import { ReplayEvent } from "../record/timeline.js" */
/** @import { FlightSource } from "./types.d.ts" */

/** @typedef {ReturnType<typeof createTimeBar>} TimeBar */
/** @typedef {(at_ms: number) => string} TimeText */

const STEPS = 1_000; // of the slider
const NEAR_EVENT_MS = 2_000;
const MINUTE_MS = 60_000;

/** @type {Record<ReplayEvent["kind"], string>} */
const MARKS = {
  "take-off": "M-4 -4H4V4H-4Z",
  landing: "M-4 -4H4V4H-4Z",
  target: "M0 -4.5A4.5 4.5 0 1 1 0 4.5A4.5 4.5 0 1 1 0 -4.5Z",
  alert: "M0 -5L5.5 4.5H-5.5Z",
};

/** The elapsed share of a span. @param {TimeSpan} span @param {number} at_ms */
const shareOf = ({ from_ms, to_ms }, at_ms) => (at_ms - from_ms) / (to_ms - from_ms);

/** @param {ReplayEvent} event @param {TimeSpan} span @param {readonly number[]} colours of the mission */
function markOf({ kind, place, at_ms }, span, colours) {
  const route = place === null || place === undefined ? "" : `route-${routeNumber(place, colours)}`;
  const mark = svg(
    "svg",
    { class: `scene-mark ${kind} ${route}`, viewBox: "-6 -6 12 12", width: 12, height: 12 },
    svg("path", { d: MARKS[kind] }),
  );
  mark.style.left = `${shareOf(span, at_ms) * 100}%`;
  return mark;
}

/**
 * Round moments over the slider.
 *
 * @param {TimeSpan} span
 * @param {boolean} hasDate
 * @param {number} width_px
 * @param {TimeText} text
 */
function ticksOver(span, hasDate, width_px, text) {
  const { step_ms, moments } = ticksOf(span, width_px, hasDate ? minutesAheadOfUtc(span.from_ms) : 0);
  const tickText = hasDate && step_ms >= MINUTE_MS ? clockText : text;
  return moments
    .map((at_ms) => ({ at_ms, share: shareOf(span, at_ms) }))
    .filter(({ share }) => share > 0.02 && share < 0.98)
    .map(({ at_ms, share }) => {
      const tick = h("span", { class: "scene-tick" }, tickText(at_ms));
      tick.style.left = `${share * 100}%`;
      return tick;
    });
}

/** @param {Player} player */
const speedInputs = (player) => {
  const name = `scene-speed-${Math.random().toString(36).slice(2)}`;
  return SPEEDS.map((speed) =>
    h("input", { type: "radio", name, value: speed, onchange: () => player.setSpeed(speed) }),
  );
};

/** @param {HTMLInputElement[]} inputs of speeds */
const speedChoice = (inputs) =>
  h(
    "fieldset",
    { class: "segments line scene-speeds" },
    h("legend", { class: "unseen" }, t("Speed of the replay")),
    inputs.map((input, index) =>
      h(
        "label",
        {},
        input,
        h("span", { class: "segment" }, `${numberText(SPEEDS[index], Number.isInteger(SPEEDS[index]) ? 0 : 1)}×`),
      ),
    ),
  );

/** @param {string} image @param {string} words @param {string} key @param {() => void} act */
const button = (image, words, key, act) =>
  h(
    "button",
    { class: "icon-button", type: "button", "aria-label": words, title: `${words} (${key})`, onclick: act },
    icon(image),
  );

/** Show Play or Stop, by the player's state. @param {HTMLButtonElement} play @param {Player} player */
function drawPlay(play, { isPlaying }) {
  const image = isPlaying ? "pause" : "play";
  if (play.dataset.image === image) return;
  play.dataset.image = image;
  play.replaceChildren(icon(image));
  play.setAttribute("aria-label", isPlaying ? t("Stop") : t("Play"));
  play.title = `${isPlaying ? t("Stop") : t("Play")} (${t("Space")})`;
}

/** @param {HTMLElement} element @param {string} words */
function write(element, words) {
  if (element.textContent !== words) element.textContent = words;
}

/**
 * Times are those of the day; without a departure they are counted from it.
 *
 * @param {object} options
 * @param {Player} options.player
 * @param {FlightSource} options.source
 * @param {TimeSpan} options.span of the source
 * @param {(event: ReplayEvent) => string} options.eventWords
 */
export function createTimeBar({ player, source, span: firstSpan, eventWords }) {
  const { hasDate } = source;
  let span = firstSpan;
  /** @type {TimeText} */
  const text = (at_ms) => (hasDate ? exactClockText(at_ms) : sinceText((at_ms - (source.departs_ms ?? 0)) / 1_000));
  const play = h("button", { class: "scene-play", type: "button", onclick: () => player.toggle() });
  const clock = h("strong", { class: "scene-clock" });
  const event = h("span", { class: "scene-event" });
  const speeds = speedInputs(player);
  const slider = h("input", {
    type: "range",
    class: "scene-slider",
    min: 0,
    max: STEPS,
    step: 1,
    "aria-label": t("Time of the flight"),
    oninput() {
      player.stop();
      player.seek(span.from_ms + (slider.valueAsNumber / STEPS) * (span.to_ms - span.from_ms));
    },
  });
  const marks = h("div", { class: "scene-marks", "aria-hidden": "true" });
  const element = h(
    "section",
    { class: "scene-time", "aria-label": t("Time line") },
    h(
      "div",
      { class: "scene-time-acts" },
      button("skip-back", t("Previous event"), ",", () => step(-1)),
      play,
      button("skip-forward", t("Next event"), ".", () => step(1)),
    ),
    clock,
    hasDate && h("span", { class: "caption scene-day" }, dateText(span.from_ms)),
    event,
    speedChoice(speeds),
    h("div", { class: "scene-track" }, marks, slider),
  );

  function drawMarks() {
    const within = source.events.filter(({ at_ms }) => at_ms >= span.from_ms && at_ms <= span.to_ms);
    const ticks = ticksOver(span, hasDate, marks.clientWidth || 600, text);
    marks.replaceChildren(...ticks, ...within.map((one) => markOf(one, span, source.colours)));
  }
  new ResizeObserver(drawMarks).observe(element);

  /** @param {number} direction 1 or -1 */
  function step(direction) {
    player.stop();
    const next = eventFrom(source.events, player.at_ms, direction);
    player.seek(next?.at_ms ?? (direction > 0 ? span.to_ms : span.from_ms));
  }

  /** Show the player's position. */
  function show() {
    const { at_ms, speed, isPlaying } = player;
    drawPlay(play, player);
    const words = text(at_ms);
    write(clock, words);
    slider.value = `${shareOf(span, at_ms) * STEPS}`;
    const near_ms = Math.max(NEAR_EVENT_MS, speed * 1_000);
    const happened = source.events.findLast((one) => one.at_ms <= at_ms && at_ms - one.at_ms < near_ms);
    const summary = happened ? eventWords(happened) : "";
    write(event, summary);
    const valueText = [words, summary].filter(Boolean).join(", ");
    if (!isPlaying && slider.getAttribute("aria-valuetext") !== valueText)
      slider.setAttribute("aria-valuetext", valueText);
    for (const input of speeds) input.checked = Number(input.value) === speed;
  }

  return {
    element,
    show,
    /** The source's span and events are others than before. */
    renew() {
      span = source.span ?? span;
      drawMarks();
      show();
    },
    step,
  };
}
