import assert from "node:assert/strict";
import test from "node:test";

import { axisTicks, distance_m, layOut, positionAt, profileOf } from "../../static/js/mission/span_strip.js";

const EDGE = 10;
const waypoint = (longitude, kind, rest = {}) => ({ position: [longitude, 0], kind, asset: kind === "start" || kind === "end" ? null : 1, target: null, ...rest });
// start --access-- tower -- target 0 -- tower -- end, 1 degree each
const ROUTE = [waypoint(0, "start"), waypoint(1, "pass"), waypoint(2, "target", { target: 0 }), waypoint(3, "pass"), waypoint(4, "end")];

test("one degree on the equator is 111.2 km", () => {
  assert.ok(Math.abs(distance_m([0, 0], [1, 0]) - 111_195) < 1);
});

test("places along a route add up to the server's length", () => {
  const profile = profileOf(ROUTE, 400_000);
  assert.deepEqual(profile.places.map(Math.round), [0, 100_000, 200_000, 300_000, 400_000]);
});

test("legs from the start and to the end leave the network", () => {
  const { legs } = profileOf(ROUTE, 400_000);
  assert.deepEqual(legs.map((leg) => [Math.round(leg.from), Math.round(leg.to), leg.offNetwork]), [[0, 100_000, true], [100_000, 300_000, false], [300_000, 400_000, true]]);
});

test("all strips of a list share the scale of the longest route", () => {
  const plan = layOut(profileOf(ROUTE, 400_000), 800_000, 420);
  assert.equal(plan.start, EDGE);
  assert.equal(plan.end, EDGE + 200);
});

test("ticks are at least 3.5 px apart", () => {
  const waypoints = [waypoint(0, "start"), ...Array.from({ length: 500 }, (_, index) => waypoint((index + 1) / 100, "pass")), waypoint(6, "end")];
  const { ticks } = layOut(profileOf(waypoints, 600_000), 600_000, 400);
  assert.ok(ticks.length > 50 && ticks.length < 120);
  for (let index = 1; index < ticks.length; index += 1) assert.ok(ticks[index] - ticks[index - 1] >= 3.5 - 1e-9);
});

test("targets that would touch are pushed 19 px apart and stay inside", () => {
  const crowd = [waypoint(0, "start"), ...[3.96, 3.97, 3.98].map((longitude, target) => waypoint(longitude, "target", { target })), waypoint(4, "end")];
  const { targets } = layOut(profileOf(crowd, 400_000), 400_000, 300);
  assert.deepEqual(targets.map(({ target }) => target), [0, 1, 2]);
  assert.ok(targets[1].x - targets[0].x >= 19 && targets[2].x - targets[1].x >= 19);
  assert.ok(targets[2].x <= 290);
});

test("more targets than fit side by side are drawn at their true places", () => {
  const many = [waypoint(0, "start"), ...Array.from({ length: 60 }, (_, target) => waypoint(1 + target / 100, "target", { target })), waypoint(4, "end")];
  const plan = layOut(profileOf(many, 400_000), 400_000, 420);
  assert.equal(plan.isCrowded, true);
  assert.ok(Math.abs(plan.targets[0].x - 110) < 0.5 && plan.targets[59].x < 170);
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
