import assert from "node:assert/strict";
import { test } from "node:test";
import { isSmallChange } from "../../../static/js/mission/actions/replanning.js";
import { differenceWords } from "../../../static/js/mission/compare.js";
import { EMPTY, targetOf } from "../../../static/js/mission/selection.js";

const tower = (id) => targetOf({ id, kind: "tower", properties: { label: `T${id}` }, centre: [9, 50] });
const uav = (id, name) => ({
  id,
  name,
  position: [9, 50],
  max_range_m: 9000,
  cruise_speed_mps: 12,
  end_action: "hover",
});
const before = { ...EMPTY, targets: [tower(1), tower(2), tower(3)], uavs: [uav(1, "Heron"), uav(2, "Kite")] };
const { targets, uavs } = before;

test("another UAV, a removed target and another order are small changes", () => {
  assert.ok(isSmallChange(before, { ...before, uavs: [...uavs, uav(3, "Tern")] }));
  assert.ok(isSmallChange(before, { ...before, uavs: [uavs[1]] }));
  assert.ok(isSmallChange(before, { ...before, targets: targets.slice(1) }));
  const lock = { uav: "Heron", targets: [targets[0].key], at_start: true, at_end: false };
  assert.ok(isSmallChange(before, { ...before, locks: [lock] }));
});

test("other changes are planned on request", () => {
  assert.ok(!isSmallChange(before, { ...before, targets: [...targets, tower(4)] }));
  assert.ok(!isSmallChange(before, { ...before, objective: "total" }));
  assert.ok(!isSmallChange(before, { ...before, return_to_start: false }));
  assert.ok(!isSmallChange(before, { ...before, uavs: [{ ...uavs[0], position: [9, 51] }, uavs[1]] }));
  assert.ok(!isSmallChange(before, { ...before, targets: [] }));
  assert.ok(!isSmallChange(before, { ...before, uavs: [] }));
});

test("the difference is told in time, distance and what is not reached any more", () => {
  const plan = (duration_s, total_length_m, missed = 0) => ({
    routes: [{ duration_s, departs_s: 0 }],
    total_length_m,
    unassigned: Array.from({ length: missed }, () => ({})),
  });
  assert.equal(differenceWords(plan(600, 9_000), plan(780, 7_900)), "+3\u00a0min, −1.1\u00a0km");
  assert.equal(differenceWords(plan(600, 9_000), plan(600, 9_010)), "as long and as far as before");
  assert.equal(differenceWords(plan(600, 9_000), plan(600, 9_000, 1)), "1 more target is not reached");
});
