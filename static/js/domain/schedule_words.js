/** When a zone applies, as text in the reader's time zone. Values in, values out; stored times are UTC. */

import { t } from "../text.js";
import { clockText, longDayText, minutesAheadOfUtc, typedMoment } from "../units.js";
import { DAYS, EVENTS } from "./schedule.js";

/** @import { ScheduleEntry, SchedulePeriod } from "../api_types.d.ts" */

const DAY_MIN = 1440;
const EVENT_WORDS = Object.fromEntries(EVENTS);

/**
 * "21 November, 14:00 to 17:00", "Mon to Fri 09:00 to 19:00 (08:00 to 18:00 UTC), until 31 December". schedule: the stored periods, null
 * for always; now [ms]: its offset from UTC applies to hours of the week. What cannot be parsed is returned as stored, in `otherwise`.
 *
 * @param {SchedulePeriod[] | null} schedule
 * @param {{ now?: number, otherwise?: string }} [how]
 */
export function scheduleText(schedule, { now = Date.now(), otherwise = "" } = {}) {
  if (!schedule) return t("Always");
  try {
    return schedule.map((period) => periodText(period, minutesAheadOfUtc(now))).join("; ");
  } catch {
    return otherwise; // stored before there was one form
  }
}

/** @param {SchedulePeriod} period @param {number} ahead_min */
function periodText({ startDateTime: start, endDateTime: end, schedule }, ahead_min) {
  const hours = schedule.map((entry) => entryText(entry, ahead_min)).join(", ");
  if (start && end && !hours && dayOf(start) === dayOf(end))
    return t("{day}, {from} to {to}", { day: longDayText(start), from: clockText(start), to: clockText(end) });
  const values = { hours, from: start && momentText(start), to: end && momentText(end) };
  if (start && end) return hours ? t("{hours}, from {from} to {to}", values) : t("from {from} to {to}", values);
  if (start) return hours ? t("{hours}, from {from} on", values) : t("from {from} on", values);
  if (end) return hours ? t("{hours}, until {to}", values) : t("until {to}", values);
  return hours || t("Always");
}

/** @param {string} iso */
const dayOf = (iso) => typedMoment(iso).slice(0, 10);

/** Whole days have no clock. @param {string} iso */
const momentText = (iso) =>
  ["00:00", "23:59"].includes(typedMoment(iso).slice(11)) ? longDayText(iso) : `${longDayText(iso)}, ${clockText(iso)}`;

/** @param {ScheduleEntry} entry @param {number} ahead_min */
function entryText(entry, ahead_min) {
  const { startTime, startEvent, endTime, endEvent } = entry;
  const isAllDay = !startTime && !startEvent && !endTime && !endEvent;
  if (isAllDay && (ahead_min === 0 || entry.day.includes("ANY")))
    return t("{days} all day", { days: daysText(entry.day, 0) });
  const start_min = startEvent ? null : minutesOf(startTime ?? "00:00");
  const end_min = endEvent ? null : minutesOf(endTime ?? "24:00");
  const moved = start_min === null ? 0 : Math.floor((start_min + ahead_min) / DAY_MIN);
  /** @param {number | null} minutes @param {string | null} event @param {number} by_min */
  const side = (minutes, event, by_min) => (minutes === null ? EVENT_WORDS[event ?? ""] : timeText(minutes + by_min));
  const words = t("{days} {from} to {to}", {
    days: daysText(entry.day, moved),
    from: side(start_min, startEvent, ahead_min),
    to: side(end_min, endEvent, ahead_min),
  });
  if (ahead_min === 0 || (startEvent && endEvent)) return words;
  return t("{words} ({from} to {to} UTC)", {
    words,
    from: side(start_min, startEvent, 0),
    to: side(end_min, endEvent, 0),
  });
}

/** @param {string} time */
const minutesOf = (time) => Number(time.slice(0, 2)) * 60 + Number(time.slice(3, 5));

/** @param {number} minutes */
function timeText(minutes) {
  const within = ((minutes % DAY_MIN) + DAY_MIN) % DAY_MIN || (minutes ? DAY_MIN : 0);
  return `${`${Math.floor(within / 60)}`.padStart(2, "0")}:${`${within % 60}`.padStart(2, "0")}`;
}

/**
 * Days of the week, moved by `moved` days where the reader's clock is on another day then.
 *
 * @param {string[]} days
 * @param {number} moved
 */
function daysText(days, moved) {
  if (days.includes("ANY")) return t("daily");
  const numbers = days.map((day) => (DAYS.findIndex(([key]) => key === day) + moved + 7) % 7).sort((a, b) => a - b);
  const names = numbers.map((number) => DAYS[number][1]);
  const isRun = names.length > 2 && numbers[numbers.length - 1] - numbers[0] === numbers.length - 1;
  return isRun ? t("{first} to {last}|days", { first: names[0], last: names.at(-1) }) : names.join(", ");
}
