import assert from "node:assert/strict";
import test from "node:test";

globalThis.document = { documentElement: { lang: "en", dataset: { timeZone: "Europe/Berlin" } } };
const {
  betterWords,
  legalTimesOf,
  legsText,
  mayDepartBetter,
  momentAt,
  shareOf,
  spanText,
  stepWithin,
  ticksOf,
  wordsOf,
  marginText,
} = await import("../../../static/js/mission/options/legal_times.js");

const plain = (text) => text.replaceAll("\u00a0", " ");
const at = (text) => Date.parse(`2026-11-${text}Z`);
const times = legalTimesOf({
  from: "2026-11-21T18:02:00Z",
  to: "2026-11-23T18:02:00Z",
  windows: [
    { from: "2026-11-21T18:02:00Z", to: "2026-11-22T06:00:00Z" },
    { from: "2026-11-22T18:00:00Z", to: "2026-11-23T06:00:00Z" },
  ],
  zones: [
    {
      id: 1,
      name: "School",
      blocked: [
        { from: "2026-11-22T06:00:00Z", to: "2026-11-22T18:00:00Z" },
        { from: "2026-11-23T06:00:00Z", to: "2026-11-23T18:02:00Z" },
      ],
      legs: [],
      schedule_in_words: "daily",
    },
  ],
});

test("a place on the bar is a moment and back, on full five minutes within it", () => {
  assert.equal(shareOf(times, at("22T18:02:00")), 0.5);
  assert.equal(momentAt(times, 0.5), at("22T18:00:00"));
  assert.equal(momentAt(times, -1), at("21T18:05:00"));
  assert.equal(momentAt(times, 2), at("23T18:00:00"));
  assert.equal(momentAt({ ...times, to_ms: at("23T18:00:00") }, 1), at("23T17:55:00"), "a bar is open at its end");
});

test("a departure taken from a free span stays inside it", () => {
  assert.equal(stepWithin(times.windows[0], at("22T06:00:00")), at("22T05:55:00"));
  assert.equal(stepWithin(times.windows[0], at("21T18:00:00")), at("21T18:05:00"));
  const short = { from_ms: at("22T06:01:00"), to_ms: at("22T06:03:00") };
  assert.equal(stepWithin(short, at("22T06:00:00")), short.from_ms);
});

test("ticks stand at every sixth hour of the reader's clock, and midnight names the day", () => {
  assert.deepEqual(
    ticksOf(times)
      .slice(0, 3)
      .map(({ at_ms, isDay }) => [new Date(at_ms).toISOString().slice(0, 16), isDay]),
    [
      ["2026-11-21T23:00", true],
      ["2026-11-22T05:00", false],
      ["2026-11-22T11:00", false],
    ],
  );
  assert.match(ticksOf(times)[0].words, /Sun/);
});

test("the sentence says how much is free, and why a departure is not legal and when the next one is", () => {
  assert.equal(plain(wordsOf(times, null).sentence), "Zones open for 23 h 58 min of the next 48 hours.");
  assert.match(wordsOf(times, null).departure, /^No departure time/);
  assert.match(wordsOf(times, "2026-11-21T20:00:00Z").departure, /: zones open\.$/);
  const closed = wordsOf(times, "2026-11-22T12:00:00Z").departure;
  assert.match(closed, /closed by School\. Next open departure: 22 Nov, 19:00\.$/);
  assert.match(wordsOf(times, "2026-11-22T06:00:00Z").departure, /zones closed|closed by/); // a span is open at its end
});

test("always and never are said as such", () => {
  const span = { from: "2026-11-21T18:00:00Z", to: "2026-11-23T18:00:00Z" };
  assert.equal(
    wordsOf(legalTimesOf({ ...span, windows: [span], zones: [] }), null).sentence,
    "Zones open throughout the next 48 hours.",
  );
  assert.equal(
    wordsOf(legalTimesOf({ ...span, windows: [], zones: [] }), null).sentence,
    "Zones closed throughout the next 48 hours.",
  );
});

test("spans and legs in words", () => {
  assert.equal(spanText({ from_ms: at("21T18:30:00"), to_ms: at("21T20:00:00") }), "21 Nov, 19:30 to 21:00");
  const waypoints = ["start", "pass", "target", "pass", "target", "end"].map((kind) => ({ kind }));
  const found = legalTimesOf(
    {
      from: "2026-11-21T18:02:00Z",
      to: "2026-11-23T18:02:00Z",
      windows: [],
      zones: [
        {
          name: "School",
          blocked: [],
          legs: [
            [0, -1],
            [0, 1],
            [0, 2],
            [0, 3],
            [1, 4],
          ].map(([uav, leg]) => ({ uav, leg })),
        },
      ],
    },
    [
      { name: "Heron", letter: "A", waypoints },
      { name: "Kite", letter: "B", waypoints },
    ],
  );
  assert.equal(legsText(found.zones[0].legs), "Heron, at take-off, start to A1, A1 to A2; Kite, after B2");
  assert.equal(legsText(["a", "b", "c", "d"].map((way) => ({ uav: "Heron", way }))), "Heron, a, b, c, and more");
});

test("why a window ends sooner than a zone begins is said where there is a zone", () => {
  assert.equal(marginText({ zones: [], margin_s: 300 }), "");
  assert.equal(plain(marginText({ zones: [{}], margin_s: 300 })), "Zones count 5 min before and after their times.");
});

test("a better departure says what it brings, and that there is none until when", () => {
  const totals = { left_out: 1, total_length_m: 3000, done_s: 600, total_duration_s: 600, total_energy_wh: null };
  const found = { departs_at: "2026-11-22T13:00:00Z", looked_until: "2026-11-22T13:00:00Z", before: totals };
  assert.match(
    plain(betterWords({ ...found, then: { ...totals, left_out: 0 } }).words),
    /^Departing .*14:00 reaches 1 target more\.$/,
  );
  assert.match(
    plain(betterWords({ ...found, then: { ...totals, total_length_m: 2000, done_s: 300 } }).words),
    /does better: 1\.0 km less, done 5 min sooner after it\.$/,
  );
  assert.equal(betterWords({ ...found, then: totals }).departs_at, found.departs_at);
  assert.match(
    plain(betterWords({ ...found, departs_at: null, then: null }).words),
    /^No departure until .*14:00 does better/,
  );
  assert.equal(
    betterWords({ ...found, departs_at: null, looked_until: null, then: null }).words,
    "No zone near ends in the next 48 hours.",
  );
});

test("another departure is looked for where a zone is in the way, and targets are few", () => {
  assert.equal(mayDepartBetter({ gap_of: "all_plans", unassigned: [{ reason: "inside_zone" }] }, 12), true);
  assert.equal(mayDepartBetter({ gap_of: "all_plans", unassigned: [{ reason: "inside_zone" }] }, 13), false);
  assert.equal(mayDepartBetter({ gap_of: "without_timed_zones", unassigned: [] }, 3), true);
  assert.equal(mayDepartBetter({ gap_of: "all_plans", unassigned: [{ reason: "beyond_range" }] }, 3), false);
});
