import assert from "node:assert/strict";
import { test } from "node:test";

import { FAULTS, isPresent, stateWords, windOf } from "../../static/js/monitor/simulation_words.js";

const vehicle = (name, more = {}) => ({ id: name, name, state: "flying", battery_wh: 60, told: { is_crashed: false }, ...more });
const simulation = (more = {}) => ({ state: "flying", speed: 5, message: "", pace: null, vehicles: [vehicle("Tern")], ...more });

test("a simulation says how many fly, how fast, and who is lost or has crashed", () => {
  assert.equal(stateWords(simulation()).words, "1 simulated UAV at 5 times real time.");
  assert.equal(stateWords(simulation({ speed: 1 })).words, "1 simulated UAV in real time.");
  const bad = stateWords(simulation({ vehicles: [vehicle("Tern", { told: { is_crashed: true } }), vehicle("Kite", { state: "failed" })] }));
  assert.equal(bad.words, "1 simulated UAV at 5 times real time. Crashed: Tern. Lost with their simulator: Kite.");
  assert.equal(bad.isBad, true);
});

test("a machine that cannot keep the pace says so", () => {
  assert.match(stateWords(simulation({ pace: { slipped_s: 12.4 } })).words, /too slow for that speed: 12 s behind/);
  assert.doesNotMatch(stateWords(simulation({ pace: { slipped_s: 1 } })).words, /too slow/);
});

test("one that waits, failed or ended says why; without one the panel says what it is for", () => {
  assert.equal(stateWords(simulation({ state: "wanted" })).words, "Waiting for a simulator.");
  assert.deepEqual(stateWords(simulation({ state: "failed", message: "Gone." })), { words: "Gone.", isBad: true });
  assert.equal(stateWords(null).isBad, false);
  assert.equal(isPresent(null), false);
});

test("faults are sent with their seconds, and a weak battery by the vehicle's own", () => {
  const sent = Object.fromEntries(FAULTS.map(({ name, of }) => [name, of(vehicle("Tern"), 20)]));
  assert.deepEqual(sent, { link: { link_lost_for_s: 20 }, gps: { gps_lost_for_s: 20 }, battery: { battery_wh_left: 12 }, motor: { motor_failed: 0 } });
});

test("wind goes round once", () => {
  assert.deepEqual(windOf(8, 360), { wind: [{ altitude_agl_m: 10, speed_mps: 8, from_deg: 0 }] });
});
