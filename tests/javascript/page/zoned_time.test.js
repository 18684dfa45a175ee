import assert from "node:assert/strict";
import test from "node:test";

globalThis.document = { documentElement: { lang: "en", dataset: { timeZone: "Europe/Berlin" } } };
const { scheduleText } = await import("../../../static/js/domain/schedule_words.js");
const { fromField, toField, weekOf } = await import("../../../static/js/domain/schedule.js");
const { momentTyped, typedMoment, zoneText } = await import("../../../static/js/units.js");

test("a moment is typed by the clock of the reader's zone, which is named with its offset", () => {
  assert.equal(typedMoment("2026-11-21T18:30:00Z"), "2026-11-21T19:30");
  assert.equal(typedMoment("2026-07-01T22:30:00Z"), "2026-07-02T00:30");
  assert.equal(zoneText("2026-11-21T18:30:00Z"), "Europe/Berlin, UTC+1");
  assert.equal(zoneText("2026-07-01T18:30:00Z"), "Europe/Berlin, UTC+2");
});

test("what is typed is the moment on that clock, in winter and in summer", () => {
  assert.equal(momentTyped("2026-11-21T19:30"), "2026-11-21T18:30:00.000Z");
  assert.equal(momentTyped("2026-07-02T00:30"), "2026-07-01T22:30:00.000Z");
});

test("an hour that the clocks skip is the one after it", () => {
  assert.equal(typedMoment(momentTyped("2026-03-29T02:30")), "2026-03-29T03:30");
});

const period = (rest) => ({ startDateTime: null, endDateTime: null, schedule: [], ...rest });
const entry = (rest) => ({
  day: ["MON", "TUE", "WED"],
  startTime: null,
  startEvent: null,
  endTime: null,
  endEvent: null,
  ...rest,
});
const winter = Date.parse("2026-11-21T12:00:00Z");
const year = new Date().getUTCFullYear();
const words = (...periods) => scheduleText(periods, { now: winter });

test("some hours of one day are told as that", () => {
  const today = period({ startDateTime: `${year}-11-21T13:00:00Z`, endDateTime: `${year}-11-21T16:00:00Z` });
  assert.equal(words(today), "21 November, 14:00 to 17:00");
  const overnight = period({ startDateTime: "2020-11-21T22:00:00Z", endDateTime: "2020-11-22T05:00:00Z" });
  assert.equal(words(overnight), "21 November 2020, 23:00 to 22 November 2020, 06:00".replace("21", "from 21"));
  assert.equal(words(period({ endDateTime: "2020-12-31T22:59:00Z" })), "until 31 December 2020");
  assert.equal(words(period({ startDateTime: "2020-11-30T23:00:00Z" })), "from 1 December 2020 on");
});

test("hours of the week are those of the reader's clock, and of UTC as stored", () => {
  assert.equal(
    words(period({ schedule: [entry({ startTime: "08:00:00Z", endTime: "18:00:00Z" })] })),
    "Mon to Wed 09:00 to 19:00 (08:00 to 18:00 UTC)",
  );
  assert.equal(
    words(period({ schedule: [entry({ startTime: "23:30:00Z", endTime: "04:00:00Z" })] })),
    "Tue to Thu 00:30 to 05:00 (23:30 to 04:00 UTC)",
  );
  assert.equal(
    words(period({ schedule: [entry({ startEvent: "SR", endTime: "23:00:00Z" })] })),
    "Mon to Wed sunrise to 24:00 (sunrise to 23:00 UTC)",
  );
  assert.equal(
    words(period({ schedule: [entry({ startEvent: "SR", endEvent: "SS" })] })),
    "Mon to Wed sunrise to sunset",
  );
  assert.equal(words(period({ schedule: [entry({})] })), "Mon to Wed 01:00 to 01:00 (00:00 to 24:00 UTC)");
});

test("no period is always, and what cannot be read is told as the source does", () => {
  assert.equal(scheduleText(null), "Always");
  assert.equal(scheduleText([{ from: 1 }], { otherwise: "As its source says" }), "As its source says");
});

test("the week is drawn by the reader's clock, past midnight on the next day", () => {
  const night = period({ schedule: [entry({ day: ["SUN"], startTime: "22:00:00Z", endTime: "00:00:00Z" })] });
  assert.deepEqual(
    weekOf(night, 1).map(({ day, from_h, to_h }) => [day, from_h, to_h]),
    [
      [6, 23, 24],
      [0, 0, 1],
    ],
  );
  assert.deepEqual(
    weekOf(night, -5).map(({ day, from_h, to_h }) => [day, from_h, to_h]),
    [[6, 17, 19]],
  );
  assert.deepEqual(
    weekOf(period({ schedule: [entry({ day: ["MON"], startTime: "02:00:00Z", endTime: "03:00:00Z" })] }), -5).map(
      ({ day, from_h }) => [day, from_h],
    ),
    [[6, 21]],
  );
});

test("from and until are typed by the reader's clock and stored in UTC", () => {
  assert.equal(toField("2026-11-21T13:00:00Z"), "2026-11-21T14:00");
  assert.equal(fromField("2026-11-21T14:00"), "2026-11-21T13:00:00Z");
});
