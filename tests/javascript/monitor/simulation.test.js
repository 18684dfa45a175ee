import assert from "node:assert/strict";
import { test } from "node:test";

import { rateOf } from "../../../static/js/monitor/clock_rate.js";
import {
  ALL,
  FAULTS,
  isPresent,
  lastsWords,
  meantFor,
  stateWords,
  vehicleWords,
  WELL,
  windOf,
} from "../../../static/js/monitor/text/simulation_text.js";

const vehicle = (name, more = {}) => ({
  id: name,
  name,
  state: "flying",
  battery_wh: 60,
  report: { is_crashed: false },
  conditions: { wind: [], gusts_mps: 0 },
  ...more,
});
const simulation = (more = {}) => ({
  state: "flying",
  speed: 5,
  message: "",
  step_timing: null,
  vehicles: [vehicle("Tern")],
  ...more,
});

test("a simulation says how many fly, how fast, and who is lost or has crashed", () => {
  assert.equal(stateWords(simulation()).words, "1 simulated UAV at 5× real time.");
  assert.equal(stateWords(simulation({ speed: 1 })).words, "1 simulated UAV in real time.");
  const bad = stateWords(
    simulation({ vehicles: [vehicle("Tern", { report: { is_crashed: true } }), vehicle("Kite", { state: "failed" })] }),
  );
  assert.equal(bad.words, "1 simulated UAV at 5× real time. Crashed: Tern. Lost with their simulator: Kite.");
  assert.equal(bad.isBad, true);
});

test("a machine that cannot keep the pace says so", () => {
  assert.match(
    stateWords(simulation({ step_timing: { slipped_s: 12.4 } })).words,
    /too slow for this speed: 12 s behind/,
  );
  assert.doesNotMatch(stateWords(simulation({ step_timing: { slipped_s: 1 } })).words, /too slow/);
});

test("one that waits, failed or ended says why; without one the panel says what it is for", () => {
  assert.equal(stateWords(simulation({ state: "wanted" })).words, "Waiting for a simulator.");
  assert.deepEqual(stateWords(simulation({ state: "failed", message: "Gone." })), { words: "Gone.", isBad: true });
  assert.equal(stateWords(null).isBad, false);
  assert.equal(isPresent(null), false);
});

test("faults are sent with their seconds, and a weak battery by the vehicle's own", () => {
  const sent = Object.fromEntries(FAULTS.map(({ name, of }) => [name, of(vehicle("Tern"), 20)]));
  assert.deepEqual(sent, {
    link: { link_lost_for_s: 20 },
    gps: { gps_lost_for_s: 20 },
    battery: { battery_wh_left: 12 },
    motor: { motor_failed: 0 },
  });
});

test("wind goes round once", () => {
  assert.deepEqual(windOf(8, 360), { wind: [{ altitude_agl_m: 10, speed_mps: 8, from_deg: 0 }], gusts_mps: 0 });
  assert.equal(windOf(8, -90, 2).wind[0].from_deg, 270);
  assert.equal(windOf(8, 0, 2).gusts_mps, 2);
});

test("each of its UAVs says how it does, and what is wrong with it", () => {
  const report = {
    is_crashed: false,
    is_in_air: true,
    altitude_relative_m: 42.4,
    battery_percent: 71.6,
    is_link_lost: true,
  };
  assert.deepEqual(vehicleWords(vehicle("Tern", { report })), {
    words: "in the air at 42\u00a0m · battery 72\u00a0% · calm · link lost",
    isBad: false,
  });
  const air = { wind: [{ speed_mps: 9, from_deg: 180 }], gusts_mps: 2 };
  assert.match(
    vehicleWords(vehicle("Tern", { report, conditions: air })).words,
    /· wind 9\u00a0m\/s from 180°, gusts 2\u00a0m\/s ·/,
  );
  assert.deepEqual(vehicleWords(vehicle("Tern", { report: { ...report, is_crashed: true } })), {
    words: "crashed",
    isBad: true,
  });
  assert.deepEqual(vehicleWords(vehicle("Tern", { state: "failed", message: "Lost." })), {
    words: "Lost.",
    isBad: true,
  });
  assert.equal(vehicleWords(vehicle("Tern", { report: null })).words, "starting");
});

test("a fault that lasts is report by both clocks, unless they are one", () => {
  assert.equal(lastsWords(30, 10), "30 s real time = 300 s simulated");
  assert.equal(lastsWords(30, 1), "");
  assert.equal(lastsWords(NaN, 10), "");
});

test("a clock's rate is a whole number where it nearly is one, and 1 where nobody knows it", () => {
  const rate = (clock_rate, is_simulated = true) => rateOf({ link: { clock_rate }, is_simulated });
  assert.deepEqual([rate(9.7), rate(1.4), rate(null)], [10, 1.4, 1]);
  assert.equal(rateOf({ link: null, is_simulated: true }), 1);
  assert.equal(rate(10, false), 1); // a real aircraft flies by the clock on the wall
});

test("what can be mended is mended", () => {
  assert.deepEqual(WELL.of(), { link_lost_for_s: 0, gps_lost_for_s: 0, motor_failed: null });
});

test("wind and faults are for nobody until a UAV is selected or chosen; all of them are a choice of its own", () => {
  const vehicles = [vehicle("a", { uav: { id: 7 } }), vehicle("b", { uav: { id: 8 } }), vehicle("c", { uav: null })];
  assert.equal(meantFor("", null, vehicles), "");
  assert.equal(meantFor("", 8, vehicles), "b");
  assert.equal(meantFor("a", 8, vehicles), "a");
  assert.equal(meantFor("gone", 7, vehicles), "a");
  assert.equal(meantFor(ALL, 8, vehicles), ALL);
  assert.equal(meantFor("", 99, vehicles), "");
});
