import assert from "node:assert/strict";
import test from "node:test";

import { arrivalsOf, batteryOf, delayText, landing_s, separationOf, visitsOf } from "../../static/js/mission/route_times.js";

const plain = (text) => text.replaceAll("\u00a0", " ");
const heron = {
  uav: "Heron", geometry: {}, departs_s: 0, energy_wh: 50, battery_percent: 32,
  waypoints: [{ kind: "start", target: null }, { kind: "target", target: 1 }, { kind: "target", target: 1 }, { kind: "end", target: null }],
  arrival_s: [0, 100, 160, 300], battery_left_percent: [100, 80, 70, 32],
};
const kite = { ...heron, uav: "Kite", departs_s: 180, arrival_s: [180, 280, 340, 480] };
const apart = { lateral_m: 30, vertical_m: 15, time_s: 60, delays: [0, 180], layers: [0, 15], closest: null, unresolved: [] };

test("a target is reached where its route first comes to it", () => {
  assert.deepEqual([...visitsOf(heron)], [[1, { arrival_s: 100, battery_percent: 80 }]]);
  assert.deepEqual([...arrivalsOf({ targets: [{ key: "a" }, { key: "b" }], result: { departs_at: null, routes: [heron] } })], [["b", "+01:40"]]);
  assert.equal(landing_s(heron), 300);
});

test("a plan from before has no times, and nothing is said of them", () => {
  const old = { uav: "Heron", waypoints: heron.waypoints };
  assert.equal(arrivalsOf({ targets: [{ key: "a" }, { key: "b" }], result: { routes: [old] } }).size, 0);
  assert.equal(arrivalsOf({ targets: [{ key: "a" }, { key: "b" }], result: { routes: [{ ...old, arrival_s: [null, null, null, null] }] } }).size, 0);
  assert.equal(landing_s(old), null);
  assert.equal(batteryOf(old), null);
  assert.equal(separationOf({ routes: [heron, kite] }), null);
});

test("a delay is said, and what is left of a battery", () => {
  assert.equal(delayText(heron), "");
  assert.equal(plain(delayText(kite)), "takes off 3 min later");
  assert.deepEqual(Object.values(batteryOf(heron)).map(plain), ["32 %", "50 Wh"]);
});

test("what keeps UAVs apart is named with the nearest that they come", () => {
  const closest = { metres: 42.1, vertical_m: 15, seconds: 70.2, uavs: ["Heron", "Kite"], position: [0, 0] };
  const { isFault, words } = separationOf({ routes: [heron, kite], separation: { ...apart, closest } });
  assert.equal(isFault, false);
  assert.match(plain(words), /^Kept apart: Kite takes off 3 min later, Kite flies 15 m higher\. Nearest: Heron and Kite, 42 m apart, 15 m .* 70 s/);
  assert.equal(separationOf({ routes: [heron], separation: apart }), null);
});

test("a conflict that nothing solves is a fault", () => {
  const unresolved = [{ code: "hovers_in_the_way", uavs: ["Heron", "Kite"], metres: 4 }];
  const { isFault, words } = separationOf({ routes: [heron, kite], separation: { ...apart, unresolved } });
  assert.equal(isFault, true);
  assert.match(words, /Heron and Kite: one hovers in the way/);
});
