/** Whether a zone applies at a moment, by the schedule that its source gives. Values in, values out; days and times are UTC. */

/** @import { ScheduleEntry, SchedulePeriod } from "../api_types.d.ts" */

const DAY_MS = 86_400_000;
const RADIANS = Math.PI / 180;
/** @type {ScheduleEntry["day"]} */
const DAYS = ["SUN", "MON", "TUE", "WED", "THU", "FRI", "SAT"];
// Height of the sun's middle above the horizon: at sunrise and sunset with refraction and half a disc, at civil twilight.
const EVENTS = {
  BMCT: { height_deg: -6, side: -1 },
  SR: { height_deg: -0.833, side: -1 },
  SS: { height_deg: -0.833, side: 1 },
  EECT: { height_deg: -6, side: 1 },
};

/**
 * The moment of an event on the day that begins at `day` (ms, UTC) in local time at [lon, lat], within some two minutes; null where
 * the sun does not rise or set. Source: the sunrise equation, with the mean anomaly and ecliptic longitude of the Astronomical Almanac.
 *
 * @param {keyof typeof EVENTS} name
 * @param {number} day
 * @param {readonly number[]} place
 */
export function sunEvent(name, day, [longitude, latitude]) {
  const { height_deg, side } = EVENTS[name];
  const noon = Math.round((day - Date.UTC(2000, 0, 1)) / DAY_MS) + 0.0008 - longitude / 360; // days since 2000-01-01 12:00 UTC
  const anomaly = (357.5291 + 0.98560028 * noon) * RADIANS;
  const centre = 1.9148 * Math.sin(anomaly) + 0.02 * Math.sin(2 * anomaly) + 0.0003 * Math.sin(3 * anomaly);
  const ecliptic = anomaly + (centre + 282.9372) * RADIANS;
  const transit = noon + 0.0053 * Math.sin(anomaly) - 0.0069 * Math.sin(2 * ecliptic);
  const declination = Math.asin(Math.sin(ecliptic) * Math.sin(23.44 * RADIANS));
  const cosine =
    (Math.sin(height_deg * RADIANS) - Math.sin(latitude * RADIANS) * Math.sin(declination)) /
    (Math.cos(latitude * RADIANS) * Math.cos(declination));
  if (!(Math.abs(cosine) <= 1)) return null;
  const half = Math.acos(cosine) / (2 * Math.PI);
  return Date.UTC(2000, 0, 1, 12) + (transit + side * half) * DAY_MS;
}

/** @param {ScheduleEntry} entry @param {"start" | "end"} side @param {number} day @param {readonly number[]} place */
function timeOf(entry, side, day, place) {
  const event = entry[`${side}Event`];
  if (event) return sunEvent(event, day, place);
  const time = entry[`${side}Time`];
  if (!time) return side === "start" ? day : day + DAY_MS;
  const [hours, minutes, seconds] = time.split(":").map((part) => parseInt(part, 10));
  return day + ((hours * 60 + minutes) * 60 + (seconds || 0)) * 1000;
}

/**
 * true, false, or null (unknown) where a sun event of the entry has no time.
 *
 * @param {ScheduleEntry} entry
 * @param {number} now
 * @param {readonly number[]} place
 */
function entryHolds(entry, now, place) {
  let isUnknown = false;
  const today = Math.floor(now / DAY_MS) * DAY_MS;
  for (const day of [today - DAY_MS, today, today + DAY_MS]) {
    if (!entry.day.includes("ANY") && !entry.day.includes(DAYS[new Date(day).getUTCDay()])) continue;
    const [start, end] = [timeOf(entry, "start", day, place), timeOf(entry, "end", day, place)];
    if (start === null || end === null) isUnknown = true;
    else if (start <= now && now < (end > start ? end : end + DAY_MS)) return true;
  }
  return isUnknown ? null : false;
}

/**
 * schedule: the stored periods, or null for always. An unreadable schedule is unknown, and counts like a zone in force.
 *
 * @param {SchedulePeriod[] | null} schedule
 * @param {number} now [ms]
 * @param {readonly number[]} place longitude, latitude
 */
export function isInForce(schedule, now, place) {
  if (!schedule) return true;
  try {
    /** @type {boolean | null} */
    let answer = false;
    for (const period of schedule) {
      if (
        (period.startDateTime && now < Date.parse(period.startDateTime)) ||
        (period.endDateTime && now >= Date.parse(period.endDateTime))
      )
        continue;
      if (!period.schedule.length) return true;
      for (const entry of period.schedule) {
        const holds = entryHolds(entry, now, place);
        if (holds) return true;
        if (holds === null) answer = null;
      }
    }
    return answer;
  } catch {
    return null; // stored before there was one form
  }
}
