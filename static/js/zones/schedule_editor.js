/** Edits when a zone applies: periods with dates, days and times, and a week that shows them. */

import { h, icon, svg } from "../dom.js";
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

const offsetWords = () => {
  const minutes = minutesAheadOfUtc(Date.now());
  if (!minutes) return t("Your clock shows UTC now.");
  const hours = Math.floor(Math.abs(minutes) / 60);
  return t("08:00 UTC is {time} on your clock now (UTC{offset}).", {
    time: `${String((8 + Math.trunc(minutes / 60) + 24) % 24).padStart(2, "0")}:${String(Math.abs(minutes) % 60).padStart(2, "0")}`,
    offset: `${minutes > 0 ? "+" : "−"}${hours}`,
  });
};

/** The week as seven rows of 24 hours; ahead_h: by how much the clock that is drawn is ahead of UTC. */
export function weekDrawing(period, ahead_h = 0) {
  const [left, row, width] = [30, 11, 290];
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

/** { element, read() }; read gives the periods, or null for "always". */
export function scheduleEditor(schedule) {
  let periods = structuredClone(schedule ?? []);
  const body = h("div", { class: "record-form" });
  const element = h("fieldset", {}, h("legend", {}, t("When it applies")), body);
  const tell = () => element.dispatchEvent(new Event("input", { bubbles: true }));
  /** Everything is drawn anew; focus stays at the control that has the same place. */
  const change = (act) => () => {
    const controls = () => [...body.querySelectorAll("input, select, button")];
    const place = controls().indexOf(document.activeElement);
    act();
    draw();
    if (place >= 0) controls()[Math.min(place, controls().length - 1)].focus();
    tell();
  };

  const moment = (period, side, words, number) =>
    h(
      "div",
      { class: "field" },
      h("label", { for: `${side}-${number}` }, words),
      h("input", {
        class: "input",
        id: `${side}-${number}`,
        type: "datetime-local",
        value: toField(period[side]),
        onchange: (event) => ((period[side] = fromField(event.target.value)), tell()),
      }),
    );

  function side(entry, which, words) {
    const event = h(
      "select",
      { class: "input", "aria-label": words },
      [["", t("at a time")], ...EVENTS].map(([key, text]) =>
        h("option", { value: key, selected: key === (entry[`${which}Event`] ?? "") }, text),
      ),
    );
    const time = h("input", {
      class: "input",
      type: "time",
      "aria-label": t("{side}, UTC", { side: words }),
      value: timeToField(entry[`${which}Time`]),
      disabled: Boolean(entry[`${which}Event`]),
    });
    event.addEventListener(
      "change",
      change(() => {
        entry[`${which}Event`] = event.value || null;
        entry[`${which}Time`] = event.value ? null : which === "start" ? "08:00:00Z" : "18:00:00Z";
      }),
    );
    time.addEventListener(
      "change",
      change(() => (entry[`${which}Time`] = timeFromField(time.value))),
    );
    return h(
      "div",
      { class: "field" },
      h("span", { class: "field-label" }, t("{side}, UTC", { side: words })),
      h("div", { class: "time-row" }, time, event),
    );
  }

  function days(entry) {
    const has = (day) => entry.day.includes("ANY") || entry.day.includes(day);
    return h(
      "div",
      { class: "days", role: "group", "aria-label": t("Days") },
      DAYS.map(([key, words]) =>
        h(
          "label",
          {},
          h("input", {
            type: "checkbox",
            checked: has(key),
            onchange: change(() => {
              const chosen = DAYS.map(([day]) => day).filter((day) => (day === key ? !has(day) : has(day)));
              if (chosen.length) entry.day = chosen.length === 7 ? ["ANY"] : chosen; // the last day stays
            }),
          }),
          h("span", {}, words),
        ),
      ),
    );
  }

  function draw() {
    const always = h(
      "label",
      { class: "switch-line" },
      h("input", {
        class: "switch",
        type: "checkbox",
        role: "switch",
        checked: !periods.length,
        onchange: change(() => (periods = periods.length ? [] : [newPeriod()])),
      }),
      t("Always"),
    );
    body.replaceChildren(
      always,
      ...periods.map((period, number) =>
        h(
          "div",
          { class: "period" },
          h(
            "div",
            { class: "period-head" },
            h("strong", {}, periods.length > 1 ? t("Period {number}", { number: number + 1 }) : t("Period")),
            h(
              "button",
              {
                type: "button",
                class: "icon-button tight",
                "aria-label": t("Remove the period"),
                onclick: change(() => periods.splice(number, 1)),
              },
              icon("x", "small"),
            ),
          ),
          h(
            "div",
            { class: "time-row" },
            moment(period, "startDateTime", t("From"), number),
            moment(period, "endDateTime", t("Until"), number),
          ),
          weekDrawing(period),
          ...period.schedule.map((entry, index) =>
            h(
              "div",
              { class: "entry" },
              days(entry),
              side(entry, "start", t("Begins")),
              side(entry, "end", t("Ends")),
              h(
                "button",
                { type: "button", class: "text-button", onclick: change(() => period.schedule.splice(index, 1)) },
                t("Remove these hours"),
              ),
            ),
          ),
          h(
            "button",
            { type: "button", class: "text-button", onclick: change(() => period.schedule.push(newEntry())) },
            period.schedule.length ? t("Add hours") : t("Only at certain hours"),
          ),
        ),
      ),
      ...(periods.length
        ? [
            h(
              "button",
              { type: "button", class: "text-button", onclick: change(() => periods.push(newPeriod())) },
              t("Add a period"),
            ),
            h(
              "p",
              { class: "caption" },
              `${t("From and until are by the clock of {zone}. Hours of the week are UTC, as sources state them: they do not move with summer time.", { zone: zoneText(new Date().toISOString()) })} ${offsetWords()}`,
            ),
          ]
        : []),
    );
  }
  draw();
  return { element, read: () => (periods.length ? structuredClone(periods) : null) };
}
