import assert from "node:assert/strict";
import { test } from "node:test";
import { partsOf } from "../../../static/js/mission/panels/why/route.js";
import { fullUavs, reasonWords } from "../../../static/js/mission/panels/why/target.js";
import {
  counterpart,
  endsBetween,
  isSamePlan,
  moreOrLess,
  movesBetween,
  profileOfSummary,
  summaryOfPlan,
} from "../../../static/js/mission/plan/compare.js";
import { withResult } from "../../../static/js/mission/plan/plan_results.js";
import {
  bandOf,
  flightOf,
  groundOf,
  heightAt,
  readingAt,
  spanOf,
  thinned,
} from "../../../static/js/mission/strips/profile.js";
import { scaleOf } from "../../../static/js/mission/strips/span_strip.js";
import { canFly, choicesOf, isAskedFor, standingUavs } from "../../../static/js/mission/uavs/fleet.js";
import { lengthText } from "../../../static/js/units.js";

const at = (lon, more = {}) => ({
  position: [lon, 40],
  kind: "way",
  asset: 1,
  target: null,
  altitude_agl_m: 60,
  altitude_amsl_m: 260,
  altitude_relative_m: 60,
  ...more,
});
const route = {
  uav: "Heron",
  name: "Heron",
  uav_id: 1,
  length_m: 3000,
  duration_s: 300,
  waypoints: [
    at(10, { kind: "start", asset: null }),
    at(10.01),
    at(10.02, { kind: "target", target: 0, altitude_amsl_m: 280 }),
    at(10.03, { kind: "end", asset: null }),
  ],
};
const targets = [
  { key: "7", asset: 7, position: null, stretch: null, label: "Tower 7" },
  { key: "8", asset: 8, position: null, stretch: null, label: "Tower 8" },
];

test("the profile and the strips have one axis, there and back", () => {
  const { x, distanceAt } = scaleOf(3000, 420);
  assert.equal(x(0), 10);
  assert.equal(x(3000), 410);
  assert.ok(Math.abs(distanceAt(x(1234)) - 1234) < 1e-9);
});

test("the server's profile is stretched to the route's own length", () => {
  const ground = groundOf(
    {
      length_m: 1500,
      distance_m: [0, 750, 1500],
      ground_amsl_m: [200, null, 210],
      zones: [{ name: "Airport", from_m: 300, to_m: 600 }],
    },
    3000,
  );
  assert.deepEqual(
    ground.samples.map(({ at_m }) => at_m),
    [0, 1500, 3000],
  );
  assert.deepEqual([ground.zones[0].from_m, ground.zones[0].to_m], [600, 1200]);
});

test("a reading says sea level and ground, and keeps quiet about ground that nobody knows", () => {
  const flight = flightOf(route, {
    samples: [
      { at_m: 0, ground_m: 200 },
      { at_m: 1000, ground_m: 220 },
      { at_m: 2000, ground_m: null },
      { at_m: 3000, ground_m: 200 },
    ],
    zones: [],
  });
  assert.equal(flight.isFlat, false);
  assert.deepEqual(
    flight.tasks.map(({ target, height_m }) => [target, Math.round(height_m)]),
    [[0, 280]],
  );
  const known = readingAt(flight, 500);
  assert.equal(known.ground_m, 210);
  assert.equal(known.above_m, known.height_m - 210);
  assert.equal(readingAt(flight, 1500).above_m, null);
});

test("without terrain the ground is flat and heights count from take-off", () => {
  const flat = flightOf(
    { ...route, waypoints: route.waypoints.map((waypoint) => ({ ...waypoint, altitude_amsl_m: null })) },
    null,
  );
  assert.equal(flat.isFlat, true);
  assert.equal(readingAt(flat, 1500).above_m, 60);
  assert.deepEqual(
    flat.under.map(({ ground_m }) => ground_m),
    [0, 0],
  );
});

test("a zone's band stands on the ground, and what is not stated goes to the edge", () => {
  const flight = flightOf(route, {
    samples: [
      { at_m: 0, ground_m: 200 },
      { at_m: 3000, ground_m: 200 },
    ],
    zones: [],
  });
  const span = spanOf(flight);
  const zone = {
    from_m: 100,
    to_m: 200,
    lower_limit: { value_m: 10, reference: "AGL" },
    upper_limit: { value_m: 250, reference: "AMSL" },
  };
  assert.deepEqual(bandOf(zone, flight, span), { from: 210, to: 250 });
  assert.deepEqual(bandOf({ from_m: 100, to_m: 200, lower_limit: null, upper_limit: null }, flight, span), {
    from: 200,
    to: span.high,
  });
});

test("a height between two points is on the line between them", () => {
  const points = [
    { at_m: 0, v: 10 },
    { at_m: 100, v: 20 },
  ];
  assert.deepEqual(
    [-5, 0, 25, 100, 400].map((place) => heightAt(points, place, "v")),
    [10, 10, 12.5, 20, 20],
  );
});

test("a route of very many waypoints is thinned with both ends kept", () => {
  const many = Array.from({ length: 5001 }, (_, index) => [index, 0]);
  const few = thinned(many, 1900);
  assert.ok(few.length <= 1900);
  assert.deepEqual([few[0], few.at(-1)], [many[0], many.at(-1)]);
  assert.equal(thinned(many.slice(0, 10), 1900).length, 10);
});

const planOf = (...routes) => ({
  targets,
  result: { objective: "total", return_to_start: true, total_length_m: 3000, unassigned: [], routes },
});
const other = { ...route, uav: "Kite", uav_id: 2 };
const idle = { uav: "Kite", uav_id: 2, length_m: 0, duration_s: 0, waypoints: [] };

test("planning the same again is no other plan", () => {
  assert.ok(isSamePlan(summaryOfPlan(planOf(route, idle)), summaryOfPlan(planOf({ ...route }, idle))));
  assert.ok(!isSamePlan(summaryOfPlan(planOf(route, idle)), summaryOfPlan(planOf({ ...route, length_m: 4000 }, idle))));
});

test("another start and another end of a flight are told, though it is as long", () => {
  const [before, after] = [
    { ...route, end_action: "hover", base: null },
    { ...route, end_action: "base", base: "Depot", waypoints: [at(10.001), ...route.waypoints.slice(1)] },
  ].map((one) => summaryOfPlan(planOf(one)).routes[0]);
  const { moved_m, from, to } = endsBetween(before, after);
  assert.deepEqual([Math.round(moved_m), from.end_action, to], [85, "hover", { end_action: "base", base: "Depot" }]);
  assert.deepEqual(endsBetween(before, { ...before, stops: [] }), { moved_m: 0, from: null, to: null });
  assert.deepEqual(endsBetween({ ...before, start: undefined, end_action: undefined }, after), {
    moved_m: 0,
    from: null,
    to: null,
  });
  assert.ok(!isSamePlan({ routes: [before] }, { routes: [{ ...before, end_action: "land" }] }));
});

test("a plan in short ends when the last UAV ends, its later take-off counted", () => {
  const late = { ...route, uav: "Kite", departs_s: 120 };
  assert.equal(summaryOfPlan(planOf(route, late)).duration_s, route.duration_s + 120);
});

test("a target that changes hands is named with both UAVs, and one that came or went as well", () => {
  const before = summaryOfPlan(planOf(route, idle));
  const now = summaryOfPlan(planOf({ ...idle, uav: "Heron", uav_id: 1 }, other));
  const [move, ...more] = movesBetween(before, now);
  assert.deepEqual([move.label, move.from.uav, move.to.uav, more.length], ["Tower 7", "Heron", "Kite", 0]);
  const nobody = summaryOfPlan({ ...planOf(idle), result: { ...planOf(idle).result, unassigned: [{ target: 0 }] } });
  assert.deepEqual(
    movesBetween(before, nobody).map(({ from, to }) => [from.uav, to]),
    [["Heron", null]],
  );
  const empty = summaryOfPlan(planOf(idle));
  assert.deepEqual(
    movesBetween(empty, before).map(({ from, to }) => [from, to.uav]),
    [[undefined, "Heron"]],
  );
  assert.equal(counterpart(now.routes[1], before).uav, "Kite");
});

test("a plan in short draws a strip: stops, and what is off the network", () => {
  const profile = profileOfSummary({
    length_m: 3000,
    stops: [{ ...targets[0], at_m: 2000 }],
    off_network: [
      [0, 500],
      [2500, 3000],
    ],
  });
  assert.deepEqual(profile.legs, [
    { from: 0, to: 500, offNetwork: true },
    { from: 500, to: 2500, offNetwork: false },
    { from: 2500, to: 3000, offNetwork: true },
  ]);
  assert.deepEqual(profile.targets, [{ target: "7", at: 2000 }]);
});

test("a difference has a sign, and none below what can be told apart", () => {
  assert.equal(moreOrLess(1200, 50, lengthText), "+1.2\u00a0km");
  assert.equal(moreOrLess(-1200, 50, lengthText), "−1.2\u00a0km");
  assert.equal(moreOrLess(20, 50, lengthText), "=");
});

test("only so many plans are kept, and the newest of one question", () => {
  let figures = {};
  for (let number = 0; number < 40; number += 1) figures = withResult(figures, `basis ${number}`, { number });
  assert.equal(Object.keys(figures).length, 16);
  assert.equal(withResult(figures, "basis 39", { number: "again" })["basis 39"].number, "again");
  assert.equal(Object.keys(withResult(figures, "basis 39", {})).length, 16);
  assert.deepEqual(Object.keys(withResult(figures, "basis 40", { ground_revision: 8 })), ["basis 40"]); // a zone has come in
});

const uav = (id, more) => ({
  id,
  name: `UAV ${id}`,
  base_name: "West yard",
  type_name: "Quad",
  sensors: ["RGB"],
  state: "active",
  battery_percent: 90,
  position: [0, 0],
  ...more,
});

test("a fleet is narrowed by base, sensor and type", () => {
  const fleet = [uav(1), uav(2, { base_name: "East yard", sensors: ["RGB", "LiDAR"] }), uav(3, { type_name: "Wing" })];
  assert.deepEqual(choicesOf(fleet), {
    base: ["East yard", "West yard"],
    sensor: ["LiDAR", "RGB"],
    type: ["Quad", "Wing"],
  });
  const found = (asked) => fleet.filter((one) => isAskedFor(one, asked)).map(({ id }) => id);
  assert.deepEqual(found({}), [1, 2, 3]);
  assert.deepEqual(found({ sensor: "LiDAR" }), [2]);
  assert.deepEqual(found({ base: "West yard", type: "Wing" }), [3]);
});

test("who is in maintenance cannot be chosen, and who left the fleet is said to be gone", () => {
  assert.deepEqual([uav(1), uav(2, { state: "maintenance" }), uav(3, { state: "retired" })].map(canFly), [
    true,
    false,
    false,
  ]);
  const chosen = standingUavs({
    selection: {
      uavs: [
        { id: 9, name: "Old", position: [0, 0] },
        { ...uav(1), battery_percent: 12 },
      ],
    },
    fleet: [uav(1)],
  });
  assert.deepEqual(
    chosen.map(({ isGone, battery_percent }) => [isGone, battery_percent]),
    [
      [true, undefined],
      [false, 90],
    ],
  );
});

test("the parts of a route are those that can be seen, and a zone has its name", () => {
  const explanation = {
    straight_m: 20_000,
    on_lines_m: 5,
    round_zones_m: 1300,
    zones: [{ name: "Alum Creek reserve" }],
  };
  assert.deepEqual(
    partsOf(explanation).map(({ name, words }) => [name, words]),
    [
      ["straight", "Straight from target to target"],
      ["zones", "Round Alum Creek reserve"],
    ],
  );
  assert.equal(partsOf({ ...explanation, round_zones_m: null }).length, 1);
});

test("a UAV that has as many targets as it may is named where it could fly to one more", () => {
  const uavs = ["Alpha", "Bravo", "Charlie"].map((name, number) => ({
    name,
    is_in_mission: true,
    is_enough: number < 2,
    most_targets: number ? null : 1,
  }));
  const explanation = { reason: "not_with_the_others", zones: [], stretches: [], uavs };
  const plan = {
    result: {
      routes: [
        { uav: "Alpha", targets: [4, 4] },
        { uav: "Bravo", targets: [1] },
        { uav: "Charlie", targets: [] },
      ],
    },
  };
  const full = fullUavs(explanation, plan);
  assert.deepEqual(
    full.map(({ name }) => name),
    ["Alpha"],
  );
  assert.equal(
    reasonWords(explanation, full),
    "Alpha could fly there, but has as many targets as it may have. No other UAV has the range left after its other targets.",
  );
  const alone = { ...explanation, uavs: [uavs[0], uavs[2]] };
  assert.equal(
    reasonWords(alone, fullUavs(alone, plan)),
    "Alpha could fly there, but has as many targets as it may have.",
  );
  assert.match(reasonWords(explanation, []), /none has range or battery left/);
});

test("each reason is said with its figures", () => {
  const explanation = {
    zones: [{ name: "Airport" }],
    stretches: [],
    access_limit_m: 10_000,
    network_m: 32_000,
    height_m: 110,
    needed_height_m: 125,
    height_limit_m: 120,
  };
  assert.equal(reasonWords({ ...explanation, reason: "inside_zone" }), "It stands inside Airport.");
  assert.match(
    reasonWords({ ...explanation, reason: "too_far_from_network" }),
    /32\.0\u00a0km away; up to 10\.0\u00a0km/,
  );
  assert.match(
    reasonWords({ ...explanation, reason: "above_height_limit" }),
    /110\u00a0m high.*125\u00a0m; the limit is 120\u00a0m/,
  );
});
