import assert from "node:assert/strict";
import test from "node:test";
import {
  basisOf,
  detailOf,
  EMPTY,
  keyOf,
  nameOf,
  requestOf,
  selectionOf,
  targetOf,
  withoutTargets,
  withTargets,
} from "../../../static/js/mission/selection.js";
import { withUav, withUavAt } from "../../../static/js/mission/uavs/mission_uavs.js";

const tower = targetOf({
  id: 7,
  kind: "tower",
  properties: { label: "Tower 18 of 41", detail: "138 kV AEP" },
  centre: [10, 50],
});
const wholeLine = targetOf({
  id: 9,
  kind: "line",
  properties: { label: "North", detail: "voltage not stated" },
  centre: [10, 50],
});
const pointOnLine = targetOf({
  id: 9,
  kind: "line",
  properties: { label: "North", detail: "voltage not stated" },
  position: [10.5, 50.5],
});
const heron = {
  id: 3,
  name: "Heron",
  base_name: "West",
  position: [9, 49],
  max_range_m: null,
  cruise_speed_mps: 12,
  end_action: "hover",
};

test("the same thing is picked once, a line and a point on it are two", () => {
  const selection = withTargets(EMPTY, [tower, wholeLine, tower, pointOnLine]);
  assert.equal(selection.targets.length, 3);
  assert.equal(withTargets(selection, [tower]), selection);
});

test("removing leaves the order of the rest", () => {
  const selection = withTargets(EMPTY, [tower, wholeLine, pointOnLine]);
  assert.deepEqual(
    withoutTargets(selection, [wholeLine.key]).targets.map(({ key }) => key),
    [tower.key, pointOnLine.key],
  );
});

test("the request has positions only where a point was picked", () => {
  const request = requestOf(withUav(withTargets(EMPTY, [tower, wholeLine, pointOnLine]), heron));
  assert.deepEqual(request.targets, [{ asset: 7 }, { asset: 9 }, { asset: 9, position: [10.5, 50.5] }]);
  assert.deepEqual(request.uavs, [
    {
      name: "Heron",
      position: [9, 49],
      id: 3,
      max_range_m: null,
      cruise_speed_mps: 12,
      end_action: "hover",
      own_figures: [],
    },
  ]);
});

test("a moved start asks for another plan, moved back for the same", () => {
  const selection = withUav(withTargets(EMPTY, [tower]), heron);
  const moved = withUavAt(selection, 0, [9.1, 49.1]);
  assert.notEqual(basisOf(moved), basisOf(selection));
  assert.equal(basisOf(withUavAt(moved, 0, [9, 49])), basisOf(selection));
});

test("a stored mission opens as it was picked", () => {
  const mission = {
    objective: "total",
    return_to_start: false,
    uavs: [{ id: 3, name: "Heron", position: [9, 49], max_range_m: null, cruise_speed_mps: 12, end_action: "hover" }],
    targets: [
      {
        asset: 7,
        label: "Tower 18 of 41",
        detail: "138 kV AEP",
        kind: "tower",
        position: [10, 50],
        is_point: false,
        stretch: null,
        task: null,
      },
      {
        asset: 9,
        label: "North",
        detail: "voltage not stated",
        kind: "line",
        position: [10, 50],
        is_point: false,
        stretch: null,
        task: null,
      },
      {
        asset: 9,
        label: "North",
        detail: "voltage not stated",
        kind: "line",
        position: [10.5, 50.5],
        is_point: true,
        stretch: null,
        task: null,
      },
      {
        asset: null,
        label: "Place",
        detail: "",
        kind: null,
        position: [11, 51],
        is_point: true,
        stretch: null,
        task: null,
      },
    ],
  };
  const selection = selectionOf(mission);
  assert.deepEqual(requestOf(selection).targets, [
    { asset: 7 },
    { asset: 9 },
    { asset: 9, position: [10.5, 50.5] },
    { position: [11, 51] },
  ]);
  assert.deepEqual(
    selection.targets.map(({ label, detail }) => [label, detail]).slice(0, 3),
    [tower, wholeLine, pointOnLine].map(({ label, detail }) => [label, detail]),
  );
  assert.deepEqual(
    selection.targets.map(({ centre }) => centre),
    [
      [10, 50],
      [10, 50],
      [10.5, 50.5],
      [11, 51],
    ],
  );
});

test("a row's second fact says how much of a line is picked, then what the server says", () => {
  assert.deepEqual(
    [tower, wholeLine, pointOnLine].map(({ detail }) => detail),
    ["138 kV AEP", "whole line · voltage not stated", "one point · voltage not stated"],
  );
  assert.equal(detailOf("railway", { detail: "CSX", length_m: 4_612 }), "section, 4.6\u00a0km · CSX");
  assert.equal(detailOf("railway", { detail: "CSX", length_m: 4_612 }, [10, 50]), "one point · CSX");
  assert.equal(detailOf("line", { detail: "", length_m: 12_300 }), "whole line, 12.3\u00a0km");
  assert.equal(detailOf("bridge", {}), "");
  assert.equal(nameOf(tower), "Tower 18 of 41, 138 kV AEP");
  assert.equal(nameOf({ label: "Place", detail: "" }), "Place");
});

test("a key names asset and place", () => {
  assert.equal(keyOf({ asset: 9, position: [10.5, 50.5] }), "9 10.50000,50.50000");
  assert.equal(keyOf({ asset: 9 }), "9");
});

test("a UAV whose name is taken in the mission gets a free one there", () => {
  const typed = { ...heron, id: null };
  const other = (id, name = "Heron") => ({ ...heron, id, name });
  const names = [other(3), other(4), other(5, "Heron 2"), other(6)]
    .reduce(withUav, { ...EMPTY, uavs: [typed] })
    .uavs.map(({ name }) => name);
  assert.deepEqual(names, ["Heron", "Heron 2", "Heron 3", "Heron 2 2", "Heron 4"]);
  const long = "H".repeat(100);
  assert.equal(withUav({ ...EMPTY, uavs: [other(3, long)] }, other(4, long)).uavs[1].name, `${"H".repeat(98)} 2`);
});

test("one asset twice in a mission keeps its two places, also in a lock", () => {
  const row = {
    asset: 5,
    label: "Tower 5",
    detail: "",
    kind: "tower",
    position: [10, 50],
    is_point: false,
    stretch: null,
    task: null,
  };
  const locks = [{ uav: "Heron", targets: [1, 0], at_start: true, at_end: false }];
  const selection = selectionOf({
    objective: "total",
    return_to_start: true,
    uavs: [heron],
    targets: [row, row],
    locks,
  });
  assert.deepEqual(requestOf(selection).locks, locks);
  assert.deepEqual(requestOf(selection).targets, [{ asset: 5 }, { asset: 5 }]);
  assert.equal(withoutTargets(selection, [selection.targets[0].key]).targets.length, 1);
});

test("what another system keeps with a target is sent back as it came", () => {
  const given = { external_id: "item-1", attributes: { row: 1, is_urgent: true } };
  const stored = {
    asset: 7,
    kind: "tower",
    label: "Tower 18",
    detail: "",
    length_m: null,
    position: [10, 50],
    stretch: null,
  };
  const targets = [
    { ...stored, is_point: false, ...given },
    { ...stored, asset: 8, is_point: false, external_id: "", attributes: {} },
  ];
  const selection = selectionOf({ objective: "total", return_to_start: true, uavs: [heron], targets, locks: [] });
  assert.deepEqual(requestOf(selection).targets, [{ asset: 7, ...given }, { asset: 8 }]);
});
