import assert from "node:assert/strict";
import { test } from "node:test";
import {
  answerWords,
  batchRequest,
  batchScopes,
  leftLines,
  returnLinesOf,
  scopeChoices,
  whyNot,
} from "../../../static/js/monitor/commands/batch.js";

const HEARD = "2026-09-21T14:15:00Z";

const uav = (id, mission, isInAir = true, place = 0) => ({
  id,
  name: `UAV ${id}`,
  mission,
  place,
  measured: null,
  link: { last_message_at: HEARD, is_in_air: isInAir },
});
const missions = [
  { id: "south", name: "South", state: "active" },
  { id: "north", name: "North", state: "dispatched" },
  { id: "done", name: "Done", state: "completed" },
];
const uavs = [uav(1, "south"), uav(2, "south", false), uav(3, "north", null), uav(4, "done"), uav(5, null)];

test("a batch reaches UAVs of its mission that may be in the air, and says why the others are left", () => {
  const [south, north, ...more] = batchScopes(uavs, missions);
  assert.deepEqual(
    [south, north].map(({ id, uavs: own }) => [id, own.map(({ id: one }) => one)]),
    [
      ["south", [1]],
      ["north", [3]],
    ],
  );
  assert.deepEqual(more, [], "a mission that is over has nobody to command");
  assert.deepEqual(leftLines([south, north]), ["Not sent: UAV 2 is on the ground."]);
});

test("the request of one mission names that mission and its UAVs alone", () => {
  const [south] = batchScopes(uavs, missions);
  assert.deepEqual(batchRequest("return", [south]), {
    path: "/missions/south/commands",
    body: { kind: "return", uavs: [1] },
  });
});

test("a request says how each returns, of those that it names", () => {
  const [south] = batchScopes([uav(1, "south", true, 0), uav(7, "south", true, 1)], missions);
  const ways = new Map([
    [7, { wait_s: 50 }],
    [9, { height_m: 80 }],
  ]);
  assert.deepEqual(batchRequest("return", [south], ways).body.ways, { 7: { wait_s: 50 } });
  assert.equal("ways" in batchRequest("return", [south]).body, false);
});

test("several missions are one request, each named", () => {
  const { path, body } = batchRequest("hold", batchScopes(uavs, missions));
  assert.equal(path, "/missions/commands");
  assert.deepEqual(body, {
    kind: "hold",
    missions: [
      { mission: "south", uavs: [1] },
      { mission: "north", uavs: [3] },
    ],
  });
});

test("each choice names its mission and its UAVs, all of them the missions", () => {
  const choices = scopeChoices(batchScopes(uavs, missions));
  assert.deepEqual(
    choices.map(({ value, words, detail }) => [value, words, detail]),
    [
      ["south", "South: 1 UAV", "UAV 1"],
      ["north", "North: 1 UAV", "UAV 3"],
      ["all", "All 2 missions: 2 UAVs", "South, North"],
    ],
  );
  assert.equal(scopeChoices(batchScopes(uavs.slice(0, 1), missions)).length, 1);
});

test("a command that makes no sense has its reason", () => {
  assert.equal(whyNot(uav(2, "south", false)), "UAV 2 is on the ground.");
  assert.equal(whyNot({ ...uav(6, "south", null), link: { last_message_at: null } }), "UAV 6 never connected.");
  assert.equal(whyNot(uav(3, "north", null)), "", "nobody knows that it is not in the air");
});

test("Return of all says of each way home what Return of one says", () => {
  const battery = { landing_percent: null, reserve_percent: null, unknown: "" };
  const about = { height_m: 60, read_at: HEARD, fence_warning: "", present: null, battery, met: [] };
  const check = (state, warnings) => ({ state, warnings, ...about });
  const flying = [uav(1, "south", true, 0), uav(7, "south", true, 1), uav(8, "south", true, 2)];
  const [south] = batchScopes(flying, missions);
  const low = "Between waypoints 2 and 4, the way home passes wires too low.";
  const returns = new Map([
    [1, check("in_the_way", [low])],
    [7, check("in_the_way", [low])],
    [8, check("clear", [])],
  ]);
  const [wires, clear] = returnLinesOf([south], returns);
  assert.equal(wires, `UAV 1, UAV 7: ${low}`);
  assert.match(clear, /^UAV 8: Return path clear/);
  assert.match(returnLinesOf([south], new Map())[0], /^UAV 1, UAV 7, UAV 8: Return path not checked/);
});

test("the answer says who is told, and of each other one why not", () => {
  const reported = { name: "Tern", is_accepted: true, reasons: [] };
  const refused = {
    name: "Kite",
    is_accepted: false,
    reasons: [{ code: "on_the_ground", message: "Kite is on the ground." }],
  };
  assert.equal(answerWords([reported, refused]), "Sending to 1 UAV. Not sent to Kite: Kite is on the ground.");
});
