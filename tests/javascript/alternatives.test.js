import assert from "node:assert/strict";
import test from "node:test";

import { flying_s, isBestIn, waysOf } from "../../static/js/mission/panels/alternatives.js";
import { basisOf, EMPTY } from "../../static/js/mission/selection.js";

const result = (more) => ({ total_length_m: 50_000, total_duration_s: 6000, total_energy_wh: 200, unassigned: [], routes: [{ duration_s: 3000, departs_s: 0 }], ...more });
const basis = (objective) => basisOf({ ...EMPTY, objective });

test("each way has its result, its fault or neither, and the present one is marked", () => {
  const state = { selection: EMPTY, figures: { [basis("makespan")]: result() }, refusedBeside: { [basis("energy")]: "It is refused." }, planningBeside: basis("time"), plan: { basis: basis("makespan"), result: result() } };
  const ways = waysOf(state);
  assert.deepEqual(ways.map(({ objective }) => objective), ["makespan", "total", "time", "energy"]);
  assert.deepEqual(ways.map(({ isPresent }) => isPresent), [true, false, false, false]);
  assert.equal(ways[2].isBeingMade, true);
  assert.equal(ways[3].fault, "It is refused.");
  const bare = { ...state, refusedBeside: {}, plan: { ...state.plan, result: result({ total_energy_wh: null }) } };
  assert.equal(waysOf(bare)[3].fault, "No UAV has a battery.");
});

test("the best of a column is marked, and nothing where all are alike", () => {
  const ways = [{ result: result() }, { result: result({ total_length_m: 45_000, routes: [{ duration_s: 3600, departs_s: 0 }] }) }, { result: null }];
  const [metres, finish, flying, energy] = isBestIn(ways);
  assert.deepEqual(metres, [false, true, false]);
  assert.deepEqual(finish, [true, false, false]);
  assert.deepEqual(flying, [false, false, false]);
  assert.deepEqual(energy, [false, false, false]);
});

test("flying time is that of all UAVs together, also in plans from before", () => {
  assert.equal(flying_s(result()), 6000);
  assert.equal(flying_s({ routes: [{ duration_s: 100 }, { duration_s: 50 }] }), 150);
});
