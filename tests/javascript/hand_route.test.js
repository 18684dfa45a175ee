import assert from "node:assert/strict";
import test from "node:test";

import { createHandEditing } from "../../static/js/mission/hand_editing.js";
import { bodyOf, changedLegs, changesOf, dropped, faultsOf, inserted, legOf, moved, paced, pointsOf, raised } from "../../static/js/mission/hand_route.js";
import { createStore } from "../../static/js/store.js";

const at = (lon, kind, target = null) => ({ position: [lon, 40], altitude_agl_m: 60, kind, target });
const route = { geometry: {}, waypoints: [at(10, "start"), at(10.01, "pass"), at(10.02, "target", 0), at(10.03, "pass"), at(10.04, "end")], arrival_s: [0, 60, 120, 180, 240], by_hand: [3] };
const original = pointsOf(route);

test("start, end and targets stay where they are and on the route", () => {
  for (const index of [0, 2, 4]) {
    assert.equal(moved(original, index, [11, 41]), original);
    assert.equal(dropped(original, index), original);
  }
  assert.deepEqual(moved(original, 1, [10.011, 40.001])[1].position, [10.011, 40.001]);
  assert.equal(original[3].isByHand, true);
});

test("only the legs beside a change are checked", () => {
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
  assert.deepEqual(bodyOf(points).waypoints.map(({ was }) => was), [0, 1, null, 2, 3, 4]);
  const { start, end } = legOf(points, 2);
  assert.deepEqual([start.arrival_s, end.arrival_s], [60, 120]); // its own is not known: it is between those
});

test("what the server says of single places finds them", () => {
  const faults = faultsOf({ "waypoints.3.altitude_agl_m": ["Between 60 and 120 m."], "legs.2": ["This leg meets Airport."], waypoints: ["The battery lacks 5 Wh."] });
  assert.deepEqual([...faults.points], [[3, "Between 60 and 120 m."]]);
  assert.deepEqual([...faults.legs], [[2, "This leg meets Airport."]]);
  assert.deepEqual(faults.other, ["The battery lacks 5 Wh."]);
});

const asked = [];
globalThis.document = { cookie: "" };
globalThis.fetch = async (address, { method, body }) => {
  const sent = JSON.parse(body);
  asked.push([method, address, sent]);
  const legs = sent.legs?.map(({ end }) => ({ is_clear: end.position[1] < 40.01, zone: null, message: "It meets Airport." }));
  return { ok: true, status: 200, headers: { get: () => null }, text: async () => JSON.stringify({ legs }) };
};
const settled = () => new Promise((resolve) => setTimeout(resolve));

test("each change is a step that can be undone, and each changed leg is asked about once", async () => {
  const plan = { basis: JSON.stringify({}), result: { routes: [route], departs_at: null } };
  const store = createStore({ hand: null, why: null, plan, planIsStored: true, mission: { id: "m", revision: 3 }, selection: null, tool: "point" });
  const { basisOf, EMPTY } = await import("../../static/js/mission/selection.js");
  store.update({ selection: EMPTY, plan: { ...plan, basis: basisOf(EMPTY) } });
  const editing = createHandEditing({ store, selection: () => EMPTY, problem: () => {}, wordsOf: String }, { save: async () => {}, keepOpen: () => {} });
  await editing.beginByHand(0);
  editing.moveByHand(1, [10.01, 40.02]);
  await settled();
  assert.deepEqual([...store.state.hand.legs].map(([index, verdict]) => [index, verdict.is_clear]), [[0, false], [1, true]]);
  assert.equal(asked.length, 1);
  editing.undoByHand();
  assert.equal(store.state.hand.legs.size, 0);
  editing.redoByHand();
  await settled();
  assert.equal(asked.length, 1); // known already
  assert.deepEqual([store.state.hand.canUndo, store.state.hand.canRedo], [true, false]);
  store.update({ why: null });
  assert.equal(store.state.hand, null); // closing the panel ends it
});

test("a speed belongs to the leg that leads to a waypoint, and is taken back like the rest", () => {
  const slow = paced(original, 3, 6);
  assert.deepEqual(changedLegs(slow, original), [2]);
  assert.equal(changesOf(slow, original), 1);
  assert.equal(changesOf(paced(slow, 3, null), original), 0);
  assert.equal(paced(original, 0, 6), original); // no leg leads to the start
  assert.deepEqual(bodyOf(slow).waypoints.map(({ speed_mps }) => speed_mps), [null, null, null, 6, null]);
  assert.equal(inserted(slow, 2)[3].speed_mps, 6); // both parts of the leg
});

test("a stored speed is known by its waypoint", () => {
  const stored = pointsOf({ ...route, speeds_by_hand: [{ waypoint: 2, speed_mps: 4.5 }] });
  assert.deepEqual(stored.map(({ speed_mps }) => speed_mps), [null, null, 4.5, null, null]);
});

test("a slow leg is asked about for as long as it takes", () => {
  const { start, end, speed_mps } = legOf(paced(original, 3, 2), 2); // 852 m
  assert.deepEqual([start.arrival_s, speed_mps], [120, 2]);
  assert.ok(Math.abs(end.arrival_s - (120 + 426)) < 1);
  assert.equal(legOf(paced(original, 3, 100), 2).end.arrival_s, 180);
});
