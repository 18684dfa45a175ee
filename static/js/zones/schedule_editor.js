/** Edits when a zone applies: periods with dates, days and times, and a week that shows them. */

import { h, icon, setChildren, svg } from "../dom.js";
import {
  DAYS,
  EVENTS,
  fromField,
  newEntry,
  newPeriod,
  timeFromField,
  timeToField,
  toField,
  weekOf,
} from "../domain/schedule.js";
import { t } from "../text.js";
import { minutesAheadOfUtc, zoneText } from "../units.js";

/** @import { ScheduleEntry, SchedulePeriod } from "../api_types.d.ts" */

const offsetWords = () => {
  const minutes = minutesAheadOfUtc(Date.now());
  if (!minutes) return t("Your clock shows UTC now.");
  const hours = Math.floor(Math.abs(minutes) / 60);
  return t("08:00 UTC is {time} on your clock now (UTC{offset}).", {
    time: `${String((8 + Math.trunc(minutes / 60) + 24) % 24).padStart(2, "0")}:${String(Math.abs(minutes) % 60).padStart(2, "0")}`,
    offset: `${minutes > 0 ? "+" : "−"}${hours}`,
  });
};

/**
 * The week as seven rows of 24 hours.
 *
 * @param {SchedulePeriod} period
 * @param {number} [ahead_h] offset of the drawn clock from UTC
 */
export function weekDrawing(period, ahead_h = 0) {
  const [left, row, width] = [30, 11, 290];
  /** @param {number} hours */
  const x = (hours) => left + (hours / 24) * width;
  const stretches = weekOf(period, ahead_h);
  return svg(
    "svg",
    {
      class: "week",
      viewBox: `0 0 ${left + width + 4} ${7 * row + 16}`,
      role: "img",
      "aria-label": t("The week, with the hours in which the zone applies"),
    },
    ...DAYS.map(([, words], day) => svg("text", { x: 0, y: day * row + 9, "font-size": 9 }, words)),
    ...DAYS.map((_, day) => svg("rect", { x: left, y: day * row + 1, width, height: row - 3, fill: "var(--pressed)" })),
    ...stretches.map(({ day, from_h, to_h, softStart, softEnd }) =>
      svg("rect", {
        x: x(from_h),
        y: day * row + 1,
        width: x(to_h) - x(from_h),
        height: row - 3,
        fill: "var(--zone)",
        opacity: softStart || softEnd ? 0.6 : 0.9,
        ...(softStart || softEnd ? { stroke: "var(--zone)", "stroke-dasharray": "2 2" } : {}),
      }),
    ),
    ...[0, 6, 12, 18, 24].map((hours) =>
      svg(
        "text",
        {
          x: x(hours),
          y: 7 * row + 12,
          "text-anchor": hours === 0 ? "start" : hours === 24 ? "end" : "middle",
          "font-size": 9,
        },
        String(hours).padStart(2, "0"),
      ),
    ),
  );
}

/**
 * A form for the periods; read() returns null for "always".
 *
 * @param {SchedulePeriod[] | null} schedule
 */
export function scheduleEditor(schedule) {
  const editor = new ScheduleEditor(schedule ?? []);
  return { element: editor.element, read: () => editor.read() };
}

class ScheduleEditor {
  #periods;
  #body = h("div", { class: "record-form" });

  /** @param {SchedulePeriod[]} schedule */
  constructor(schedule) {
    this.#periods = structuredClone(schedule);
    this.element = h("fieldset", {}, h("legend", {}, t("When it applies")), this.#body);
    this.#draw();
  }

  read() {
    return this.#periods.length ? structuredClone(this.#periods) : null;
  }

  #notify() {
    this.element.dispatchEvent(new Event("input", { bubbles: true }));
  }

  /** A listener that redraws everything after the act; focus stays at the control in the same place. @param {() => unknown} act */
  #change(act) {
    return () => {
      /** @returns {HTMLElement[]} */
      const controls = () =>
        [...this.#body.querySelectorAll("input, select, button")].map((one) => /** @type {HTMLElement} */ (one));
      const place = controls().findIndex((control) => control.matches(":focus"));
      act();
      this.#draw();
      if (place >= 0) controls()[Math.min(place, controls().length - 1)].focus();
      this.#notify();
    };
  }

  #draw() {
    const turnAlways = () => {
      this.#periods = this.#periods.length ? [] : [newPeriod()];
    };
    const always = h("input", { class: "switch", type: "checkbox", role: "switch", checked: !this.#periods.length });
    always.addEventListener("change", this.#change(turnAlways));
    setChildren(
      this.#body,
      h("label", { class: "switch-line" }, always, t("Always")),
      this.#periods.map((period, number) => this.#period(period, number)),
      this.#periods.length > 0 && [
        this.#textButton(t("Add a period"), () => this.#periods.push(newPeriod())),
        h("p", { class: "caption" }, clockWords(), " ", offsetWords()),
      ],
    );
  }

  /** @param {string} words @param {() => unknown} act */
  #textButton(words, act) {
    return h("button", { type: "button", class: "text-button", onclick: this.#change(act) }, words);
  }

  /** @param {SchedulePeriod} period @param {number} number from 0 */
  #period(period, number) {
    const title = this.#periods.length > 1 ? t("Period {number}", { number: number + 1 }) : t("Period");
    const remove = this.#change(() => this.#periods.splice(number, 1));
    const label = t("Remove the period");
    return h(
      "div",
      { class: "period" },
      h(
        "div",
        { class: "period-head" },
        h("strong", {}, title),
        h(
          "button",
          { type: "button", class: "icon-button tight", "aria-label": label, onclick: remove },
          icon("x", "small"),
        ),
      ),
      h(
        "div",
        { class: "time-row" },
        this.#moment(period, "startDateTime", t("From"), number),
        this.#moment(period, "endDateTime", t("Until"), number),
      ),
      weekDrawing(period),
      period.schedule.map((entry, index) => this.#entry(period, entry, index)),
      this.#textButton(period.schedule.length ? t("Add hours") : t("Only at certain hours"), () =>
        period.schedule.push(newEntry()),
      ),
    );
  }

  /** @param {SchedulePeriod} period @param {ScheduleEntry} entry @param {number} index */
  #entry(period, entry, index) {
    return h(
      "div",
      { class: "entry" },
      this.#days(entry),
      this.#side(entry, "start", t("Begins")),
      this.#side(entry, "end", t("Ends")),
      this.#textButton(t("Remove these hours"), () => period.schedule.splice(index, 1)),
    );
  }

  /** @param {SchedulePeriod} period @param {"startDateTime" | "endDateTime"} side @param {string} words @param {number} number */
  #moment(period, side, words, number) {
    const id = `${side}-${number}`;
    const input = h("input", { class: "input", id, type: "datetime-local", value: toField(period[side]) });
    input.addEventListener("change", () => {
      period[side] = fromField(input.value);
      this.#notify();
    });
    return h("div", { class: "field" }, h("label", { for: id }, words), input);
  }

  /** A time or an event of the sun. @param {ScheduleEntry} entry @param {"start" | "end"} which @param {string} words */
  #side(entry, which, words) {
    /** @type {[string, string][]} */
    const choices = [["", t("at a time")], ...EVENTS];
    const chosen = entry[`${which}Event`] ?? "";
    const event = h(
      "select",
      { class: "input", "aria-label": words },
      choices.map(([key, text]) => h("option", { value: key, selected: key === chosen }, text)),
    );
    const label = t("{side}, UTC", { side: words });
    const value = timeToField(entry[`${which}Time`]);
    const time = h("input", { class: "input", type: "time", "aria-label": label, value, disabled: chosen !== "" });
    const local = h("span", { class: "caption" }, chosen ? "" : localText(entry[`${which}Time`]));
    const takeEvent = () => {
      entry[`${which}Event`] = /** @type {ScheduleEntry["startEvent"]} */ (event.value || null);
      entry[`${which}Time`] = event.value ? null : which === "start" ? "08:00:00Z" : "18:00:00Z";
    };
    const takeTime = () => {
      entry[`${which}Time`] = timeFromField(time.value);
    };
    event.addEventListener("change", this.#change(takeEvent));
    time.addEventListener("change", this.#change(takeTime));
    return h(
      "div",
      { class: "field" },
      h("span", { class: "field-label" }, label),
      h("div", { class: "time-row" }, time, event),
      local,
    );
  }

  /** @param {ScheduleEntry} entry */
  #days(entry) {
    const all = /** @type {ScheduleEntry["day"]} */ (DAYS.map(([day]) => day));
    const has = (/** @type {ScheduleEntry["day"][number]} */ day) =>
      entry.day.includes("ANY") || entry.day.includes(day);
    const boxes = all.map((key, index) => {
      const turn = () => {
        const chosen = all.filter((day) => (day === key ? !has(day) : has(day)));
        if (chosen.length) entry.day = chosen.length === 7 ? ["ANY"] : chosen; // the last day stays
      };
      const box = h("input", { type: "checkbox", checked: has(key), onchange: this.#change(turn) });
      return h("label", {}, box, h("span", {}, DAYS[index][1]));
    });
    return h("div", { class: "days", role: "group", "aria-label": t("Days") }, boxes);
  }
}

function clockWords() {
  const zone = zoneText(new Date().toISOString());
  return t(
    "From and until are by the clock of {zone}. Hours of the week are UTC, as sources state them: they do not move with summer time.",
    { zone },
  );
}

/** "10:00 here": a time of day of UTC by the reader's clock of today. @param {string | null | undefined} time "08:00:00Z" */
export function localText(time) {
  const found = /^(\d\d):(\d\d)/.exec(time ?? "");
  if (!found) return "";
  const ahead = minutesAheadOfUtc(Date.now());
  if (!ahead) return "";
  const minutes = (Number(found[1]) * 60 + Number(found[2]) + ahead + 2_880) % 1_440;
  const clock = [Math.floor(minutes / 60), minutes % 60].map((part) => `${part}`.padStart(2, "0"));
  return t("{time} local today", { time: clock.join(":") });
}
