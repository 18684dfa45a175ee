import assert from "node:assert/strict";
import test from "node:test";
import { figuresOfCheck, speedWords } from "../../../static/js/mission/hand/hand_figures.js";
import {
  bodyOf,
  changedLegs,
  changesOf,
  dropped,
  faultsOf,
  inserted,
  isLegClear,
  moved,
  paced,
  pointsOf,
  raised,
} from "../../../static/js/mission/hand/hand_route.js";
import { createManualEditing } from "../../../static/js/mission/hand/manual_editing.js";
import { createStore } from "../../../static/js/store.js";

const at = (lon, kind, target = null) => ({ position: [lon, 40], altitude_agl_m: 60, kind, target });
const route = {
  geometry: {},
  length_m: 3400,
  duration_s: 300,
  battery_percent: 60,
  waypoints: [at(10, "start"), at(10.01, "pass"), at(10.02, "target", 0), at(10.03, "pass"), at(10.04, "end")],
  by_hand: [3],
};
const original = pointsOf(route);

test("start, end and targets stay where they are and on the route", () => {
  for (const index of [0, 2, 4]) {
    assert.equal(moved(original, index, [11, 41]), original);
    assert.equal(dropped(original, index), original);
  }
  assert.deepEqual(moved(original, 1, [10.011, 40.001])[1].position, [10.011, 40.001]);
  assert.equal(original[3].isManual, true);
});

test("only the legs beside a change are changed", () => {
  assert.deepEqual(changedLegs(original, original), []);
  assert.deepEqual(changedLegs(moved(original, 1, [10.01, 40.001]), original), [0, 1]);
  assert.deepEqual(changedLegs(dropped(original, 3), original), [2]);
  assert.deepEqual(changedLegs(inserted(original, 0, [10.005, 40.002]), original), [0, 1]);
  assert.deepEqual(changedLegs(raised(original, 2, 80), original), [1, 2]);
});

test("back where it was, nothing is changed", () => {
  const there = moved(original, 1, [10.01, 40.001]);
  assert.equal(changesOf(there, original), 1);
  assert.equal(changesOf(moved(there, 1, [10.01, 40]), original), 0);
  assert.equal(changesOf(dropped(original, 1), original), 1);
  assert.equal(changesOf(inserted(original, 1), original), 1);
});

test("a new waypoint is in the middle and as high as the higher neighbour; it has no place in the stored route", () => {
  const points = inserted(raised(original, 2, 90), 1);
  assert.deepEqual([points[2].position, points[2].altitude_agl_m], [[10.015, 40], 90]);
  assert.deepEqual(
    bodyOf(points).waypoints.map(({ was }) => was),
    [0, 1, null, 2, 3, 4],
  );
});

test("what the server says of single places finds them", () => {
  const faults = faultsOf({
    "waypoints.3.altitude_agl_m": ["Between 60 and 120 m."],
    "legs.2": ["This leg meets Airport."],
    waypoints: ["The battery lacks 5 Wh."],
  });
  assert.deepEqual([...faults.points], [[3, "Between 60 and 120 m."]]);
  assert.deepEqual([...faults.legs], [[2, "This leg meets Airport."]]);
  assert.deepEqual(faults.other, ["The battery lacks 5 Wh."]);
});

const asked = [];
globalThis.document = { cookie: "" };
globalThis.fetch = async (address, { method, body }) => {
  const { waypoints } = JSON.parse(body);
  asked.push([method, address, waypoints]);
  const faults = Object.fromEntries(
    waypoints
      .slice(1)
      .flatMap(({ position }, index) => (position[1] < 40.01 ? [] : [[`legs.${index}`, "This leg meets Airport."]])),
  );
  const answer = {
    faults,
    length_m: 3500,
    duration_s: 310,
    energy_wh: 20,
    battery_percent: 58,
    waypoints: waypoints.map(() => ({ arrival_s: 1, battery_left_percent: 60, speed_mps: 9 })),
  };
  return { ok: true, status: 200, headers: { get: () => null }, text: async () => JSON.stringify(answer) };
};
const settled = () => new Promise((resolve) => setTimeout(resolve, 5));

async function editing() {
  const { basisOf, EMPTY } = await import("../../../static/js/mission/selection.js");
  const plan = { basis: basisOf(EMPTY), result: { routes: [route], departs_at: null } };
  const store = createStore({
    hand: null,
    why: null,
    plan,
    planIsStored: true,
    mission: { id: "m", revision: 3 },
    selection: EMPTY,
    tool: "point",
  });
  const actions = createManualEditing(
    { store, selection: () => EMPTY, problem: () => {}, wordsOf: String },
    { save: async () => {}, keepOpen: () => {} },
  );
  asked.length = 0;
  await actions.beginManually(0);
  await settled();
  return { store, actions, hand: () => store.state.hand };
}

test("each change is a step that can be undone, and each route is asked about once, as it is stored too", async () => {
  const { store, actions, hand } = await editing();
  assert.deepEqual(
    asked.map(([method, address]) => [method, address]),
    [["POST", "/api/v1/missions/m/routes/0/waypoints/look"]],
  );
  actions.moveManually(1, [10.01, 40.02]);
  assert.deepEqual(
    [...hand().legs],
    [
      [0, null],
      [1, null],
    ],
  );
  assert.equal(hand().isCheckOld, true);
  await settled();
  assert.deepEqual(
    [...hand().legs].map(([index, known]) => [index, known.is_clear]),
    [
      [0, false],
      [1, true],
    ],
  );
  assert.deepEqual([hand().look.length_m, hand().isCheckOld, [...hand().faults.legs.keys()]], [3500, false, [0]]);
  actions.undoManualEdit();
  assert.deepEqual([hand().legs.size, hand().isCheckOld], [0, false]);
  actions.redoManualEdit();
  await settled();
  assert.equal(asked.length, 2); // known already
  assert.deepEqual([hand().canUndo, hand().canRedo], [true, false]);
  store.update({ why: null });
  assert.equal(store.state.hand, null); // closing the panel ends it
});

test("while a waypoint is dragged the last answer stands until the next one, and the last place is asked about", async () => {
  const { actions, hand } = await editing();
  const at = (lat) => moved(hand().original, 1, [10.01, lat]);
  actions.dragManually(at(40.02), 1);
  actions.dragManually(at(40.03), 1);
  actions.dragManually(at(40.001), 1);
  assert.equal(asked.length, 2); // one after the other
  await settled();
  assert.equal(asked.length, 3);
  assert.equal(asked[2][2][1].position[1], 40.001);
  assert.deepEqual(
    [...hand().legs.values()].map(({ is_clear }) => is_clear),
    [true, true],
  );
  actions.dropManually(at(40.02), 1);
  assert.equal(hand().isCheckOld, false); // that place was asked about on the way
  assert.equal(hand().legs.get(0).is_clear, false);
});

test("what could not be asked says so and is asked again with the next change", async () => {
  const { actions, hand } = await editing();
  const { fetch } = globalThis;
  globalThis.fetch = async () => {
    throw new TypeError("away");
  };
  actions.moveManually(1, [10.01, 40.002]);
  await settled();
  assert.match(hand().unknown, /^Not checked: /);
  globalThis.fetch = fetch;
  actions.moveManually(1, [10.01, 40.003]);
  await settled();
  assert.deepEqual([hand().unknown, hand().isCheckOld], ["", false]);
});

test("a fault of a waypoint is one of the legs at it", () => {
  const faults = faultsOf({ "waypoints.2.altitude_agl_m": ["Too low."] });
  assert.deepEqual(
    [0, 1, 2, 3].map((index) => isLegClear(faults, index)),
    [true, false, false, true],
  );
});

test("length, time and battery are told beside what they were", () => {
  const look = { length_m: 3812, duration_s: 372, battery_percent: 57.8 };
  assert.equal(
    figuresOfCheck(look, route),
    "3.8\u00a0km (+412\u00a0m) · 6\u00a0min (+1\u00a0min) · 58\u00a0% (−2\u00a0%) at landing",
  );
  assert.equal(figuresOfCheck({ ...look, length_m: null }, route), "");
  assert.doesNotMatch(figuresOfCheck({ length_m: 3400, duration_s: 300, battery_percent: null }, route), /[(%]/);
});

test("the speed on a leg is what the wind leaves", () => {
  const point = original[1];
  assert.equal(speedWords(point, 12, 12), "12\u00a0m/s over ground, as planned.");
  assert.equal(speedWords(point, 12, 8.2), "8.2\u00a0m/s over ground: the wind leaves no more of 12\u00a0m/s.");
  assert.equal(speedWords({ ...point, speed_mps: 6 }, 12, 6), "By hand; empty: 12\u00a0m/s as planned.");
  assert.equal(speedWords(original[0], 12, null), "No leg leads here.");
});

test("a speed belongs to the leg that leads to a waypoint, and is taken back like the rest", () => {
  const slow = paced(original, 3, 6);
  assert.deepEqual(changedLegs(slow, original), [2]);
  assert.equal(changesOf(slow, original), 1);
  assert.equal(changesOf(paced(slow, 3, null), original), 0);
  assert.equal(paced(original, 0, 6), original); // no leg leads to the start
  assert.deepEqual(
    bodyOf(slow).waypoints.map(({ speed_mps }) => speed_mps),
    [null, null, null, 6, null],
  );
  assert.equal(inserted(slow, 2)[3].speed_mps, 6); // both parts of the leg
});

test("a stored speed is known by its waypoint", () => {
  const stored = pointsOf({ ...route, speeds_by_hand: [{ waypoint: 2, speed_mps: 4.5 }] });
  assert.deepEqual(
    stored.map(({ speed_mps }) => speed_mps),
    [null, null, 4.5, null, null],
  );
});
