/** Ages of inspections and their colours. */

import assert from "node:assert/strict";
import { test } from "node:test";
import { partsByMission } from "../../../static/js/assets/inspected_parts.js";
import { AGES, ageOf, mixed, since_s } from "../../../static/js/domain/inspection_age.js";

const DAY_S = 86_400;
const NOW_S = 1_800_000_000;

test("an inspection is of the newest step that it fits into", () => {
  const key = (/** @type {number} */ days) => ageOf(NOW_S - days * DAY_S, NOW_S);
  assert.deepEqual([0, 30, 31, 365, 366, 20_000].map(key), ["month", "month", "year", "year", "older", "older"]);
  assert.equal(ageOf(NOW_S + 60, NOW_S), "month"); // a clock that is ahead
});

test("the map's steps begin where those of the pages do", () => {
  for (const { key, days } of AGES.slice(0, -1)) {
    assert.equal(ageOf(since_s(days, NOW_S), NOW_S), key);
    assert.notEqual(ageOf(since_s(days, NOW_S) - 1, NOW_S), key);
  }
});

test("a colour lies between both", () => {
  assert.equal(mixed(1, "#0b5d66", "#eceae3"), "#0b5d66");
  assert.equal(mixed(0, "#0b5d66", "#eceae3"), "#eceae3");
  assert.equal(mixed(0.5, "#000000", "#ffffff"), "#808080");
});

test("parts beside each other of one mission are one row with the newest time", () => {
  const part = (
    /** @type {number} */ from_m,
    /** @type {string | null} */ id,
    inspected_at = "2026-01-01T00:00:00Z",
  ) => ({
    from_m,
    to_m: from_m + 1000,
    stretch: [],
    inspected_at,
    mission: id ? { id, name: id } : null,
  });
  const parts = [
    part(0, "a"),
    part(1000, "a", "2026-02-01T00:00:00Z"),
    part(2000, "b"),
    part(4000, "b"),
    part(5000, "a"),
  ];
  const rows = partsByMission(parts).map(({ from_m, to_m, mission, inspected_at }) => [
    from_m,
    to_m,
    mission?.id,
    inspected_at?.slice(5, 7),
  ]);
  assert.deepEqual(rows, [
    [0, 2000, "a", "02"],
    [2000, 3000, "b", "01"],
    [4000, 5000, "b", "01"],
    [5000, 6000, "a", "01"],
  ]);
});
