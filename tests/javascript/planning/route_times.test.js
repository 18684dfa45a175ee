import assert from "node:assert/strict";
import test from "node:test";
import {
  arrivalsOf,
  batteryOf,
  delayText,
  landing_s,
  separationOf,
  staysOf,
  staysText,
  visitsOf,
} from "../../../static/js/mission/plan/route_times.js";
import { flightOf, readingAt } from "../../../static/js/mission/strips/profile.js";

const plain = (text) => text.replaceAll("\u00a0", " ");
const heron = {
  uav: "Heron",
  geometry: {},
  departs_s: 0,
  duration_s: 324,
  energy_wh: 50,
  battery_percent: 32,
  waypoints: [
    { kind: "start", target: null },
    { kind: "target", target: 1 },
    { kind: "target", target: 1 },
    { kind: "end", target: null },
  ],
  arrival_s: [0, 100, 160, 300],
  battery_left_percent: [100, 80, 70, 32],
};
const kite = { ...heron, uav: "Kite", departs_s: 180, arrival_s: [180, 280, 340, 480] };
const apart = {
  lateral_m: 30,
  vertical_m: 15,
  time_s: 60,
  delays: [0, 180],
  layers: [0, 15],
  closest: null,
  unresolved: [],
};

test("a target is reached where its route first comes to it", () => {
  assert.deepEqual([...visitsOf(heron)], [[1, { arrival_s: 100, battery_percent: 80 }]]);
  assert.deepEqual(
    [...arrivalsOf({ targets: [{ key: "a" }, { key: "b" }], result: { departs_at: null, routes: [heron] } })],
    [["b", "+01:40"]],
  );
  assert.equal(landing_s(heron), 324);
});

test("a plan from before has no times, and nothing is said of them", () => {
  const old = { uav: "Heron", waypoints: heron.waypoints };
  assert.equal(arrivalsOf({ targets: [{ key: "a" }, { key: "b" }], result: { routes: [old] } }).size, 0);
  assert.equal(
    arrivalsOf({
      targets: [{ key: "a" }, { key: "b" }],
      result: { routes: [{ ...old, arrival_s: [null, null, null, null] }] },
    }).size,
    0,
  );
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
  assert.match(
    plain(words),
    /^Separation: Kite starts 3 min later and flies 15 m higher\. Closest pair: Heron and Kite, 42 m horizontally, 15 m .* 70 s/,
  );
  assert.equal(separationOf({ routes: [heron], separation: apart }), null);
});

test("a conflict that nothing solves is a fault", () => {
  const unresolved = [{ code: "hovers_in_the_way", uavs: ["Heron", "Kite"], metres: 4 }];
  const { isFault, words } = separationOf({ routes: [heron, kite], separation: { ...apart, unresolved } });
  assert.equal(isFault, true);
  assert.match(words, /Heron and Kite: one hovers in the way/);
});

test("a flight of another mission without known times is named alone", () => {
  const unresolved = [{ code: "times_not_known", uavs: ["Tern"], missions: ["m"] }];
  const { isFault, words } = separationOf({ routes: [heron, kite], separation: { ...apart, unresolved } });
  assert.equal(isFault, true);
  assert.equal(words, "Tern of another mission: its flight times are not known, it may come near.");
});

const at = (lon, kind, more = {}) => ({
  position: [lon, 40],
  kind,
  target: null,
  asset: 1,
  altitude_agl_m: 60,
  altitude_amsl_m: 260,
  altitude_relative_m: 60,
  ...more,
});
const twice = {
  uav: "Tern",
  geometry: {},
  length_m: 4000,
  waypoints: [
    at(10, "start"),
    at(10.01, "pass"),
    at(10.02, "base", { task: { kind: "hold", hold_s: 600 } }),
    at(10.03, "pass"),
    at(10.04, "end"),
  ],
  arrival_s: [0, 100, 500, 1200, 1300],
  battery_left_percent: [100, 50, 60, 70, 40],
  charging: [{ waypoint: 1, charging_s: 280, charged_wh: 20, stopped_s: 300 }],
};

test("stops at a base and on a tower are told in the order in which they come", () => {
  assert.deepEqual(
    staysOf(twice).map(({ index, kind, stay_s }) => [index, kind, stay_s]),
    [
      [1, "charging", 300],
      [2, "base", 600],
    ],
  );
  assert.equal(staysText(twice), "in 2 flights, charges 1 time");
  assert.equal(staysText(heron), "");
});

test("a battery is fuller after charging and full after a base, and time has gone by", () => {
  const flight = flightOf(twice, null, 100);
  const [charged, full] = [readingAt(flight, 1000.001), readingAt(flight, 2000.001)];
  assert.deepEqual([Math.round(charged.battery_percent), Math.round(charged.arrival_s)], [70, 400]); // 50 % and 20 of 100 Wh
  assert.deepEqual([Math.round(full.battery_percent), Math.round(full.arrival_s)], [100, 1100]);
  assert.deepEqual(
    flight.waits.map(({ kind, at_m }) => [kind, Math.round(at_m)]),
    [
      ["charging", 1000],
      ["base", 2000],
    ],
  );
});

test("UAVs that pass long after each other are apart by minutes", () => {
  const closest = { metres: 42.1, vertical_m: null, seconds: 190, uavs: ["Heron", "Kite"], position: [0, 0] };
  const { words } = separationOf({ routes: [heron, kite], separation: { ...apart, closest } });
  assert.match(plain(words), /42 m horizontally, 3 min apart\./);
});
