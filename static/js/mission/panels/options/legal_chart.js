/** Two days as a bar: all zones on top and each in a row, and the departure that is moved on it. */

import { find, h } from "../../../dom.js";
import { scheduleText } from "../../../domain/schedule_words.js";
import { t } from "../../../text.js";
import { departureText } from "../../options/flight_options.js";
import {
  legsText,
  momentAt,
  STEP_MS,
  shareOf,
  spanAt,
  spanText,
  stepWithin,
  ticksOf,
} from "../../options/legal_times.js";

/** @import { Child } from "../../../dom.js" */
/** @import { legalTimesOf } from "../../options/legal_times.js" */

/** @typedef {ReturnType<typeof legalTimesOf>} LegalTimes */
/** @typedef {LegalTimes["windows"][number]} Span of time */
/** @typedef {{ depart: (moment: number) => void, redraw: () => void }} ChartActs */

const HOUR_MS = 3_600_000;
const [LAST_ROOM, LAST_ROOM_WIDE] = [0.78, 0.93]; // a label that begins later has no room to the right, on a phone and on a desk

/** To which side a label has no room. @param {number} share */
const sideOf = (share) => (share < 0.15 ? "at-begin" : share > 0.85 ? "at-end" : "within");

/** @param {LegalTimes} times @param {number} moment */
const percentAt = (times, moment) => `${shareOf(times, moment) * 100}%`;

/** @param {HTMLElement} element @param {LegalTimes} times @param {Span} span */
function placeSpan(element, times, { from_ms, to_ms }) {
  element.style.left = percentAt(times, from_ms);
  element.style.width = `${(shareOf(times, to_ms) - shareOf(times, from_ms)) * 100}%`;
  return element;
}

/** The moment under the pointer. @param {LegalTimes} times @param {MouseEvent} event @param {Element} track */
function momentUnder(times, event, track) {
  const box = track.getBoundingClientRect();
  return momentAt(times, (event.clientX - box.left) / box.width);
}

/** @param {Child} name @param {string[]} seconds @param {HTMLElement} track @param {string} [kind] */
const row = (name, seconds, track, kind = "") =>
  h(
    "div",
    { class: `legal-row ${kind}`.trim() },
    h(
      "div",
      { class: "legal-name" },
      name,
      seconds.map((words) => h("small", { title: words }, words)),
    ),
    track,
  );

/** @param {LegalTimes} times */
function axis(times) {
  const ticks = ticksOf(times).map(({ at_ms, words, isDay }) => {
    const share = shareOf(times, at_ms);
    const classes = [isDay && "day", share > LAST_ROOM && "late", share > LAST_ROOM_WIDE && "at-end"];
    const tick = h("span", { class: classes.filter(Boolean).join(" ") || null }, words);
    tick.style.left = percentAt(times, at_ms);
    return tick;
  });
  return h(
    "div",
    { class: "legal-row legal-axis", "aria-hidden": "true" },
    h("div", {}),
    h("div", { class: "legal-ticks" }, ticks),
  );
}

/**
 * Free spans are buttons: a click selects the moment at the pointer, Enter the begin of the span.
 *
 * @param {LegalTimes} times
 * @param {ChartActs} acts
 */
function unionTrack(times, { depart }) {
  const track = h("div", { class: "legal-track", role: "group", "aria-label": t("Permitted departure times") });
  times.windows.forEach((free, index) => {
    const button = h("button", {
      type: "button",
      class: "legal-free",
      dataset: { part: `free-${index}` },
      title: spanText(free),
      "aria-label": t("Depart at the begin of {span}", { span: spanText(free) }),
    });
    button.addEventListener("click", (event) =>
      depart(stepWithin(free, event.detail ? momentUnder(times, event, track) : free.from_ms)),
    );
    track.append(placeSpan(button, times, free));
  });
  return track;
}

/** @param {LegalTimes} times @param {LegalTimes["zones"][number]} zone */
function zoneTrack(times, { name, blocked }) {
  const words = blocked.length ? blocked.map(spanText).join("; ") : t("not in the way in these hours");
  return h(
    "div",
    { class: "legal-track", role: "img", "aria-label": `${name}: ${words}` },
    blocked.map((closed) => placeSpan(h("i", { class: "legal-blocked", title: spanText(closed) }), times, closed)),
  );
}

/** @param {LegalTimes} times */
function markOfNow(times) {
  const now = Date.now();
  const mark = h(
    "div",
    { class: "legal-now", hidden: now < times.from_ms || now > times.to_ms },
    h("small", {}, t("now")),
  );
  mark.style.left = percentAt(times, now);
  return mark;
}

/** @param {LegalTimes} times @param {number | null} moment of the departure; null: any time @param {ChartActs} acts */
function departureSlider(times, moment, acts) {
  const [least, most] = [momentAt(times, 0), momentAt(times, 1)];
  const at = Math.min(most, Math.max(least, moment ?? Math.max(least, Date.now())));
  const isLegal = spanAt(times.windows, at) !== null;
  const when = departureText(new Date(at).toISOString());
  const slider = h(
    "div",
    {
      class: `legal-departure${moment === null ? " unset" : isLegal ? "" : " illegal"} ${sideOf(shareOf(times, at))}`,
      role: "slider",
      tabindex: 0,
      dataset: { part: "departure" },
      "aria-label": t("Departure"),
      "aria-valuemin": least,
      "aria-valuemax": most,
      "aria-valuenow": at,
      "aria-valuetext":
        moment === null
          ? t("any time")
          : isLegal
            ? t("{when}, zones open", { when })
            : t("{when}, zones closed", { when }),
    },
    h("span", { class: "legal-handle" }),
    h("small", {}, moment === null ? t("Departure") : when),
  );
  slider.style.left = percentAt(times, at);
  slider.addEventListener("keydown", (event) => {
    /** @type {Record<string, number | undefined>} */
    const steps = {
      ArrowRight: STEP_MS,
      ArrowUp: STEP_MS,
      ArrowLeft: -STEP_MS,
      ArrowDown: -STEP_MS,
      PageUp: HOUR_MS,
      PageDown: -HOUR_MS,
      Home: least - at,
      End: most - at,
    };
    const usual = steps[event.key];
    if (usual === undefined) return;
    const step = event.shiftKey && event.key.startsWith("Arrow") ? Math.sign(usual) * HOUR_MS : usual;
    event.preventDefault();
    acts.depart(Math.min(most, Math.max(least, Math.round((at + step) / STEP_MS) * STEP_MS)));
  });
  slider.addEventListener("pointerdown", (event) => {
    event.preventDefault();
    slider.focus();
    drag(slider, times, acts);
  });
  return slider;
}

/**
 * The slider follows the pointer until that is lifted.
 *
 * @param {HTMLElement} slider
 * @param {LegalTimes} times
 * @param {ChartActs} acts
 */
function drag(slider, times, { depart, redraw }) {
  const over = /** @type {HTMLElement} */ (slider.parentElement);
  /** @type {number | null} */
  let moved = null;
  /** @param {PointerEvent} event */
  const follow = (event) => {
    moved = momentUnder(times, event, over);
    slider.style.left = percentAt(times, moved);
    slider.classList.remove("unset", "at-begin", "at-end");
    slider.classList.add(sideOf(shareOf(times, moved)));
    find(slider, "small").textContent = departureText(new Date(moved).toISOString());
    slider.classList.toggle("illegal", spanAt(times.windows, moved) === null);
  };
  /** @param {PointerEvent} last */
  const end = (last) => {
    removeEventListener("pointermove", follow);
    removeEventListener("pointerup", end);
    removeEventListener("pointercancel", end);
    if (moved !== null && last.type === "pointerup") depart(moved);
    else redraw();
  };
  addEventListener("pointermove", follow);
  addEventListener("pointerup", end);
  addEventListener("pointercancel", end);
}

/**
 * @param {HTMLElement} chart is filled
 * @param {LegalTimes} times
 * @param {string | null} departs_at
 * @param {ChartActs} acts
 */
export function drawLegalChart(chart, times, departs_at, acts) {
  const { activeElement } = document;
  const focused =
    activeElement instanceof HTMLElement && chart.contains(activeElement) ? activeElement.dataset.part : null;
  chart.replaceChildren(
    axis(times),
    row(h("strong", {}, t("The mission")), [], unionTrack(times, acts), "union"),
    ...times.zones.map((zone) =>
      row(
        h("span", { class: "legal-zone" }, zone.name),
        [
          scheduleText(zone.schedule, { now: times.from_ms, otherwise: zone.schedule_in_words }),
          legsText(zone.legs),
        ].filter(Boolean),
        zoneTrack(times, zone),
      ),
    ),
    h(
      "div",
      { class: "legal-over" },
      markOfNow(times),
      departureSlider(times, departs_at ? Date.parse(departs_at) : null, acts),
    ),
  );
  if (focused) /** @type {HTMLElement | null} */ (chart.querySelector(`[data-part="${focused}"]`))?.focus();
}
