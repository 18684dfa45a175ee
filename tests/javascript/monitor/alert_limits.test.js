import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";

import { boundsIn, GROUPS, statedLines, wrongWayRound } from "../../../static/js/alert_limits/words.js";

const USUAL = {
  link_late_s: 5,
  link_lost_s: 20,
  off_route_m: 25,
  off_route_critical_m: 100,
  height_off_m: 12,
  height_off_critical_m: 30,
};

test("every limit that the server knows has a field, and none besides", () => {
  const source = readFileSync(new URL("../../../telemetry/alerting/limits.py", import.meta.url), "utf8");
  const known = [...source.matchAll(/^ {4}(\w+): float = _limit\(/gm)].map(([, name]) => name);
  assert.deepEqual(GROUPS.flatMap(({ limits }) => limits.map(({ name }) => name)).sort(), known.sort());
});

test("a limit that is to be above another is looked at with what is usual where nothing is stated", () => {
  assert.deepEqual(wrongWayRound({}, USUAL), []);
  assert.deepEqual(wrongWayRound({ link_late_s: 30 }, USUAL), [["link_lost_s", "link_late_s"]]);
  assert.deepEqual(wrongWayRound({ link_late_s: 30, link_lost_s: 60, off_route_critical_m: 20 }, USUAL), [
    ["off_route_critical_m", "off_route_m"],
  ]);
});

test("bounds in another unit are rounded inwards", () => {
  assert.deepEqual(boundsIn([5, 5000], 1), { min: 5, max: 5000 });
  assert.deepEqual(boundsIn([5, 5000], 0.3048), { min: 16.5, max: 16404.1 });
});

test("what is stated is said with its unit", () => {
  assert.deepEqual(statedLines({ link_late_s: 60, most_hdop: 3 }), [
    ["Link: Late after", "60\u00a0s"],
    ["Position and progress: HDOP, at most", "3"],
  ]);
});
