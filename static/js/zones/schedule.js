/** When a zone applies, as data: periods in the one form that is stored. Days and times of day are UTC. */

import { t } from "../text.js";

export const DAYS = [["MON", t("Mon")], ["TUE", t("Tue")], ["WED", t("Wed")], ["THU", t("Thu")], ["FRI", t("Fri")], ["SAT", t("Sat")], ["SUN", t("Sun")]];
export const EVENTS = [["BMCT", t("morning twilight")], ["SR", t("sunrise")], ["SS", t("sunset")], ["EECT", t("end of evening twilight")]];
// Where an event is drawn on the week bar: it moves with place and season, so its edge is drawn soft.
const USUAL_H = { BMCT: 5.5, SR: 6, SS: 18, EECT: 18.5 };

export const newEntry = () => ({ day: ["MON", "TUE", "WED", "THU", "FRI"], startTime: "08:00:00Z", startEvent: null, endTime: "18:00:00Z", endEvent: null });
export const newPeriod = () => ({ startDateTime: null, endDateTime: null, schedule: [newEntry()] });

const hour = (time) => Number(time.slice(0, 2)) + Number(time.slice(3, 5)) / 60;

/** Stretches of one week: [{ day: 0 to 6, from_h, to_h, softStart, softEnd }]; one that goes past midnight is two. */
export function weekOf(period) {
  const entries = period.schedule.length ? period.schedule : [{ day: ["ANY"], startTime: null, startEvent: null, endTime: null, endEvent: null }];
  return entries.flatMap((entry) => {
    const days = entry.day.includes("ANY") ? [0, 1, 2, 3, 4, 5, 6] : entry.day.map((day) => DAYS.findIndex(([key]) => key === day));
    const from_h = entry.startEvent ? USUAL_H[entry.startEvent] : entry.startTime ? hour(entry.startTime) : 0;
    const to_h = entry.endEvent ? USUAL_H[entry.endEvent] : entry.endTime ? hour(entry.endTime) : 24;
    const soft = { softStart: Boolean(entry.startEvent), softEnd: Boolean(entry.endEvent) };
    return days.flatMap((day) =>
      to_h > from_h
        ? [{ day, from_h, to_h, ...soft }]
        : [{ day, from_h, to_h: 24, softStart: soft.softStart, softEnd: false }, { day: (day + 1) % 7, from_h: 0, to_h, softStart: false, softEnd: soft.softEnd }],
    ).filter((stretch) => stretch.to_h > stretch.from_h);
  });
}

/** "2026-12-31T18:00:00Z" ↔ what <input type="datetime-local"> has, in UTC. */
export const toField = (moment) => (moment ? moment.slice(0, 16) : "");
export const fromField = (value) => (value ? `${value}:00Z` : null);
export const timeToField = (time) => (time ? (time.startsWith("24") ? "23:59" : time.slice(0, 5)) : "");
export const timeFromField = (value) => (value ? `${value}:00Z` : null);
