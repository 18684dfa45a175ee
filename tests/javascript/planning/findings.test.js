/** What a rehearsal found: conditions by UAVs, failures first, each with one fix. */

import assert from "node:assert/strict";
import { test } from "node:test";
import { conditionsByUav, failuresFirst, fixOf } from "../../../static/js/mission/rehearsal/findings.js";

const plain = (text) => text.replaceAll("\u00a0", " ");
const layer = (speed_mps) => ({ altitude_agl_m: 10, speed_mps, from_deg: 270 });
const air = (code, speed_mps, more = {}) => ({
  code,
  wind: speed_mps ? [layer(speed_mps)] : [],
  temperature_c: 15,
  gusts_mps: 0,
  battery_percent: 100,
  ...more,
});
const target = (level) => ({ level });
const route = (uav, level, targets, left_percent) => ({
  uav,
  level,
  targets: targets.map(target),
  energy: [{ left_percent }],
  reserve_percent: 20,
  planned_wh: 80,
});
const finding = (level, code, more = {}) => ({
  level,
  code,
  uav: 0,
  target: null,
  waypoint: null,
  short_percent: null,
  ...more,
});
const strong = {
  sequence: 1,
  words: "Strong wind",
  conditions: air("strong-wind", 12, { gusts_mps: 2 }),
  level: "fail",
  assessment: {
    routes: [route(0, "fail", ["pass", "fail", "pass"], 7.2), route(1, "pass", ["pass"], 41)],
    findings: [
      finding("warnings", "late"),
      finding("fail", "not-flown-to"),
      finding("fail", "reserve", { short_percent: 12.8 }),
    ],
  },
};
const calm = { sequence: 0, words: "Calm", conditions: air("calm", 0), level: "", assessment: null };
const uavs = [
  { uav: 0, name: "Heron" },
  { uav: 1, name: "Kite" },
];

test("the table has a row for each of the conditions and a cell for each UAV", () => {
  const { columns, rows } = conditionsByUav({ runs: [calm, strong], uavs });
  assert.deepEqual(
    columns.map(({ letter, name }) => [letter, name]),
    [
      ["A", "Heron"],
      ["B", "Kite"],
    ],
  );
  assert.deepEqual(rows[0].cells, [null, null]);
  assert.deepEqual(rows[1].cells, [
    { level: "fail", passed: 2, all: 3 },
    { level: "pass", passed: 1, all: 1 },
  ]);
  assert.deepEqual([rows[0].lowest_percent, rows[1].lowest_percent], [null, 7.2]);
  assert.equal(plain(rows[1].air), "12 m/s, gusts 2 m/s");
});

test("failures come first, their cause before what was not flown to", () => {
  assert.deepEqual(
    failuresFirst(strong).map(({ code }) => code),
    ["reserve", "not-flown-to", "late"],
  );
});

test("a battery that is too low is planned again with that much more in reserve", () => {
  const fix = fixOf(strong.assessment.findings[2], strong, null);
  assert.deepEqual([fix.code, fix.uav, fix.percent, plain(fix.words)], ["reserve", 0, 33, "Keep 33 % in reserve"]);
  assert.equal(fixOf(finding("fail", "reserve", { short_percent: 75 }), strong, null), null);
  const uncounted = {
    ...strong,
    assessment: { ...strong.assessment, routes: [{ ...strong.assessment.routes[0], planned_wh: null }] },
  };
  assert.equal(fixOf(strong.assessment.findings[2], uncounted, null), null);
});

test("what stronger wind than planned brings about is planned again for that wind, else by hand", () => {
  const late = fixOf(finding("warnings", "late"), strong, null);
  assert.deepEqual([late.code, plain(late.words)], ["conditions", "Plan again for 12 m/s"]);
  assert.deepEqual(late.conditions, { wind: [layer(12)], temperature_c: 15 });
  assert.equal(fixOf(finding("warnings", "late"), strong, air("", 12)), null);
  assert.equal(fixOf(finding("warnings", "zone-near"), strong, air("", 12)).code, "by_hand");
});
