/** Numbers of UAVs compared: candidates, the next smaller plan, rows, and the plans in turn. */

import assert from "node:assert/strict";
import { test } from "node:test";
import { createUavNumbers } from "../../../static/js/mission/actions/plan_beside.js";
import { EMPTY, targetOf } from "../../../static/js/mission/selection.js";
import {
  bestOf,
  canCompareNumbers,
  keyOfNumbers,
  MAX_UAVS,
  numberOf,
  withCandidates,
  withFewer,
} from "../../../static/js/mission/uavs/uav_numbers.js";
import { createStore } from "../../../static/js/store.js";

const tower = (id) => targetOf({ id, kind: "tower", properties: { label: `T${id}` }, centre: [9, 50] });
const targetAt = (lon) => ({ ...tower(lon), centre: [lon, 50] });
const uav = (id, lon = 9, more = {}) => ({
  id,
  name: `Tern ${id}`,
  position: [lon, 50],
  max_range_m: 9000,
  cruise_speed_mps: 12,
  end_action: "return",
  state: "active",
  missing: [],
  ...more,
});
const mission = (uavs, targets = [tower(1), tower(2)]) => ({ ...EMPTY, targets, uavs });
const route = (duration_s, length_m = 1000, bases = 0, targets = []) => ({
  duration_s,
  departs_s: 0,
  length_m,
  waypoints: [
    ...Array.from({ length: bases }, () => ({ kind: "base", target: null, task: { hold_s: 60 } })),
    ...targets.map((target) => ({ kind: "target", target })),
  ],
});
const planned = (...routes) => ({
  routes,
  total_length_m: routes.reduce((sum, { length_m }) => sum + length_m, 0),
  unassigned: [],
  ground_revision: 1,
});

test("candidates are the mission's UAVs, then the nearest of the fleet that can fly", () => {
  const fleet = [
    uav(1, 9.3),
    uav(2, 9.1),
    uav(3, 9.2),
    uav(4, 9, { state: "retired" }),
    uav(5, 9, { missing: ["battery"] }),
  ];
  const first = withCandidates(mission([uav(9, 10)]), fleet);
  assert.deepEqual([first.uavs.map(({ id }) => id), first.objective], [[9, 2, 3, 1], "makespan"]);
  const many = Array.from({ length: 20 }, (_, number) => uav(number + 1));
  assert.equal(withCandidates(mission([]), many).uavs.length, MAX_UAVS);
});

test("they are compared where there are targets, two UAVs and no lock", () => {
  assert.ok(canCompareNumbers(mission([uav(1)]), [uav(2)]));
  assert.ok(!canCompareNumbers(mission([uav(1)]), [uav(1)]));
  assert.ok(!canCompareNumbers(mission([uav(1)], []), [uav(2)]));
  assert.ok(!canCompareNumbers({ ...mission([uav(1), uav(2)]), locks: [{ uav: "Tern 1", targets: [] }] }, []));
});

test("candidates are simulated where the mission's UAVs are, else real where there are any", () => {
  const fleet = [uav(1), uav(2, 9, { is_simulated: true }), uav(3), uav(4, 9, { is_simulated: true })];
  const ids = (selection) => withCandidates(selection, fleet).uavs.map(({ id }) => id);
  assert.deepEqual(ids(mission([])), [1, 3]);
  assert.deepEqual(ids(mission([fleet[1]])), [2, 4]);
  assert.equal(withCandidates(mission([]), [fleet[1], fleet[3]]).uavs.length, 2);
});

test("a UAV that flies otherwise makes other plans, one that is taken out does not", () => {
  const selection = mission([uav(1), uav(2)]);
  const key = (changed) => keyOfNumbers(changed, selection.uavs);
  assert.equal(key(mission([uav(2)])), key(selection));
  assert.notEqual(key(mission([uav(1, 9.5), uav(2)])), key(selection));
  assert.notEqual(key({ ...selection, return_to_start: !selection.return_to_start }), key(selection));
});

test("the best reaches most targets, then is done first", () => {
  const row = (missed, done_s) => ({ missed, done_s });
  assert.equal(bestOf([row(2, 100), row(0, 900), row(0, 800)])?.done_s, 800);
  assert.equal(bestOf([]), undefined);
});

test("more UAVs than can be compared are at once as many as can be", () => {
  const selection = mission(Array.from({ length: 12 }, (_, number) => uav(number + 1)));
  const result = planned(...selection.uavs.map((_, place) => route(100, 1000 + place)));
  assert.deepEqual(
    withFewer(selection, result)?.uavs.map(({ id }) => id),
    [5, 6, 7, 8, 9, 10, 11, 12],
  );
});

test("a tied UAV that stays on the ground does not end the comparison", () => {
  const selection = mission([uav(1), uav(2), uav(3)], [{ ...tower(1), uav: "Tern 1" }]);
  const result = planned(route(0, 0), route(600), route(900));
  assert.equal(numberOf(selection, result)?.flights, 2);
  assert.deepEqual(
    withFewer(selection, result)?.uavs.map(({ id }) => id),
    [1, 3],
  );
});

test("a plan that leaves UAVs on the ground is that of fewer", () => {
  const selection = mission([uav(1), uav(2), uav(3)]);
  const result = planned(route(600), route(0, 0), route(900));
  assert.equal(numberOf(selection, result), null);
  assert.deepEqual(
    withFewer(selection, result)?.uavs.map(({ id }) => id),
    [1, 3],
  );
});

test("of a plan that uses all the one whose targets are nearest to another stays away, unless a target is tied to it", () => {
  const selection = mission([uav(1, 9.4), uav(2), uav(3)], [targetAt(9.4), targetAt(9), targetAt(9.01)]);
  const result = planned(route(600, 4000, 1, [0]), route(900, 5000, 0, [1]), route(800, 5000, 0, [2]));
  assert.deepEqual(numberOf(selection, result), {
    uavs: selection.uavs,
    done_s: 900,
    length_m: 14000,
    flights: 4,
    missed: 0,
  });
  const ids = (selection) => withFewer(selection, result)?.uavs.map(({ id }) => id);
  assert.deepEqual(ids(selection), [1, 3], "the first is alone where its target is");
  assert.deepEqual(
    ids(mission(selection.uavs, [...selection.targets.slice(0, 2), { ...targetAt(9.01), uav: "Tern 2" }])),
    [1, 2],
  );
  const slow = mission([uav(1, 9.4), uav(2), uav(3, 9, { cruise_speed_mps: 8 })], selection.targets);
  assert.deepEqual(ids(slow), [1, 2], "the slower of two at one place");
  assert.equal(withFewer(mission([uav(1)]), planned(route(1500))), null);
});

/** A page whose plans take 1,200 s shared by the UAVs. */
function page(plans = []) {
  const store = createStore({
    selection: mission([uav(1), uav(2), uav(3)]),
    fleet: [],
    figures: {},
    uavNumbers: null,
    planning: null,
  });
  const aside = {
    stops: 0,
    stop: () => {
      aside.stops += 1;
    },
    async wantInTurn(first, nextOf) {
      for (let asked = first; asked; ) {
        plans.push(asked.uavs.length);
        const { length } = asked.uavs;
        asked = nextOf(asked, planned(...asked.uavs.map((_, place) => route(1200 / length + place))));
        await Promise.resolve();
      }
    },
  };
  const change = (selection) => store.update({ selection });
  const context = { store, selection: () => store.state.selection, change, wordsOf: (error) => error.message };
  return { store, aside, actions: createUavNumbers(context, aside) };
}

test("each number has a row, fewest first, and a choice takes its UAVs", async () => {
  const plans = [];
  const { store, actions } = page(plans);
  await actions.compareUavNumbers();
  assert.deepEqual(plans, [3, 2, 1]);
  const { rows, planning } = store.state.uavNumbers;
  assert.deepEqual([rows.map(({ uavs }) => uavs.length), planning], [[1, 2, 3], null]);
  actions.useUavNumber(rows[1]);
  assert.deepEqual(
    store.state.selection.uavs.map(({ id }) => id),
    [2, 3],
  );
  assert.ok(store.state.uavNumbers, "other UAVs leave the rows as they are");
});

test("another selection closes them, and stops what is being planned", async () => {
  const { store, aside, actions } = page();
  const comparing = actions.compareUavNumbers();
  assert.equal(store.state.uavNumbers.planning, 2);
  store.update({ selection: { ...store.state.selection, targets: [tower(7)] } });
  assert.deepEqual([store.state.uavNumbers, aside.stops], [null, 1]);
  await comparing;
  assert.equal(store.state.uavNumbers, null);
});

test("a fault is told beside the rows that are there", async () => {
  const { store, aside, actions } = page();
  aside.wantInTurn = () => Promise.reject(new Error("The server is busy."));
  await actions.compareUavNumbers();
  assert.equal(store.state.uavNumbers.fault, "The server is busy.");
  assert.equal(store.state.uavNumbers.planning, null);
});

test("an answer that comes after the panel was closed and opened again changes nothing", async () => {
  const { store, aside, actions } = page();
  let answer = () => {};
  aside.wantInTurn = () => new Promise((resolve) => (answer = resolve));
  const earlier = actions.compareUavNumbers();
  const answerEarlier = answer;
  actions.closeUavNumbers();
  void actions.compareUavNumbers();
  answerEarlier();
  await earlier;
  assert.deepEqual([store.state.uavNumbers.planning, store.state.uavNumbers.isStopped], [3, false]);
});
