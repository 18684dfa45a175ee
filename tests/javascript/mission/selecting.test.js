import assert from "node:assert/strict";
import test from "node:test";

import { isWide } from "../../../static/js/map/lasso.js";
import { partOfLine } from "../../../static/js/mission/map/line_part.js";
import {
  basisOf,
  EMPTY,
  keyOf,
  requestOf,
  storedTarget,
  targetOf,
  targetOfRow,
  withTargets,
} from "../../../static/js/mission/selection.js";
import {
  listIn,
  placesToAdd,
  refsIn,
  rowsToAdd,
  targetOfPlace,
} from "../../../static/js/mission/targets/list_reading.js";
import { isUsualTask, taskOf, withTask, withViews } from "../../../static/js/mission/tasks.js";
import { createHistory, createStore } from "../../../static/js/store.js";

const tower = targetOf({ id: 7, kind: "tower", properties: { label: "T 7" }, centre: [10, 50] });
const line = targetOf({ id: 9, kind: "line", properties: { label: "North" }, centre: [10, 50] });
const point = targetOf({ id: 9, kind: "line", properties: { label: "North" }, position: [10.5, 50.5] });
const place = storedTarget({
  asset: null,
  label: "Place",
  detail: "",
  kind: null,
  position: [11, 51],
  is_point: true,
  stretch: null,
  task: null,
});

test("a list is parted at line ends, tabs, commas and semicolons; each reference counts once", () => {
  assert.deepEqual(refsIn(' T 1\r\n"T 2"\tT 3,T 4; T 5\n\nT 1\n'), ["T 1", "T 2", "T 3", "T 4", "T 5"]);
  assert.deepEqual(refsIn(" \n , ;"), []);
});

test("a table whose first line names external_id gives each reference its id", () => {
  const table = '\uFEFFref;External_ID;note\r\n"T;1";SAP-1;x\r\nT 2;;"a ""b"" c"\r\n;SAP-3;\r\nT 4;"SAP-4"\r\n';
  const { refs, externalIds } = listIn(table);
  assert.deepEqual(refs, ["T;1", "T 2", "T 4"]);
  assert.deepEqual(
    [...externalIds],
    [
      ["T;1", "SAP-1"],
      ["T 4", "SAP-4"],
    ],
  );
  assert.deepEqual(listIn("external_id\tmast\nA\tT 1\n").refs, ["T 1"]);
  assert.deepEqual(listIn("a,,external_id\nT 1,,X").externalIds.get("T 1"), "X");
  const plain = { externalIds: new Map(), places: [], left: 0, format: "" };
  assert.deepEqual(listIn("T 1,T 2\nT 3"), { refs: ["T 1", "T 2", "T 3"], ...plain });
  const results = [
    { ref: "T 1", match: "found", assets: [{ id: 1 }] },
    { ref: "T 2", match: "several", assets: [{ id: 2 }, { id: 3 }] },
  ];
  const ids = new Map([
    ["T 1", "A"],
    ["T 2", "B"],
  ]);
  assert.deepEqual(rowsToAdd(results, new Map([["T 2", "3"]]), ids), [
    { id: 1, external_id: "A" },
    { id: 3, external_id: "B" },
  ]);
});

test("what has one meaning is added, of several meanings what was chosen", () => {
  const asset = (id) => ({ id });
  const results = [
    { ref: "a", match: "found", assets: [asset(1)] },
    { ref: "b", match: "several", assets: [asset(2), asset(3)] },
    { ref: "c", match: "several", assets: [asset(4), asset(5)] },
    { ref: "d", match: "several", assets: [asset(6), asset(7)] },
    { ref: "e", match: "none", assets: [] },
  ];
  assert.deepEqual(
    rowsToAdd(
      results,
      new Map([
        ["b", "all"],
        ["c", "5"],
      ]),
    ).map(({ id }) => id),
    [1, 2, 3, 5],
  );
});

test("the usual task follows what is picked, as on the server", () => {
  assert.deepEqual([tower, line, point, place].map(taskOf), [
    { kind: "photo", hold_s: 10 },
    { kind: "look", hold_s: 0 },
    { kind: "look", hold_s: 5 },
    { kind: "hold", hold_s: 10 },
  ]);
});

test("a task is set for some targets and asked for where it is not the usual one", () => {
  const selection = withTargets(EMPTY, [tower, point]);
  const held = withTask(selection, [tower.key], { kind: "hold" });
  assert.deepEqual(held.targets.map(taskOf), [
    { kind: "hold", hold_s: 30 },
    { kind: "look", hold_s: 5 },
  ]);
  assert.deepEqual(requestOf(held).targets, [
    { asset: 7, task: { kind: "hold", hold_s: 30 } },
    { asset: 9, position: [10.5, 50.5] },
  ]);
  const longer = withTask(held, [tower.key, point.key], { kind: "hold", hold_s: 90 });
  assert.deepEqual(longer.targets.map(taskOf), [
    { kind: "hold", hold_s: 90 },
    { kind: "hold", hold_s: 90 },
  ]);
  assert.deepEqual(withTask(longer, [tower.key], { kind: "hold" }).targets.map(taskOf), longer.targets.map(taskOf)); // keeps its seconds
  const back = withTask(withTask(longer, [tower.key], { kind: "photo" }), [point.key], { kind: "look" });
  assert.deepEqual(requestOf(back).targets, requestOf(selection).targets);
});

test("a line that is flown along may have a speed, which its other tasks end", () => {
  const line = targetOf({ id: 9, kind: "line", properties: { label: "E9" } });
  const tower = targetOf({ id: 1, kind: "tower", properties: { label: "T1" } });
  const selection = { ...EMPTY, targets: [line, tower] };
  const slow = withTask(selection, [line.key, tower.key], { kind: "look", speed_mps: 5 });
  assert.deepEqual(slow.targets.map(taskOf), [
    { kind: "look", hold_s: 0, speed_mps: 5 },
    { kind: "look", hold_s: 5 },
  ]);
  assert.ok(!isUsualTask(slow.targets[0]));
  const held = withTask(slow, [line.key], { kind: "look", hold_s: 20 });
  assert.deepEqual(taskOf(held.targets[0]), { kind: "look", hold_s: 20, speed_mps: 5 });
  assert.equal(withTask(slow, [line.key], { kind: "look", speed_mps: null }).targets[0].task, null);
  assert.equal(taskOf(withTask(slow, [line.key], { kind: "photo" }).targets[0]).speed_mps, undefined);
  assert.deepEqual(requestOf({ ...slow, uavs: [] }).targets[0].task, { kind: "look", hold_s: 0, speed_mps: 5 });
});

test("a stored task that is the usual one asks for the same plan as none", () => {
  const stored = storedTarget({
    asset: 7,
    label: "T 7",
    detail: "",
    kind: "tower",
    position: [10, 50],
    is_point: false,
    stretch: null,
    task: { kind: "photo", hold_s: 10 },
  });
  assert.ok(isUsualTask(stored));
  assert.deepEqual(requestOf({ ...EMPTY, targets: [stored] }).targets, [{ asset: 7 }]);
});

test("a stretch is another target than its line and says how long it is", () => {
  const stretch = [
    [10, 50],
    [10.1, 50],
  ];
  const target = targetOf({
    id: 9,
    kind: "line",
    properties: { label: "North", length_m: 7_150 },
    centre: [10.05, 50],
    stretch,
  });
  assert.notEqual(target.key, line.key);
  assert.equal(target.key, keyOf({ asset: 9, stretch }));
  assert.equal(target.detail, "tower to tower, 7.2\u00a0km");
  assert.deepEqual(requestOf(withTargets(EMPTY, [target])).targets, [{ asset: 9, stretch }]);
});

test("a short row of the API is a target like any other", () => {
  assert.deepEqual(
    targetOfRow({ id: 7, kind: "tower", label: "T 7", detail: "", length_m: null, centre: [10, 50] }),
    tower,
  );
});

test("the part of a line between two places goes over the vertices between them, in the line's direction", () => {
  const geometry = {
    type: "LineString",
    coordinates: [
      [0, 0],
      [1, 0],
      [2, 0],
      [3, 0],
    ],
  };
  const part = {
    type: "LineString",
    coordinates: [
      [0.5, 0],
      [1, 0],
      [2, 0],
      [2.5, 0],
    ],
  };
  assert.deepEqual(
    partOfLine(geometry, [
      [0.5, 0],
      [2.5, 0],
    ]),
    part,
  );
  assert.deepEqual(
    partOfLine(geometry, [
      [2.5, 0],
      [0.5, 0],
    ]),
    part,
  );
  assert.deepEqual(
    partOfLine(geometry, [
      [1.2, 0],
      [1.8, 0],
    ]).coordinates,
    [
      [1.2, 0],
      [1.8, 0],
    ],
  );
});

test("a lasso that goes round nothing is a click", () => {
  assert.equal(
    isWide([
      [0, 0],
      [100, 0],
    ]),
    false,
  );
  assert.equal(
    isWide([
      [0, 0],
      [5, 0],
      [5, 5],
    ]),
    false,
  );
  assert.equal(
    isWide([
      [0, 0],
      [50, 0],
      [50, 50],
    ]),
    true,
  );
});

test("undo goes back to the beginning, however many steps there were", () => {
  const store = createStore({ selection: { step: 0 }, canUndo: false, canRedo: false });
  const history = createHistory(store, "selection");
  for (let step = 1; step <= 1_000; step += 1) history.changeTo({ step });
  while (history.undo());
  assert.deepEqual(store.state, { selection: { step: 0 }, canUndo: false, canRedo: true });
  while (history.redo());
  assert.equal(store.state.selection.step, 1_000);
});

test("a table with columns of coordinates has places, also with decimal commas", () => {
  const { refs, places } = listIn("name;Lat;Lon\nMast 1;39,96123456;-83,0\n;39.5;-82.5\nMast 3;;\n");
  assert.deepEqual(refs, ["Mast 1", "Mast 3"]);
  assert.deepEqual(
    places.map(({ ref, position }) => [ref, position]),
    [
      ["Mast 1", [-83, 39.961235]],
      ["", [-82.5, 39.5]],
    ],
  );
  assert.deepEqual(listIn("ref,latitude,longitude\nA,91,0\n").places, []);
});

test("of a GeoJSON names are looked up, points have a place, and other shapes without a name are counted", () => {
  const feature = (geometry, properties, id) => ({ type: "Feature", id, geometry, properties });
  const point = { type: "Point", coordinates: [9, 50, 120] };
  const line = { type: "LineString", coordinates: [point.coordinates, [9.1, 50]] };
  const features = [
    feature(point, { REF: "T 1", external_id: "SAP-1" }),
    feature(point, null, 7),
    feature(line, { name: "North line" }),
    feature(line, {}),
    feature(null, null),
  ];
  const { refs, externalIds, places, left } = listIn(JSON.stringify({ type: "FeatureCollection", features }));
  assert.deepEqual(refs, ["T 1", "7", "North line"]);
  assert.deepEqual([...externalIds], [["T 1", "SAP-1"]]);
  assert.deepEqual(
    places.map(({ position }) => position),
    [
      [9, 50],
      [9, 50],
    ],
  );
  assert.equal(left, 2);
  assert.deepEqual(listIn('{"type": "Feature"').refs, []);
});

test("a place is added by its coordinates where its name is not in the data", () => {
  const place = (ref, external_id = "") => ({ ref, position: [9, 50], external_id });
  const results = [
    { ref: "T 1", match: "found", assets: [] },
    { ref: "T 2", match: "none", assets: [] },
    { ref: "T 3", match: "several", assets: [] },
  ];
  const places = placesToAdd([place("T 1"), place("T 2"), place("T 3"), place("")], results);
  assert.deepEqual(
    places.map(({ ref }) => ref),
    ["T 2", ""],
  );
  assert.equal(targetOfPlace(place("T 2")).external_id, "T 2");
  assert.equal(targetOfPlace(place("T 2", "SAP-2")).external_id, "SAP-2");
  assert.equal(targetOfPlace(place("")).external_id, undefined);
});

test("photos of every part need the camera, and another task needs it no more", () => {
  const camera = { name: "Zoom", sensor_width_mm: 6.4, pixels_wide: 8000 };
  const selection = withTargets(EMPTY, [tower, line]);
  const viewed = withViews(selection, [tower.key, line.key], { gsd_mm: 2, min_height_m: 4, camera });
  assert.deepEqual(taskOf(viewed.targets[0]), {
    kind: "photo",
    hold_s: 3,
    views: { gsd_mm: 2, min_height_m: 4, camera },
  });
  assert.equal(viewed.targets[0].sensor, "Zoom");
  assert.equal(viewed.targets[1], selection.targets[1], "a line is no tower");
  const bridge = { ...tower, key: "bridge", kind: "bridge" };
  for (const [pattern, kind] of [
    ["spans", undefined],
    ["overview", "photo"],
  ]) {
    const [target] = withViews({ ...selection, targets: [bridge] }, ["bridge"], {
      pattern,
      gsd_mm: 2,
      min_height_m: 4,
      camera,
    }).targets;
    assert.equal(target.task?.kind, kind, "wires are those of towers");
  }
  const stored = {
    ...viewed.targets[0],
    task: {
      kind: "photo",
      hold_s: 3,
      views: { camera: { pixels_wide: 8000, name: "Zoom", sensor_width_mm: 6.4 }, gsd_mm: 2, min_height_m: 4 },
    },
  };
  assert.equal(
    basisOf({ ...viewed, targets: [stored] }),
    basisOf({ ...viewed, targets: [viewed.targets[0]] }),
    "whatever the order of names",
  );
  const longer = withTask(viewed, [tower.key], { kind: "photo", hold_s: 5 });
  assert.deepEqual([taskOf(longer.targets[0]).hold_s, taskOf(longer.targets[0]).views?.gsd_mm], [5, 2]);
  const plain = withTask(viewed, [tower.key], { kind: "photo" });
  assert.deepEqual([plain.targets[0].task, plain.targets[0].sensor], [null, ""]);
});
