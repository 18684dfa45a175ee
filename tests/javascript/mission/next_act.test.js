import assert from "node:assert/strict";
import { test } from "node:test";
import {
  approvedStep,
  flyWords,
  isDoneHere,
  isSavedOnRequest,
  lackingOf,
  nextAct,
  whyNotApproved,
} from "../../../static/js/mission/flying/next_act.js";
import { basisOf, EMPTY, placeTarget, requestOf, targetOf } from "../../../static/js/mission/selection.js";

const tower = targetOf({ id: 7, kind: "tower", properties: { label: "E401-7" }, centre: [9, 50] });
const uav = { id: 1, name: "Heron", position: [9, 50] };
const selection = { ...EMPTY, targets: [tower], uavs: [uav] };
const route = { uav: "Heron", geometry: { type: "LineString", coordinates: [] } };
const plan = { basis: basisOf(selection), targets: [tower], uavs: [uav], result: { routes: [route], unassigned: [] } };
const rehearsal = (level, more = {}) => ({ list: [{ state: "done", is_outdated: false, level, runs: [], ...more }] });
const state = {
  selection,
  plan,
  planning: null,
  rehearsal: { list: [] },
  mission: null,
  name: "",
  planIsStored: false,
};

test("the next act is to plan until there is a plan of what is picked", () => {
  assert.equal(nextAct({ ...state, plan: null }), "plan");
  assert.equal(nextAct({ ...state, selection: { ...selection, objective: "total" } }), "plan");
  assert.equal(nextAct({ ...state, planning: {} }), "plan");
  const nothing = { ...plan, result: { routes: [{ ...route, geometry: null }], unassigned: [{}] } };
  assert.equal(nextAct({ ...state, plan: nothing }), "plan");
});

test("then to rehearse until a rehearsal of it has not failed, then to approve", () => {
  assert.equal(nextAct(state), "rehearse");
  assert.equal(nextAct({ ...state, rehearsal: { list: null } }), "rehearse");
  assert.equal(nextAct({ ...state, rehearsal: rehearsal("fail") }), "rehearse");
  assert.equal(nextAct({ ...state, rehearsal: rehearsal("pass", { is_outdated: true }) }), "rehearse");
  assert.equal(nextAct({ ...state, rehearsal: rehearsal("pass") }), "approve");
  assert.equal(nextAct({ ...state, rehearsal: rehearsal("warnings") }), "approve");
});

test("an approved mission is uploaded and started on its page; to connect and to simulate it leads to the page Fly", () => {
  const row = { uav: 1, name: "Heron", place: 0, is_loaded: false, blocks: false, is_ready: false, checks: [] };
  const step = (next_act, more = {}, is_simulated = false) =>
    approvedStep({ uavs: [{ is_simulated }] }, { next_act, checks: [], uavs: [{ ...row, ...more }] });
  assert.equal(approvedStep({ uavs: [] }, null), null);
  const upload = step("upload");
  assert.deepEqual([upload.words, isDoneHere(upload), upload.uavs], ["Upload to 1 UAV", true, [1]]);
  const start = step("start", { is_loaded: true, is_ready: true });
  assert.deepEqual([start.words, isDoneHere(start), start.why], ["Start 1 UAV", true, ""]);
  assert.deepEqual([step("connect"), step("connect", {}, true)].map(isDoneHere), [false, false]);
  assert.deepEqual([step("connect"), step("connect", {}, true), null].map(flyWords), [
    "Fly: Connect 1 UAV",
    "Fly in simulation",
    "Fly",
  ]);
});

test("what would be refused has its reason", () => {
  assert.deepEqual(lackingOf(EMPTY)?.[0], "Nothing picked yet.");
  assert.deepEqual(lackingOf({ ...selection, uavs: [] })?.[0], "No UAV is chosen.");
  assert.equal(lackingOf(selection), null);
  assert.equal(whyNotApproved({ ...state, plan: null }), "It has changed since it was planned. Plan again first.");
  assert.equal(whyNotApproved(state), "It is not saved yet.");
});

test("only a new mission without a plan is saved on request", () => {
  assert.equal(isSavedOnRequest({ ...state, plan: null }), true);
  assert.equal(isSavedOnRequest(state), false);
  assert.equal(isSavedOnRequest({ ...state, plan: null, selection: EMPTY }), false);
  assert.equal(isSavedOnRequest({ ...state, plan: null, mission: { id: "m", name: "M" } }), false);
});

test("a place that is clicked with the right button is a target by its coordinates", () => {
  const target = placeTarget([10.2, 56.2]);
  assert.equal(target.label, "56.20000, 10.20000");
  assert.deepEqual(requestOf({ ...EMPTY, targets: [target] }).targets, [{ position: [10.2, 56.2] }]);
});
