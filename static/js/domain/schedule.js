/** When a zone applies, as data: periods in the one form that is stored. Stored days and times of day are UTC. */

import { t } from "../text.js";
import { momentTyped, typedMoment } from "../units.js";

/** @import { ScheduleEntry, SchedulePeriod } from "../api_types.d.ts" */

/** @typedef {NonNullable<ScheduleEntry["startEvent"]>} SunEvent */
/** @typedef {{ day: number, from_h: number, to_h: number, softStart: boolean, softEnd: boolean }} Stretch day 0 is Monday */

/** @type {[string, string][]} */
export const DAYS = [
  ["MON", t("Mon")],
  ["TUE", t("Tue")],
  ["WED", t("Wed")],
  ["THU", t("Thu")],
  ["FRI", t("Fri")],
  ["SAT", t("Sat")],
  ["SUN", t("Sun")],
];
/** @type {[SunEvent, string][]} */
export const EVENTS = [
  ["BMCT", t("morning twilight")],
  ["SR", t("sunrise")],
  ["SS", t("sunset")],
  ["EECT", t("end of evening twilight")],
];
// Where an event is drawn on the week bar: it moves with place and season, so its edge is drawn soft.
/** @type {Record<SunEvent, number>} */
const USUAL_H = { BMCT: 5.5, SR: 6, SS: 18, EECT: 18.5 };

/** @returns {ScheduleEntry} */
export const newEntry = () => ({
  day: ["MON", "TUE", "WED", "THU", "FRI"],
  startTime: "08:00:00Z",
  startEvent: null,
  endTime: "18:00:00Z",
  endEvent: null,
});
/** @returns {SchedulePeriod} */
export const newPeriod = () => ({ startDateTime: null, endDateTime: null, schedule: [newEntry()] });

/** @param {string} time */
const hour = (time) => Number(time.slice(0, 2)) + Number(time.slice(3, 5)) / 60;

/**
 * Stretches of one week: [{ day: 0 to 6, from_h, to_h, softStart, softEnd }]; one that goes past midnight is two.
 * ahead_h: offset of the drawn clock from UTC.
 *
 * @param {SchedulePeriod} period
 * @param {number} [ahead_h]
 * @returns {Stretch[]}
 */
export function weekOf(period, ahead_h = 0) {
  return ahead_h ? weekOf(period).flatMap((stretch) => movedOn(stretch, ahead_h)) : weekInUtc(period);
}

const WEEK_H = 168;

/** @param {Stretch} stretch @param {number} ahead_h @returns {Stretch[]} */
function movedOn({ day, from_h, to_h, softStart, softEnd }, ahead_h) {
  const start_h = (day * 24 + from_h + ahead_h + WEEK_H) % WEEK_H;
  const [on, length_h] = [Math.floor(start_h / 24), to_h - from_h];
  const end_h = start_h - on * 24 + length_h;
  if (end_h <= 24) return [{ day: on, from_h: start_h - on * 24, to_h: end_h, softStart, softEnd }];
  return [
    { day: on, from_h: start_h - on * 24, to_h: 24, softStart, softEnd: false },
    { day: (on + 1) % 7, from_h: 0, to_h: end_h - 24, softStart: false, softEnd },
  ];
}

/** @param {SchedulePeriod} period @returns {Stretch[]} */
function weekInUtc(period) {
  const entries = period.schedule.length
    ? period.schedule
    : [{ day: ["ANY"], startTime: null, startEvent: null, endTime: null, endEvent: null }];
  return entries.flatMap((entry) => {
    const days = entry.day.includes("ANY")
      ? [0, 1, 2, 3, 4, 5, 6]
      : entry.day.map((day) => DAYS.findIndex(([key]) => key === day));
    const from_h = entry.startEvent ? USUAL_H[entry.startEvent] : entry.startTime ? hour(entry.startTime) : 0;
    const to_h = entry.endEvent ? USUAL_H[entry.endEvent] : entry.endTime ? hour(entry.endTime) : 24;
    const soft = { softStart: Boolean(entry.startEvent), softEnd: Boolean(entry.endEvent) };
    return days
      .flatMap((day) =>
        to_h > from_h
          ? [{ day, from_h, to_h, ...soft }]
          : [
              { day, from_h, to_h: 24, softStart: soft.softStart, softEnd: false },
              { day: (day + 1) % 7, from_h: 0, to_h, softStart: false, softEnd: soft.softEnd },
            ],
      )
      .filter((stretch) => stretch.to_h > stretch.from_h);
  });
}

/**
 * "2026-12-31T18:00:00Z" ↔ what <input type="datetime-local"> has, by the reader's clock.
 *
 * @param {string | null | undefined} moment
 */
export const toField = (moment) => (moment ? typedMoment(moment) : "");
/** @param {string} value */
export const fromField = (value) => (value ? (momentTyped(value)?.replace(/\.\d+Z$/, "Z") ?? null) : null);
/** @param {string | null | undefined} time */
export const timeToField = (time) => (time ? (time.startsWith("24") ? "23:59" : time.slice(0, 5)) : "");
/** @param {string} value */
export const timeFromField = (value) => (value ? `${value}:00Z` : null);
