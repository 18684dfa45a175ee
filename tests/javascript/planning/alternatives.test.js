import assert from "node:assert/strict";
import test from "node:test";

import { flying_s, isBestIn, waysOf } from "../../../static/js/mission/panels/why/alternatives.js";
import { basisOf, EMPTY } from "../../../static/js/mission/selection.js";

const result = (more) => ({
  total_length_m: 50_000,
  total_duration_s: 6000,
  total_energy_wh: 200,
  unassigned: [],
  routes: [{ duration_s: 3000, departs_s: 0, geometry: {}, waypoints: [{ kind: "start" }] }],
  ...more,
});
const basis = (objective) => basisOf({ ...EMPTY, objective });

test("each way has its result, its fault or neither, and the present one is marked", () => {
  const state = {
    selection: EMPTY,
    figures: { [basis("makespan")]: result() },
    refusedBeside: { [basis("energy")]: "It is refused." },
    planningBeside: basis("time"),
    plan: { basis: basis("makespan"), result: result() },
  };
  const ways = waysOf(state);
  assert.deepEqual(
    ways.map(({ objective }) => objective),
    ["makespan", "total", "time", "energy"],
  );
  assert.deepEqual(
    ways.map(({ isPresent }) => isPresent),
    [true, false, false, false],
  );
  assert.equal(ways[2].isBeingMade, true);
  assert.equal(ways[3].fault, "It is refused.");
  const bare = { ...state, refusedBeside: {}, plan: { ...state.plan, result: result({ total_energy_wh: null }) } };
  assert.equal(waysOf(bare)[3].fault, "No UAV states its battery’s capacity: energy is not calculated.");
  bare.plan.result.routes = []; // nothing flies: nothing is said of batteries
  assert.equal(waysOf(bare)[3].fault, "");
});

test("the best of a column is marked, and nothing where all are alike", () => {
  const ways = [
    { result: result() },
    {
      result: result({
        total_length_m: 45_000,
        routes: [{ duration_s: 3600, departs_s: 0, waypoints: [{ kind: "start" }] }],
      }),
    },
    { result: null },
  ];
  const [metres, finish, flying, energy] = isBestIn(ways);
  assert.deepEqual(metres, [false, true, false]);
  assert.deepEqual(finish, [true, false, false]);
  assert.deepEqual(flying, [true, false, false]);
  assert.deepEqual(energy, [false, false, false]);
});

test("who reaches fewer targets wins no column but is told to miss more", () => {
  const nothing = {
    result: result({
      total_length_m: 0,
      routes: [{ duration_s: 0, departs_s: 0, waypoints: [] }],
      unassigned: [1, 2, 3],
    }),
  };
  const [metres, finish, flying, , missed] = isBestIn([
    { result: result() },
    nothing,
    { result: result({ total_length_m: 45_000 }) },
  ]);
  assert.deepEqual(metres, [false, false, true]);
  assert.deepEqual(
    [finish, flying],
    [
      [false, false, false],
      [false, false, false],
    ],
  );
  assert.deepEqual(missed, [true, false, true]);
});

test("time on the ground at a base or on a charger is not in the air", () => {
  const at = (kind, hold_s = 0) => ({ kind, task: { hold_s } });
  const routes = [
    { duration_s: 3000, waypoints: [at("start"), at("base", 600), at("target", 30), at("end")], charging: [] },
    {
      duration_s: 1000,
      waypoints: [at("start"), at("end")],
      charging: [{ waypoint: 1, charging_s: 400, stopped_s: 450, charged_wh: 20 }],
    },
    { duration_s: 0, waypoints: [] },
  ];
  assert.equal(flying_s({ total_duration_s: 4000, routes }), 2400 + 600);
});
