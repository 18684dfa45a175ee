import assert from "node:assert/strict";
import test from "node:test";
import { isAlike, merged, wordsOfChange } from "../../../static/js/mission/actions/merge.js";
import { createRunningJob } from "../../../static/js/mission/actions/running_job.js";
import { changedParts } from "../../../static/js/mission/actions/save_request.js";
import { bestWordsOf, qualityOf, wishWordsOf } from "../../../static/js/mission/plan/plan_quality.js";
import { planOf } from "../../../static/js/mission/plan/plan_results.js";
import { endingOf, isPlanInSight, placesOf, shownPlaces } from "../../../static/js/mission/plan/plan_view.js";
import {
  EMPTY,
  requestOf,
  sensorsKnown,
  targetOf,
  wishesOf,
  withWishes,
} from "../../../static/js/mission/selection.js";
import { placePills } from "../../../static/js/mission/strips/span_strip.js";
import { factsOfUav } from "../../../static/js/mission/uavs/fleet.js";

const plain = (text) => text.replaceAll("\u00a0", " ");
const flown = { geometry: {}, uav: "Heron", targets: [0, 1] };
const result = (more) => ({
  objective: "total",
  lower_bound_m: 50_000,
  lower_bound_s: null,
  gap: 0.03,
  is_proven: false,
  wish: null,
  routes: [flown],
  ...more,
});
const tower = (id) => targetOf({ id, kind: "tower", properties: { label: `${id}` }, centre: [10, 50] });
const heron = { id: 3, name: "Heron", position: [9, 49], max_range_m: null, cruise_speed_mps: 12, end_action: "hover" };
const picked = { ...EMPTY, targets: [tower(1), tower(2), tower(3)], uavs: [heron, { ...heron, id: 4, name: "Kite" }] };
const keys = picked.targets.map(({ key }) => key);
const lock = (uav, places) => ({ uav, targets: places.map((place) => keys[place]), at_start: false, at_end: false });

test("a proof is said in one word, also with something locked", () => {
  assert.equal(qualityOf(result({ is_proven: true, gap: 0 })).words, "Proven shortest.");
  assert.equal(qualityOf(result({ is_proven: true, gap: 0, objective: "makespan" })).words, "Proven soonest.");
  assert.equal(qualityOf(result({ is_proven: true, gap: 0, wish: {} })).words, "Proven shortest with what is locked.");
  assert.equal(qualityOf(result({ is_proven: true, gap: 0, objective: "time" })).words, "Proven least flying time.");
  assert.equal(
    qualityOf(result({ is_proven: true, gap: 0, objective: "energy", wish: {} })).words,
    "Proven least energy with what is locked.",
  );
});

test("the gap is what the plan is above the bound, in the unit of the objective", () => {
  const quality = qualityOf(result({ gap: 0.2 }));
  assert.equal(plain(quality.words), "Within 25.0 % of the best possible.");
  assert.equal(plain(quality.detail), "Lower bound: 50.0 km.");
  assert.equal(
    plain(qualityOf(result({ objective: "makespan", lower_bound_m: null, lower_bound_s: 3000 })).detail),
    "Lower bound: 50 min.",
  );
});

test("where zones come or go meanwhile, the gap is against the best plan without them", () => {
  const quality = qualityOf(result({ gap: 0.2, gap_of: "without_timed_zones" }));
  assert.equal(plain(quality.words), "Within 25.0 % of the best plan without temporary zones.");
  assert.equal(quality.detail, "");
  assert.equal(
    qualityOf(result({ gap: 0, gap_of: "without_timed_zones" })).words,
    "As good as the best plan without temporary zones.",
  );
  assert.match(
    qualityOf(result({ gap: 0.2, gap_of: "without_timed_zones", wish: {} })).words,
    /with the locked targets and without temporary zones/,
  );
  assert.equal(
    plain(qualityOf(result({ gap: 0.2, gap_of: "all_plans" })).words),
    "Within 25.0 % of the best possible.",
  );
});

test("a bound has the unit of what the plan is best at", () => {
  assert.equal(
    plain(qualityOf(result({ objective: "time", lower_bound_m: null, lower_bound_s: 3000 })).detail),
    "Lower bound: 50 min of flight.",
  );
  assert.equal(
    plain(qualityOf(result({ objective: "energy", lower_bound_m: null, lower_bound_wh: 812.4 })).detail),
    "Lower bound: 812 Wh.",
  );
});

test("nothing is said of a plan whose bound is not known, or that nobody flies", () => {
  assert.equal(qualityOf(result({ gap: null, is_proven: undefined })), null);
  assert.equal(qualityOf(result({ gap: 1 })), null);
  assert.equal(qualityOf(result({ routes: [{ geometry: null }] })), null);
});

test("where targets are left out, a proof is of plans that reach as many, and a bound that a search leaves is not told", () => {
  const missed = (reason) => ({ unassigned: [{ target: 1, reason, message: "" }] });
  assert.equal(
    qualityOf(result({ is_proven: true, gap: 0, objective: "makespan", ...missed("beyond_range") })).words,
    "Proven soonest of plans that reach as many targets.",
  );
  assert.equal(
    qualityOf(result({ is_proven: true, gap: 0, wish: {}, ...missed("most_targets") })).words,
    "Proven shortest with what is locked, of plans that reach as many targets.",
  );
  assert.equal(qualityOf(result({ gap: 0.8, ...missed("beyond_range") })), null);
  assert.equal(
    plain(qualityOf(result({ gap: 0.2, ...missed("inside_zone") })).words),
    "Within 25.0 % of the best possible.",
  );
});

test("what a wish costs is said with its share of the free plan", () => {
  const wish = { cost_m: 2300, cost_s: 120, free_total_m: 57_500, free_longest_s: 3000, left_out: 0 };
  assert.equal(plain(wishWordsOf({ objective: "total", wish })), "The change costs 2.3 km more (+4.0 %).");
  assert.equal(plain(wishWordsOf({ objective: "makespan", wish })), "The change costs 2 min more (+4.0 %).");
  assert.equal(wishWordsOf({ objective: "total", wish: { ...wish, cost_m: 0 } }), "The change costs nothing.");
  assert.equal(
    plain(wishWordsOf({ objective: "total", wish: { ...wish, cost_m: -2300 } })),
    "The change saves 2.3 km (−4.0 %): the search had not found it.",
  );
  assert.equal(
    wishWordsOf({ objective: "total", wish: { ...wish, cost_m: null, left_out: 2 } }),
    "The change leaves out 2 targets more.",
  );
  assert.equal(wishWordsOf({ objective: "total", wish: null }), "");
});

test("the best so far comes with its bound and gap", () => {
  assert.equal(
    plain(bestWordsOf({ unit: "m", value: 51_500, bound: 50_000, left_out: 0 })),
    "51.5 km so far, within 3.0 % of the best possible (50.0 km)",
  );
  assert.equal(
    plain(bestWordsOf({ unit: "m", value: 51_500, bound: 50_000, left_out: 1 })),
    "51.5 km so far, 1 target is not reached",
  );
  assert.equal(plain(bestWordsOf({ unit: "s", value: 3000, bound: null, left_out: 0 })), "50 min so far");
  assert.equal(bestWordsOf(null), "");
});

test("wishes go to the server only where there are some", () => {
  const [first, second] = requestOf(
    withWishes(picked, [keys[0]], { priority: "high", uav: "Kite", sensor: "LiDAR" }),
  ).targets;
  assert.deepEqual([first.priority, first.uav, first.sensor], ["high", "Kite", "LiDAR"]);
  assert.deepEqual(
    ["priority", "uav", "sensor"].filter((name) => name in second),
    [],
  );
  assert.deepEqual(wishesOf({ priority: null, uav: null, sensor: null }), {
    priority: "normal",
    uav: null,
    sensor: "",
  });
});

test("sensors are said as the mission has them, of UAVs of the fleet too", () => {
  const uavs = [
    { ...heron, sensors: ["LiDAR"], most_targets: 3 },
    { ...heron, id: null, sensors: ["Corona"] },
  ];
  const body = requestOf({ ...picked, uavs }).uavs;
  assert.deepEqual([body[0].sensors, body[0].most_targets, body[1].sensors], [["LiDAR"], 3, ["Corona"]]);
  assert.deepEqual(sensorsKnown({ ...picked, uavs }, [{ sensors: ["lidar"] }]), ["Corona", "LiDAR"]);
});

test("a UAV's row says how many targets it takes and that it lands at a base", () => {
  assert.match(
    factsOfUav({ max_range_m: null, end_action: "base", most_targets: 3 }, false),
    /^at most 3 targets · .* lands at the nearest base$/,
  );
  assert.equal(
    endingOf({ end_action: "base", base: "Depot West", letter: "A", targets: [] }),
    "lands at the base Depot West",
  );
  assert.equal(endingOf({ end_action: "base", base: null, letter: "A", targets: [] }), "lands at the nearest base");
});

test("locks are sent when they change, and again when the places in the list do", () => {
  const locked = { ...picked, locks: [lock("Kite", [1, 2])] };
  assert.deepEqual(Object.keys(changedParts(locked, picked)), ["locks"]);
  assert.deepEqual(changedParts(picked, locked), { locks: [] });
  const other = { ...locked, targets: [tower(9), ...locked.targets] };
  assert.deepEqual(changedParts(other, locked).locks[0].targets, [2, 3]);
  assert.deepEqual(changedParts(locked, locked), {});
});

test("two people's locks come together, and where both want the same target mine stands", () => {
  const at = (locks) => ({ name: "North", selection: { ...picked, locks } });
  const both = merged(at([]), at([lock("Kite", [0])]), at([lock("Heron", [2])]));
  assert.deepEqual(both.clashes, []);
  assert.deepEqual(both.selection.locks, [lock("Heron", [2]), lock("Kite", [0])]);
  const clash = merged(at([]), at([lock("Kite", [0, 1])]), at([lock("Heron", [1])]));
  assert.deepEqual([clash.selection.locks, clash.clashes], [[lock("Kite", [0, 1])], ["locks"]]);
  assert.deepEqual(merged(at([lock("Kite", [0])]), at([lock("Kite", [0])]), at([])).selection.locks, []);
  assert.deepEqual(wordsOfChange(at([]), at([lock("Kite", [0])])), ["locks changed"]);
  assert.ok(!isAlike(at([]), at([lock("Kite", [0])])));
});

test("one raises a priority and the other changes the task: a clash of that target alone", () => {
  const at = (targets) => ({ name: "North", selection: { ...picked, targets } });
  const high = withWishes(picked, [keys[0]], { priority: "high" }).targets;
  assert.deepEqual(merged(at(picked.targets), at(high), at(picked.targets)).selection.targets[0].priority, "high");
  assert.deepEqual(
    merged(at(picked.targets), at(high), at(withWishes(picked, [keys[0]], { priority: "low" }).targets)).clashes,
    ["targets"],
  );
});

test("what is only locked stays in sight of the plan, at the places that are wished", () => {
  const routes = [
    { uav: "Heron", targets: [0, 1], geometry: {} },
    { uav: "Kite", targets: [2], geometry: {} },
  ];
  const plan = planOf({ routes, unassigned: [] }, picked);
  const state = { plan, selection: { ...picked, locks: [{ ...lock("Kite", [0]), at_start: true }] } };
  assert.ok(isPlanInSight(state));
  assert.deepEqual(shownPlaces(state).places.get(keys[0]), { sequence: 1, letter: "B", number: 1 });
  assert.deepEqual(placesOf(plan).get(keys[0]), { sequence: 0, letter: "A", number: 1 });
  assert.ok(isPlanInSight({ plan, selection: withWishes(picked, keys, { priority: "high" }) }));
  assert.ok(!isPlanInSight({ plan, selection: { ...picked, objective: "total" } }));
});

test("a pill of several says when one of them is locked", () => {
  const pills = placePills(
    [
      { target: "a", x: 50 },
      { target: "b", x: 50.5, isLocked: true },
      { target: "c", x: 51 },
      { target: "d", x: 51.5 },
    ],
    10,
    60,
    70,
  );
  assert.ok(pills.some(({ members }) => members.length > 1 && members.some(({ isLocked }) => isLocked)));
});

test("the job of a mission is remembered for its user until it ends", () => {
  const kept = new Map();
  const storage = () => ({
    getItem: (key) => kept.get(key) ?? null,
    setItem: (key, value) => kept.set(key, value),
    removeItem: (key) => kept.delete(key),
  });
  const jobs = createRunningJob({ user: 7, storage });
  jobs.keep("m1", { job: "j1", selection: picked });
  assert.equal(jobs.read("m1").job, "j1");
  assert.equal(jobs.read("m2"), null);
  assert.equal(createRunningJob({ user: 8, storage }).read("m1"), null);
  jobs.drop("m1");
  assert.equal(jobs.read("m1"), null);
  const closed = createRunningJob({
    user: 7,
    storage: () => {
      throw new Error("closed");
    },
  });
  closed.keep("m1", { job: "j1", selection: picked });
  assert.equal(closed.read("m1"), null);
});
