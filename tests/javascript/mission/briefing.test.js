/** What stands in the briefing before approval, and when it wants a reason. */

import assert from "node:assert/strict";
import { test } from "node:test";
import { briefingOf, needsReason, rehearsalOfPlan } from "../../../static/js/mission/flying/briefing.js";

const run = (words, level) => ({ words, level });
const rehearsal = (level, more = {}) => ({
  state: "done",
  is_outdated: false,
  level,
  runs: [run("Calm", level)],
  ...more,
});
const aircraft = { uavs: [{ is_simulated: false }, { is_simulated: true }], simulates: null };
const simulated = { uavs: [{ is_simulated: true }], simulates: null };
const route = (uav, more = {}) => ({
  uav,
  geometry: {},
  departs_s: 0,
  duration_s: 600,
  arrival_s: [0, 600],
  battery_left_percent: [100, 45],
  waypoints: [{ altitude_agl_m: 60 }],
  ...more,
});

test("only the newest finished rehearsal of the present plan counts", () => {
  const failed = rehearsal("fail");
  assert.equal(
    rehearsalOfPlan([rehearsal("", { state: "running" }), rehearsal("pass", { is_outdated: true }), failed]),
    failed,
  );
  assert.equal(rehearsalOfPlan([]), null);
});

test("a reason is wanted against a failed rehearsal, and for aircraft without one", () => {
  assert.equal(needsReason(aircraft, [rehearsal("pass")]), false);
  assert.equal(needsReason(aircraft, [rehearsal("warnings")]), false);
  assert.equal(needsReason(simulated, [rehearsal("fail")]), true);
  assert.equal(needsReason(aircraft, []), true);
  assert.equal(needsReason(aircraft, [rehearsal("pass", { is_outdated: true })]), true);
  assert.equal(needsReason(simulated, []), false);
  assert.equal(needsReason({ ...aircraft, simulates: "another mission" }, []), false);
});

test("the rehearsal stands first, the worst figures of all routes follow", () => {
  const plan = {
    departs_at: null,
    total_length_m: 4200,
    unassigned: [{}, {}],
    routes: [
      route("Kite"),
      route("Tern", { departs_s: 180, battery_left_percent: [100, 7], waypoints: [{ altitude_agl_m: 95 }] }),
      { geometry: null },
    ],
  };
  const facts = briefingOf({ plan }, [rehearsal("fail")]);
  assert.deepEqual(facts[0], { term: "Rehearsal", words: "Fail: Calm", isBad: true });
  const words = Object.fromEntries(facts.map((fact) => [fact.term, fact.words]));
  assert.equal(words.Departure, "Any time");
  assert.match(words["Total duration"], /^13\smin$/);
  assert.match(words["Later take-offs"], /^Tern \+3/);
  assert.match(words["Highest point"], /^95\sm above ground$/);
  assert.match(words["Lowest battery"], /^7\s?% \(Tern\)$/);
  assert.equal(words["Not planned"], "2 targets");
});

test("a plan that was never rehearsed says so, and one that has changed since", () => {
  assert.equal(briefingOf({ plan: null }, [])[0].words, "Not rehearsed");
  assert.equal(
    briefingOf({ plan: null }, [rehearsal("pass", { is_outdated: true })])[0].words,
    "None of this plan: it has changed since",
  );
});

test("the nearest zone stands with its name and metres, and nothing where it could not be read", () => {
  const plan = { departs_at: null, total_length_m: 1, unassigned: [], routes: [route("Kite")] };
  const zoneOf = (nearest) => briefingOf({ plan }, [], nearest).find(({ term }) => term === "Nearest zone")?.words;
  assert.equal(zoneOf({ id: 1, name: "Elmsgard Heliport", metres: 152.3 }), "Elmsgard Heliport, 152\u00a0m");
  assert.equal(zoneOf(null), "None within 5 km");
  assert.equal(zoneOf(undefined), undefined);
});
