/** What zones beside a route are to it, at its times and heights. */

import assert from "node:assert/strict";
import { test } from "node:test";

import { marginWords, passedZones, zoneLegend, zoneWords } from "../../../static/js/mission/options/zones_passed.js";

const at = (altitude_agl_m) => ({
  position: [10, 50],
  altitude_agl_m,
  altitude_amsl_m: 300 + altitude_agl_m,
  task: null,
});
const route = { waypoints: [at(60), at(60), at(60), at(90)], arrival_s: [0, 100, 200, 300] };
const places = [0, 1000, 2000, 3000];
const departs_at = "2026-11-21T10:00:00Z";
const margins = { time_s: 300, height_m: 10, terrain_m: 10 };
const zone = (rest) => ({
  name: "Airport",
  from_m: 1100,
  to_m: 1900,
  is_crossed: true,
  lower_limit: null,
  upper_limit: null,
  schedule: null,
  ...rest,
});
const hours = (from, to) => [
  { startDateTime: `2026-11-21T${from}:00Z`, endDateTime: `2026-11-21T${to}:00Z`, schedule: [] },
];
const kind = (rest, when = departs_at) =>
  passedZones({ zones: [zone(rest)], zone_margins: margins }, route, places, when)[0].kind;

test("a zone that is crossed is in the way, one beside the route is passed by", () => {
  assert.equal(kind({}), "met");
  assert.equal(kind({ is_crossed: false }), "near");
});

test("a zone sleeps only where it is not in force within the margin of the time at which it is passed", () => {
  assert.equal(kind({ schedule: hours("12:00", "15:00") }), "asleep");
  assert.equal(kind({ schedule: hours("10:08", "15:00") }), "met"); // passed until 10:03:20, and 5 min more
  assert.equal(kind({ schedule: hours("10:09", "15:00") }), "asleep");
  assert.equal(kind({ schedule: hours("08:00", "09:57") }), "met"); // passed from 10:01:40 on
  assert.equal(kind({ schedule: hours("12:00", "15:00") }, null), "met"); // at any time
  assert.equal(kind({ schedule: "unreadable" }), "met");
});

test("a zone lies at another height only if it is clear of the flight by the margins", () => {
  const limit = (value_m, reference = "AGL") => ({ value_m, reference });
  assert.equal(kind({ lower_limit: limit(81) }), "apart");
  assert.equal(kind({ lower_limit: limit(80) }), "met");
  assert.equal(kind({ lower_limit: limit(381, "AMSL") }), "apart");
  assert.equal(kind({ upper_limit: limit(39) }), "apart");
  assert.equal(kind({ upper_limit: limit(40) }), "met");
  assert.equal(kind({ lower_limit: limit(81), to_m: 2500 }), "met"); // climbing to 90 m
  assert.equal(kind({ lower_limit: limit(500, "STD") }), "met"); // cannot be compared
});

test("each kind is said in words, and the margins are", () => {
  assert.equal(zoneWords({ name: "Airport", kind: "asleep" }), "Airport, not in force then");
  assert.deepEqual(
    zoneLegend([zone({ kind: "near" }), zone({ kind: "met" })]).map((one) => one.kind),
    ["met", "near"],
  );
  assert.equal(
    marginWords(margins),
    "Zones count 5\u00a0min before and after their times and 10\u00a0m below and above their limits.",
  );
});
