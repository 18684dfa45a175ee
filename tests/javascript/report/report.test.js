import assert from "node:assert/strict";
import { test } from "node:test";

import { labelsOf, waypointName } from "../../../static/js/record/labels.js";
import { createPlayer } from "../../../static/js/record/player.js";
import {
  eventFrom,
  eventsOf,
  plannedHeights,
  rulesOf,
  scaleOf,
  spanOf,
  ticksOf,
} from "../../../static/js/record/timeline.js";
import {
  estimatesOf,
  flightsOf,
  flownLinesOf,
  linesOf,
  momentOf,
  nearestTo,
  runsOf,
  silenceOf_ms,
  trackOf,
  tracksOf,
} from "../../../static/js/record/track.js";
import { spread } from "../../../static/js/report/strip.js";

const T0 = Date.parse("2026-09-10T09:10:00Z");
const at = (seconds) => ({ at_ms: T0 + seconds * 1000 });
const sample = (seconds, facts = {}) => ({
  ...at(seconds),
  position: [10 + seconds / 1e4, 56],
  height_m: 40,
  speed_mps: 12,
  battery_percent: 90,
  heading_deg: 0,
  mode: "Mission",
  isInAir: true,
  ...facts,
});
const estimate = (seconds) => ({
  ...at(seconds),
  position: [10, 56],
  height_m: 40,
  speed_mps: 12,
  heading_deg: 0,
  bound_m: 30,
  isLost: false,
});
const track = (samples, estimates = []) => trackOf(samples, estimates, silenceOf_ms(null));

test("what counts as silence grows with the spacing of thinned records", () => {
  assert.equal(silenceOf_ms(null), 12_000);
  assert.equal(silenceOf_ms(2), 12_000);
  assert.equal(silenceOf_ms(20), 50_000);
});

test("records become tracks by UAV and time, without those of the future", () => {
  const feature = (uav, seconds, more = {}) => ({
    geometry: { coordinates: [10, 56] },
    properties: {
      uav,
      measured_at: new Date(T0 + seconds * 1000).toISOString(),
      velocity_north_mps: 3,
      velocity_east_mps: 4,
      is_from_future: false,
      ...more,
    },
  });
  const tracks = tracksOf([feature(7, 2), feature(7, 1), feature(8, 0), feature(7, 99, { is_from_future: true })]);
  assert.deepEqual(
    tracks.get(7).map(({ at_ms }) => at_ms - T0),
    [1_000, 2_000],
  );
  assert.equal(tracks.get(7)[0].speed_mps, 5);
  assert.equal(tracks.get(7)[0].battery_percent, null);
  assert.equal(tracks.get(8).length, 1);
  const guess = {
    geometry: { coordinates: [10, 56] },
    properties: { uav: 7, estimated_for: "2026-09-10T09:10:01Z", bound_along_m: 8, bound_across_m: 12, is_lost: false },
  };
  assert.equal(estimatesOf([guess]).get(7)[0].bound_m, 12);
});

test("a line is broken where nothing was heard, and where a value was not told for as long", () => {
  assert.deepEqual(
    runsOf([sample(0), sample(10), sample(23), sample(24)], 12_000).map((run) => run.length),
    [2, 2],
  );
  const lines = linesOf(
    [sample(0), sample(5, { height_m: null }), sample(10), sample(20, { height_m: null }), sample(30)],
    "height_m",
    12_000,
  );
  assert.deepEqual(
    lines.map((line) => line.length),
    [2, 1],
  );
  assert.deepEqual(runsOf([], 12_000), []);
});

test("the nearest sample is found at the ends, between two, and in nothing", () => {
  const samples = [at(0), at(10), at(20)];
  assert.deepEqual(
    [-5, 4, 5, 6, 19, 99].map((seconds) => nearestTo(samples, T0 + seconds * 1000)),
    [0, 0, 0, 1, 2, 2],
  );
  assert.equal(nearestTo([], T0), -1);
});

test("a flight ends with a report from the ground, not with silence", () => {
  const flights = flightsOf([
    sample(0, { isInAir: false }),
    sample(1),
    sample(2),
    sample(90),
    sample(91, { isInAir: false }),
    sample(200),
    sample(210),
  ]);
  assert.deepEqual(
    flights.map(({ from_ms, to_ms }) => [(from_ms - T0) / 1000, (to_ms - T0) / 1000]),
    [
      [1, 90],
      [200, 210],
    ],
  );
  assert.equal(flightsOf([sample(0, { isInAir: null }), sample(5, { isInAir: null })]).length, 1);
});

test("silence is estimated where somebody estimated it, and else empty", () => {
  const own = track(
    [sample(0), sample(5), sample(60), sample(65), sample(200)],
    [estimate(3), estimate(10), estimate(20), estimate(30), estimate(40), estimate(50)],
  );
  assert.deepEqual(
    own.measured.map((run) => run.length),
    [2, 2, 1],
  );
  assert.deepEqual(
    own.estimated.map((run) => [(run[0].at_ms - T0) / 1000, (run.at(-1).at_ms - T0) / 1000]),
    [[5, 60]],
  );
});

test("after the last report the estimates go on until there are none", () => {
  const own = track([sample(0), sample(5)], [estimate(10), estimate(15)]);
  assert.equal(own.estimated[0].at(-1).at_ms, T0 + 15_000);
  assert.equal(spanOf([own]).to_ms, T0 + 15_000);
});

test("a moment is measured, estimated, silent or unknown", () => {
  const own = track(
    [sample(10), sample(15), sample(60), sample(65), sample(200)],
    [estimate(20), estimate(30), estimate(40), estimate(50)],
  );
  const kindAt = (seconds) => momentOf(own, T0 + seconds * 1000)?.kind ?? null;
  assert.deepEqual([0, 10, 13, 21, 62, 100, 200, 201].map(kindAt), [
    null,
    "measured",
    "measured",
    "estimated",
    "measured",
    "silent",
    "measured",
    null,
  ]);
  assert.equal(momentOf(own, T0 + 100_000).sample.at_ms, T0 + 65_000);
  assert.equal(momentOf(track([]), T0), null);
});

test("the time line goes from the first take-off to the last landing", () => {
  const early = track([sample(-900, { isInAir: false }), sample(0), sample(60), sample(70, { isInAir: false })]);
  const late = track([sample(30), sample(100)]);
  assert.deepEqual(spanOf([early, late]), { from_ms: T0, to_ms: T0 + 100_000 });
  assert.equal(spanOf([track([])]), null);
  const ground = track([sample(0, { isInAir: false }), sample(9, { isInAir: false })]);
  assert.equal(spanOf([ground]).to_ms, T0 + 9_000);
});

test("places on the time line go there and back", () => {
  const { x, at_ms } = scaleOf({ from_ms: T0, to_ms: T0 + 100_000 }, 500);
  assert.equal(x(T0 + 50_000), 250);
  assert.equal(at_ms(250), T0 + 50_000);
  assert.equal(at_ms(-20), T0);
  assert.equal(at_ms(900), T0 + 100_000);
});

test("ticks stand at round times of the reader's clock", () => {
  const hour = ticksOf({ from_ms: T0 + 60_000, to_ms: T0 + 4_860_000 }, 800, 0);
  assert.equal(hour.step_ms, 600_000);
  assert.equal(new Date(hour.moments[0]).toISOString(), "2026-09-10T09:20:00.000Z");
  const kathmandu = ticksOf({ from_ms: T0, to_ms: T0 + 36_000_000 }, 800, 345);
  assert.ok(kathmandu.moments.every((moment) => (moment / 60_000 + 345) % 60 === 0));
  assert.ok(ticksOf({ from_ms: T0, to_ms: T0 + 40 * 86_400_000 }, 300, 0).moments.length <= 4);
});

test("a scale has at most three round rules", () => {
  assert.deepEqual(rulesOf(85), [50]);
  assert.deepEqual(rulesOf(100), [50, 100]);
  assert.deepEqual(rulesOf(12), [5, 10]);
  assert.deepEqual(rulesOf(0), []);
  for (const highest of [0.3, 1, 7, 19, 64, 120, 399, 400, 1234])
    assert.ok(rulesOf(highest).length >= 1 && rulesOf(highest).length <= 3, `${highest}`);
});

const routes = [
  { place: 0, uav: 7, track: track([sample(0), sample(60), sample(61, { isInAir: false })]) },
  { place: 1, uav: 8, track: track([sample(20), sample(90)]) },
];
const targets = [
  { place: 4, uav: 0, reached_at: "2026-09-10T09:10:30Z" },
  { place: 5, uav: 1, reached_at: null },
];
const alerts = [{ id: 1, uav: 8, opened_at: "2026-09-10T09:10:40Z", message: "late" }];
const named = (isOver) =>
  eventsOf({ routes, targets, alerts, isOver }).map(({ at_ms, kind, place }) => [(at_ms - T0) / 1000, kind, place]);

test("what happened stands in order; one that is still in the air has not landed", () => {
  assert.deepEqual(named(false), [
    [0, "take-off", 0],
    [20, "take-off", 1],
    [30, "target", 0],
    [40, "alert", 1],
    [60, "landing", 0],
  ]);
  assert.deepEqual(named(true).at(-1), [90, "landing", 1]);
});

test("stepping goes to the next event, and past the one that the cursor stands on", () => {
  const events = eventsOf({ routes, targets, alerts, isOver: true });
  const step = (seconds, direction) => eventFrom(events, T0 + seconds * 1000, direction)?.kind ?? null;
  assert.equal(step(0, 1), "take-off");
  assert.equal(eventFrom(events, T0, 1).at_ms, T0 + 20_000);
  assert.equal(eventFrom(events, T0 + 40_000, -1).at_ms, T0 + 30_000);
  assert.equal(step(90, 1), null);
  assert.equal(step(0, -1), null);
});

test("the plan's heights begin when the UAV took off; without times there are none", () => {
  const waypoints = [
    { arrival_s: 100, altitude_relative_m: 0 },
    { arrival_s: 130, altitude_relative_m: 50 },
  ];
  const flown = { began_at: "2026-09-10T09:10:00Z", clock_rate: 1 };
  assert.deepEqual(plannedHeights({ waypoints, flown }), [
    { at_ms: T0, value: 0 },
    { at_ms: T0 + 30_000, value: 50 },
  ]);
  assert.deepEqual(
    plannedHeights({ waypoints, flown: { ...flown, clock_rate: 2 } }).at(-1),
    { at_ms: T0 + 15_000, value: 50 },
    "a simulation at twice real time flies 30 s in 15",
  );
  assert.deepEqual(plannedHeights({ waypoints: [{ arrival_s: null, altitude_relative_m: 0 }], flown }), []);
  assert.deepEqual(plannedHeights({ waypoints, flown: { began_at: null } }), []);
});

test("targets of a strip are pushed apart and stay within it", () => {
  assert.deepEqual(spread([10, 12, 100], 200), [10, 29, 100]);
  assert.deepEqual(spread([190, 195, 199], 200), [162, 181, 200]);
  assert.deepEqual(spread([], 200), []);
});

test("a replay goes at its speed, stops at the end and begins anew from there", () => {
  let [now, frames, moves] = [0, [], 0];
  const player = createPlayer({ onMove: () => (moves += 1), now_ms: () => now, nextFrame: (act) => frames.push(act) });
  player.toggle();
  assert.equal(player.isPlaying, false, "nothing to play");
  player.setSpan({ from_ms: T0, to_ms: T0 + 60_000 });
  player.toggle();
  now = 1_000;
  frames.shift()();
  assert.equal(player.at_ms, T0 + 20_000);
  now = 9_000;
  frames.shift()();
  assert.equal(player.at_ms, T0 + 60_000);
  assert.equal(player.isPlaying, false);
  player.toggle();
  assert.equal(player.at_ms, T0);
  player.seek(T0 - 5);
  assert.equal(player.at_ms, T0);
  player.changeSpeed(1);
  player.changeSpeed(1);
  assert.equal(player.speed, 60);
  assert.ok(moves > 4);
});

test("a replay that stands at the end goes with it; elsewhere it stays", () => {
  const player = createPlayer({ onMove: () => {}, now_ms: () => 0, nextFrame: () => {} });
  player.setSpan({ from_ms: T0, to_ms: T0 + 60_000 });
  player.setSpan({ from_ms: T0, to_ms: T0 + 90_000 });
  assert.equal(player.at_ms, T0);
  player.seek(T0 + 90_000);
  player.setSpan({ from_ms: T0, to_ms: T0 + 120_000 });
  assert.equal(player.at_ms, T0 + 120_000);
});

test("profiles go from take-off to landing, and a report that tells nothing begins no flight", () => {
  const own = track([
    sample(-30, { isInAir: null, battery_percent: 50 }),
    sample(-20, { isInAir: false, battery_percent: 60 }),
    sample(0),
    sample(10),
    sample(12, { isInAir: false, battery_percent: 20 }),
  ]);
  assert.deepEqual(own.flights, [{ from_ms: T0, to_ms: T0 + 10_000 }]);
  assert.deepEqual(
    flownLinesOf(own, "battery_percent").map((line) => line.map(({ value }) => value)),
    [[90, 90]],
  );
});

test("targets are named by letter and place on the route, ends of legs by what they are", () => {
  const waypoints = [
    { sequence: 0, kind: "start", target: null, position: [10, 56] },
    { sequence: 1, kind: "pass", target: null, position: [10, 56] },
    { sequence: 2, kind: "target", target: 9, position: [10, 56] },
  ];
  const labels = labelsOf([{ place: 1, waypoints }]);
  assert.equal(labels.get(9).label, "B1");
  const words = { start: "take-off" };
  const otherwise = (sequence) => `point ${sequence}`;
  assert.deepEqual(
    [0, 1, 2, 7].map((sequence) => waypointName({ waypoints }, sequence, labels, words, otherwise)),
    ["take-off", "point 1", "B1", "point 7"],
  );
});
