import assert from "node:assert/strict";
import test from "node:test";

import { distance_m } from "../../../static/js/domain/geodesy.js";
import { positionAt, profileOf } from "../../../static/js/domain/route_profile.js";
import { axisTicks, layOut } from "../../../static/js/mission/strips/span_strip.js";

const EDGE = 10;
const waypoint = (longitude, kind, rest = {}) => ({
  position: [longitude, 0],
  kind,
  asset: kind === "start" || kind === "end" ? null : 1,
  target: null,
  ...rest,
});
// start --access-- tower -- target 0 -- tower -- end, 1 degree each
const ROUTE = [
  waypoint(0, "start"),
  waypoint(1, "pass"),
  waypoint(2, "target", { target: 0 }),
  waypoint(3, "pass"),
  waypoint(4, "end"),
];

test("one degree on the equator is 111.2 km", () => {
  assert.ok(Math.abs(distance_m([0, 0], [1, 0]) - 111_195) < 1);
});

test("places along a route add up to the server's length", () => {
  const profile = profileOf(ROUTE, 400_000);
  assert.deepEqual(profile.places.map(Math.round), [0, 100_000, 200_000, 300_000, 400_000]);
});

test("legs from the start and to the end leave the network", () => {
  const { legs } = profileOf(ROUTE, 400_000);
  assert.deepEqual(
    legs.map((leg) => [Math.round(leg.from), Math.round(leg.to), leg.offNetwork]),
    [
      [0, 100_000, true],
      [100_000, 300_000, false],
      [300_000, 400_000, true],
    ],
  );
});

test("all strips of a list share the scale of the longest route", () => {
  const plan = layOut(profileOf(ROUTE, 400_000), 800_000, 420);
  assert.equal(plan.start, EDGE);
  assert.equal(plan.end, EDGE + 200);
});

test("ticks are at least 3.5 px apart", () => {
  const waypoints = [
    waypoint(0, "start"),
    ...Array.from({ length: 500 }, (_, index) => waypoint((index + 1) / 100, "pass")),
    waypoint(6, "end"),
  ];
  const { ticks } = layOut(profileOf(waypoints, 600_000), 600_000, 400);
  assert.ok(ticks.length > 50 && ticks.length < 120);
  for (let index = 1; index < ticks.length; index += 1) assert.ok(ticks[index] - ticks[index - 1] >= 3.5 - 1e-9);
});

const targetsAt = (longitudes) => [
  waypoint(0, "start"),
  ...longitudes.map((longitude, target) => waypoint(longitude, "target", { target })),
  waypoint(4, "end"),
];
const pillsOf = (longitudes, width_px = 420) =>
  layOut(profileOf(targetsAt(longitudes), 400_000), 400_000, width_px).pills;

function assertApart(pills, width_px) {
  for (let index = 1; index < pills.length; index += 1)
    assert.ok(pills[index].x - pills[index - 1].x >= (pills[index].width + pills[index - 1].width) / 2);
  assert.ok(pills[0].x - pills[0].width / 2 >= 0 && pills.at(-1).x + pills.at(-1).width / 2 <= width_px);
}

test("two targets that would touch are pushed 19 px apart", () => {
  const pills = pillsOf([2, 2.1]);
  assert.deepEqual(
    pills.map(({ label }) => label),
    ["1", "2"],
  );
  assert.ok(Math.abs(pills[1].x - pills[0].x - 19) < 1e-9);
});

test("targets that stand where others are pushed to become one pill", () => {
  const pills = pillsOf([1, 2, 2.01, 2.02, 2.03, 2.04, 3]);
  assert.deepEqual([pills[0].label, pills.at(-1).label], ["1", "7"]);
  assert.deepEqual(
    pills.flatMap(({ targets }) => targets),
    [0, 1, 2, 3, 4, 5, 6],
  );
  for (const pill of pills) assert.ok(Math.abs(pill.x - pill.true_x) <= 14);
  assertApart(pills, 420);
});

test("33 targets in a row stay on the strip", () => {
  for (const width_px of [160, 420, 700]) {
    const pills = pillsOf(
      Array.from({ length: 33 }, (_, index) => 0.5 + index / 20),
      width_px,
    );
    assert.deepEqual([pills[0].first, pills.at(-1).last], [1, 33]);
    assert.ok(pills.some(({ label }) => /^\d+–\d+$/.test(label)));
    assert.ok(pills.every(({ x }) => x >= 10 - 1 && x <= width_px - 10 + 1));
    assertApart(pills, width_px);
  }
});

test("a route too short for its targets has one pill for all of them", () => {
  const [pill, ...rest] = layOut(profileOf(targetsAt([1, 2, 3]), 400), 400_000, 420).pills;
  assert.deepEqual([pill.label, rest.length], ["1–3", 0]);
  assert.ok(pill.x - pill.width / 2 >= 0);
});

test("a distance in the strip is a position on the map", () => {
  const { places } = profileOf(ROUTE, 400_000);
  assert.deepEqual(positionAt(ROUTE, places, 0), [0, 0]);
  assert.ok(Math.abs(positionAt(ROUTE, places, 150_000)[0] - 1.5) < 1e-9);
  assert.deepEqual(positionAt(ROUTE, places, 999_999), [4, 0]);
});

test("the axis has round figures and at most six", () => {
  assert.deepEqual(axisTicks(30_800), [0, 10, 20, 30]);
  assert.deepEqual(axisTicks(900), [0, 0.2, 0.4, 0.6, 0.8]);
  assert.deepEqual(axisTicks(0), [0]);
});
