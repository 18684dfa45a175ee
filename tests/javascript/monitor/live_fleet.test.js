/** The live page over all missions: call signs, groups, filter, and where labels and counts stand. */

import assert from "node:assert/strict";
import { test } from "node:test";
import { letterOf, missionNumbers, prefixOf } from "../../../static/js/monitor/call_signs.js";
import { EVERYTHING, grouped } from "../../../static/js/monitor/fleet_groups.js";
import { ALONE, clustersOf, spotsOf } from "../../../static/js/monitor/map/marker_layout.js";
import { windWords } from "../../../static/js/monitor/text/uav_text.js";

const NOW_MS = Date.parse("2026-11-28T10:00:00Z");
const SIZE = { width: 1000, height: 800 };

const mission = (id, name, call_number = 1) => ({ id, name, call_number });
const uav = (id, name, of, place, more = {}) => ({
  id,
  name,
  mission: of,
  place,
  measured: { measured_at: new Date(NOW_MS - 1000).toISOString(), is_in_air: true, ...more },
  link: {},
  estimated: null,
  rhythm: { late_after_s: 5, silent_after_s: 15 },
});

test("two missions on a page have UAVs A each, told apart by the missions' numbers", () => {
  const numbers = missionNumbers(new Map(), [mission("b", "North", 4), mission("a", "South", 2)]);
  assert.equal(letterOf({ mission: "a", place: 0 }, numbers), "2A");
  assert.equal(letterOf({ mission: "b", place: 0 }, numbers), "4A");
  assert.equal(letterOf({ mission: null, place: null }, numbers), "");
});

test("a single mission has its letters alone, as on its own page; so has one of before there were numbers", () => {
  const numbers = missionNumbers(new Map(), [mission("a", "South", 7), mission("b", "North", null)]);
  assert.equal(letterOf({ mission: "a", place: 1 }, numbers), "B");
  assert.equal(prefixOf("a", new Map()), "");
});

test("a mission keeps its number when others end and come", () => {
  const first = missionNumbers(new Map(), [mission("a", "South", 1), mission("b", "North", 2)]);
  const later = missionNumbers(first, [mission("b", "North", 2), mission("c", "East", 3)]);
  assert.deepEqual(
    [...later],
    [
      ["b", 2],
      ["c", 3],
    ],
  );
  assert.equal(missionNumbers(later, [mission("c", "East", 3), mission("b", "North", 2)]), later);
});

const missions = [mission("a", "South belt"), mission("b", "North line")];
const numbers = new Map([
  ["a", 1],
  ["b", 2],
]);
const uavs = [
  uav(1, "Kite", "b", 0),
  uav(2, "Tern", "a", 1),
  uav(3, "Crake", "a", 0, { is_in_air: false }),
  uav(4, "Spare", null, null, { is_in_air: false }),
];
const fleet = { uavs, missions, alerts: [{ uav: 2, level: "warning", closed_at: null }], numbers, now_ms: NOW_MS };
const names = (entries) => entries.map((entry) => entry.name ?? entry.mission?.name ?? "none");

test("UAVs stand under their missions, by place, and those without one at the end", () => {
  assert.deepEqual(names(grouped(fleet, EVERYTHING)), [
    "South belt",
    "Crake",
    "Tern",
    "North line",
    "Kite",
    "none",
    "Spare",
  ]);
  const [head] = grouped(fleet, EVERYTHING);
  assert.deepEqual([head.uavs, head.flying], [2, 1]);
});

for (const [filter, found] of [
  [{ text: "kit", kind: "all" }, ["North line", "Kite"]],
  [{ text: "south", kind: "all" }, ["South belt", "Crake", "Tern"]],
  [{ text: "2a", kind: "all" }, ["North line", "Kite"]],
  [{ text: "", kind: "flying" }, ["South belt", "Tern", "North line", "Kite"]],
  [{ text: "", kind: "alerts" }, ["South belt", "Tern"]],
  [{ text: "", kind: "silent" }, []],
  [{ text: "nothing", kind: "all" }, []],
]) {
  test(`the filter ${filter.kind} "${filter.text}" lists ${found.join(", ") || "none"}`, () => {
    assert.deepEqual(names(grouped(fleet, filter)), found);
  });
}

const mark = (id, x, y, weight = 0) => ({ id, x, y, width: 110, height: 20, weight });

test("three marks on each other are one count; two are not, and one in alarm stands by itself", () => {
  const [near] = clustersOf([mark(1, 100, 100), mark(2, 104, 100), mark(3, 108, 103), mark(4, 500, 500)]);
  assert.deepEqual(near.map(({ id }) => id).sort(), [1, 2, 3]);
  assert.deepEqual(clustersOf([mark(1, 100, 100), mark(2, 104, 100)]), []);
  assert.deepEqual(clustersOf([mark(1, 100, 100), mark(2, 104, 100), mark(3, 108, 103, ALONE)]), []);
});

test("labels of 60 UAVs never cover each other nor a mark", () => {
  let seed = 7;
  const random = () => {
    seed = (seed * 16_807) % 2_147_483_647;
    return seed / 2_147_483_647;
  };
  const marks = Array.from({ length: 60 }, (_, id) => mark(id, 40 + random() * 920, 40 + random() * 720));
  const { spots } = spotsOf(marks, [], SIZE, new Map());
  const boxes = marks.flatMap(({ id, x, y, width, height }) => {
    const spot = spots.get(id);
    return spot
      ? [{ id, left: x + spot.left, top: y + spot.top, right: x + spot.left + width, bottom: y + spot.top + height }]
      : [];
  });
  assert.ok(boxes.length >= 40, `${boxes.length} of 60 have room`);
  const cover = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
  for (const [index, box] of boxes.entries()) for (const other of boxes.slice(index + 1)) assert.ok(!cover(box, other));
  for (const box of boxes)
    for (const { x, y } of marks) assert.ok(!cover(box, { left: x - 13, top: y - 13, right: x + 13, bottom: y + 13 }));
});

test("a label that has no room beside its mark is farther off with a leader line", () => {
  const { spots } = spotsOf(
    [mark(1, 500, 400), mark(2, 530, 400), mark(3, 470, 400), mark(4, 500, 372), mark(5, 500, 428)],
    [],
    SIZE,
    new Map(),
  );
  assert.equal(spots.size, 5);
  assert.ok([...spots.values()].some(({ leader }) => leader !== null));
});

test("wind is told with who reports it and how old it is", () => {
  const measured = {
    measured_at: "2026-11-28T09:59:59Z",
    measured_at_of: { wind: "2026-11-28T09:59:56Z" },
    wind_speed_mps: 5,
    wind_from_deg: 240,
  };
  const words = (kind) => windWords({ measured, link: { kind } }, NOW_MS).replaceAll("\u00a0", " ");
  assert.equal(words("mavlink"), "Wind 5 m/s from 240°, reported by its autopilot 4.0 s ago");
  assert.match(words("http"), /companion computer/);
  assert.equal(windWords({ measured: { ...measured, wind_speed_mps: null }, link: {} }, NOW_MS), "");
});
