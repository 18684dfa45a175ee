/** The time of the view: play, the events, and a slider that goes through them. The same player as of the record page. */

import { h, icon, svg } from "../dom.js";
import { routeNumber } from "../domain/palette.js";
import { SPEEDS } from "../record/player.js";
import { eventFrom, ticksOf } from "../record/timeline.js";
import { t } from "../text.js";
import { clockText, dateText, exactClockText, minutesAheadOfUtc, numberText, sinceText } from "../units.js";

const STEPS = 1_000; // of the slider
const NEAR_EVENT_MS = 2_000;
const MINUTE_MS = 60_000;

/**
 * player: of record/player.js; source; eventWords(event) → words. show() draws where the player stands.
 * Times are those of the day; without a departure they are counted from it.
 */
export function createTimeBar({ player, source, eventWords }) {
  const { hasDate, departs_ms } = source;
  let { span } = source;
  const text = (at_ms) =>
    hasDate ? exactClockText(new Date(at_ms).toISOString()) : sinceText((at_ms - departs_ms) / 1_000);
  const name = `scene-speed-${Math.random().toString(36).slice(2)}`;
  const play = h("button", { class: "scene-play", type: "button", onclick: () => player.toggle() });
  const clock = h("strong", { class: "scene-clock" });
  const event = h("span", { class: "scene-event" });
  const speeds = SPEEDS.map((speed) =>
    h("input", { type: "radio", name, value: speed, onchange: () => player.setSpeed(speed) }),
  );
  const slider = h("input", {
    type: "range",
    class: "scene-slider",
    min: 0,
    max: STEPS,
    step: 1,
    "aria-label": t("Time of the flight"),
    oninput: () => (
      player.stop(), player.seek(span.from_ms + (slider.valueAsNumber / STEPS) * (span.to_ms - span.from_ms))
    ),
  });
  const share = (at_ms) => (at_ms - span.from_ms) / (span.to_ms - span.from_ms);
  const marks = h("div", { class: "scene-marks", "aria-hidden": "true" });
  const button = (image, words, key, act) =>
    h(
      "button",
      { class: "icon-button", type: "button", "aria-label": words, title: `${words} (${key})`, onclick: act },
      icon(image),
    );
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
    hasDate && h("span", { class: "caption scene-day" }, dateText(new Date(span.from_ms).toISOString())),
    event,
    h(
      "fieldset",
      { class: "segments line scene-speeds" },
      h("legend", { class: "unseen" }, t("Speed of the replay")),
      speeds.map((input, index) =>
        h(
          "label",
          {},
          input,
          h("span", { class: "segment" }, `${numberText(SPEEDS[index], Number.isInteger(SPEEDS[index]) ? 0 : 1)}×`),
        ),
      ),
    ),
    h("div", { class: "scene-track" }, marks, slider),
  );

  const MARKS = {
    "take-off": "M-4 -4H4V4H-4Z",
    landing: "M-4 -4H4V4H-4Z",
    target: "M0 -4.5A4.5 4.5 0 1 1 0 4.5A4.5 4.5 0 1 1 0 -4.5Z",
    alert: "M0 -5L5.5 4.5H-5.5Z",
  };
  const drawMark = (one) => {
    const mark = svg(
      "svg",
      {
        class: `scene-mark ${one.kind} ${one.place === null || one.place === undefined ? "" : `route-${routeNumber(one.place)}`}`,
        viewBox: "-6 -6 12 12",
        width: 12,
        height: 12,
      },
      svg("path", { d: MARKS[one.kind] }),
    );
    mark.style.left = `${share(one.at_ms) * 100}%`;
    return mark;
  };
  const drawMarks = () => {
    const width_px = marks.clientWidth || 600;
    const { step_ms, moments } = ticksOf(
      hasDate ? span : { from_ms: span.from_ms, to_ms: span.to_ms },
      width_px,
      hasDate ? minutesAheadOfUtc(span.from_ms) : 0,
    );
    const tickText = (at_ms) =>
      hasDate && step_ms >= MINUTE_MS ? clockText(new Date(at_ms).toISOString()) : text(at_ms);
    const ticks = moments
      .filter((at_ms) => share(at_ms) > 0.02 && share(at_ms) < 0.98)
      .map((at_ms) => {
        const tick = h("span", { class: "scene-tick" }, tickText(at_ms));
        tick.style.left = `${share(at_ms) * 100}%`;
        return tick;
      });
    marks.replaceChildren(
      ...ticks,
      ...source.events.filter(({ at_ms }) => at_ms >= span.from_ms && at_ms <= span.to_ms).map(drawMark),
    );
  };
  new ResizeObserver(drawMarks).observe(element);

  function step(direction) {
    player.stop();
    const next = eventFrom(source.events, player.at_ms, direction);
    player.seek(next?.at_ms ?? (direction > 0 ? span.to_ms : span.from_ms));
  }

  function show() {
    const image = player.isPlaying ? "pause" : "play";
    if (play.dataset.image !== image) {
      play.dataset.image = image;
      play.replaceChildren(icon(image));
      play.setAttribute("aria-label", player.isPlaying ? t("Stop") : t("Play"));
      play.title = `${player.isPlaying ? t("Stop") : t("Play")} (${t("Space")})`;
    }
    const words = text(player.at_ms);
    if (clock.textContent !== words) clock.textContent = words;
    slider.value = share(player.at_ms) * STEPS;
    const happened = source.events.findLast(
      ({ at_ms }) => at_ms <= player.at_ms && player.at_ms - at_ms < Math.max(NEAR_EVENT_MS, player.speed * 1_000),
    );
    const said = happened ? eventWords(happened) : "";
    if (event.textContent !== said) event.textContent = said;
    const spoken = [words, said].filter(Boolean).join(", ");
    if (!player.isPlaying && slider.getAttribute("aria-valuetext") !== spoken)
      slider.setAttribute("aria-valuetext", spoken);
    speeds.forEach((input) => (input.checked = Number(input.value) === player.speed));
  }

  /** The source's span and events are others than before. */
  function renew() {
    span = source.span;
    drawMarks();
    show();
  }

  return { element, show, renew, step, text };
}
