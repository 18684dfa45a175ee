import assert from "node:assert/strict";
import test from "node:test";
import {
  EMPTY,
  requestOf,
  selectionOf,
  targetOf,
  withoutLocks,
  withoutTargets,
} from "../../../static/js/mission/selection.js";
import {
  areContrary,
  lockedHere,
  lockOf,
  ordersOf,
  placed,
  settled,
  shifted,
  stopsWished,
  tied,
  unlocked,
  wishedOrders,
  wishedPlace,
} from "../../../static/js/mission/targets/locks.js";
import { withoutUavAt } from "../../../static/js/mission/uavs/mission_uavs.js";

const tower = (id) => ({
  ...targetOf({ id, kind: "tower", properties: { label: `${id}` }, centre: [10, 50] }),
  key: `${id}`,
});
const uav = (name) => ({ id: null, name, position: [9, 49] });
const picked = { ...EMPTY, targets: [1, 2, 3, 4, 5, 6].map(tower), uavs: [uav("Heron"), uav("Kite")] };
const ORDERS = [
  { uav: "Heron", targets: ["1", "2", "3"] },
  { uav: "Kite", targets: ["4", "5", "6"] },
];
const run = (name, targets, more = {}) => ({ uav: name, targets, at_start: false, at_end: false, ...more });
const orders = (selection) =>
  Object.fromEntries(wishedOrders(ORDERS, selection.locks).map(({ uav: name, targets }) => [name, targets.join("")]));

test("a target that is dropped between two others is locked between them", () => {
  const next = placed(picked, ORDERS, ["2"], { uav: "Kite", index: 1 });
  assert.deepEqual(next.locks, [run("Kite", ["4", "2", "5"])]);
  assert.deepEqual(orders(next), { Heron: "13", Kite: "4256" });
});

test("what is dropped first or last is locked at that end, and binds no neighbour", () => {
  assert.deepEqual(placed(picked, ORDERS, ["2"], { uav: "Kite", index: 0 }).locks, [
    run("Kite", ["2"], { at_start: true }),
  ]);
  assert.deepEqual(placed(picked, ORDERS, ["2"], { uav: "Kite", index: 3 }).locks, [
    run("Kite", ["2"], { at_end: true }),
  ]);
});

test("what comes before a locked beginning joins it", () => {
  const first = placed(picked, ORDERS, ["2"], { uav: "Kite", index: 0 });
  const second = placed(first, ORDERS, ["3"], { uav: "Kite", index: 0 });
  assert.deepEqual(second.locks, [run("Kite", ["3", "2"], { at_start: true })]);
  assert.deepEqual(orders(second), { Heron: "1", Kite: "32456" });
});

test("a target dropped into a run becomes a part of it", () => {
  const first = placed(picked, ORDERS, ["2"], { uav: "Kite", index: 1 });
  const second = placed(first, ORDERS, ["3"], { uav: "Kite", index: 2 });
  assert.deepEqual(second.locks, [run("Kite", ["4", "2", "3", "5"])]);
});

test("a UAV that flies nothing else takes a target at no place", () => {
  assert.deepEqual(placed(picked, [ORDERS[0], { uav: "Kite", targets: [] }], ["2"], { uav: "Kite", index: 0 }).locks, [
    run("Kite", ["2"]),
  ]);
});

test("a target that leaves a run leaves the others together, and one alone free", () => {
  const three = { ...picked, locks: [run("Heron", ["1", "2", "3"])] };
  assert.deepEqual(placed(three, ORDERS, ["2"], { uav: "Kite", index: 0 }).locks, [
    run("Heron", ["1", "3"]),
    run("Kite", ["2"], { at_start: true }),
  ]);
  assert.deepEqual(
    placed({ ...picked, locks: [run("Heron", ["1", "2"])] }, ORDERS, ["2"], { uav: "Kite", index: 0 }).locks,
    [run("Kite", ["2"], { at_start: true })],
  );
});

test("earlier and later go one place, and no further than the ends", () => {
  assert.deepEqual(orders(shifted(picked, ORDERS, "2", 1)), { Heron: "132", Kite: "456" });
  assert.deepEqual(orders(shifted(picked, ORDERS, "2", -1)), { Heron: "213", Kite: "456" });
  assert.equal(shifted(picked, ORDERS, "1", -1), picked);
  assert.equal(shifted(picked, ORDERS, "3", 1), picked);
});

test("several pills move together in their order", () => {
  assert.deepEqual(orders(placed(picked, ORDERS, ["2", "3"], { uav: "Kite", index: 1 })), {
    Heron: "1",
    Kite: "42356",
  });
});

test("locked here stays where it is", () => {
  assert.deepEqual(lockedHere(picked, ORDERS, "5").locks, [run("Kite", ["4", "5", "6"])]);
  assert.deepEqual(orders(lockedHere(picked, ORDERS, "6")), { Heron: "123", Kite: "456" });
  assert.deepEqual(wishedPlace(ORDERS, picked, "6"), { uav: "Kite", index: 2, last: 2 });
});

test("a target that the plan does not visit can be given to a UAV, and has no place to lock", () => {
  const short = [{ uav: "Heron", targets: ["1"] }];
  assert.equal(lockedHere(picked, short, "5"), picked);
  assert.equal(shifted(picked, short, "5", 1), picked);
  assert.equal(tied(picked, ["5"], "Kite").targets[4].uav, "Kite");
  assert.deepEqual(wishedOrders(short, [run("Kite", ["5"])]), [
    { uav: "Heron", targets: ["1"] },
    { uav: "Kite", targets: ["5"] },
  ]);
});

test("unlocking takes a run apart, and nothing is left of a lone neighbour", () => {
  const long = { ...picked, locks: [run("Heron", ["1", "2", "3", "4", "5"], { at_start: true, at_end: true })] };
  assert.deepEqual(unlocked(long, "3").locks, [
    run("Heron", ["1", "2"], { at_start: true }),
    run("Heron", ["4", "5"], { at_end: true }),
  ]);
  assert.deepEqual(unlocked({ ...picked, locks: [run("Heron", ["1", "2", "3"])] }, "2").locks, []);
  assert.deepEqual(withoutLocks(long).locks, []);
});

test("a target that is removed leaves its run, and the rest stays a run", () => {
  const locked = { ...picked, locks: [run("Kite", ["4", "2", "5"])] };
  assert.deepEqual(settled(withoutTargets(locked, ["2"])).locks, [run("Kite", ["4", "5"])]);
  assert.deepEqual(settled(withoutTargets(locked, ["2", "4"])).locks, []);
});

test("a UAV that is removed takes its locks and ties along", () => {
  const locked = tied({ ...picked, locks: [run("Kite", ["4", "5"]), run("Heron", ["1"])] }, ["6"], "Kite");
  const left = settled(withoutUavAt(locked, 1));
  assert.deepEqual(left.locks, [run("Heron", ["1"])]);
  assert.equal(left.targets[5].uav, null);
  assert.equal(settled(picked), picked);
});

test("the younger of a lock and a tie stands", () => {
  const there = { uav: "Kite", index: 1 };
  const locked = tied(placed(picked, ORDERS, ["2"], there), ["2"], "Heron");
  assert.equal(lockOf(locked, "2"), null);
  const given = placed(locked, ORDERS, ["2"], there);
  assert.equal(given.targets[1].uav, null);
  assert.equal(tied(given, ["2"], "Kite").locks.length, 1);
});

test("locks go to the server as indices and come back as keys", () => {
  const locked = placed(picked, ORDERS, ["2"], { uav: "Kite", index: 1 });
  assert.deepEqual(requestOf(locked).locks, [run("Kite", [3, 1, 4])]);
  assert.equal("locks" in requestOf(withoutLocks(locked)), false);
  const stored = selectionOf({
    targets: picked.targets.map((target) => ({ ...target, position: [10, 50], is_point: false })),
    uavs: picked.uavs,
    objective: "total",
    return_to_start: true,
    locks: requestOf(locked).locks,
  });
  assert.deepEqual(requestOf(stored).locks, [run("Kite", [3, 1, 4])]);
});

test("a plan's orders have each target once", () => {
  const plan = {
    targets: picked.targets,
    result: {
      routes: [
        { uav: "Heron", targets: [0, 0, 2] },
        { uav: "Kite", targets: [] },
      ],
    },
  };
  assert.deepEqual(ordersOf(plan), [
    { uav: "Heron", targets: ["1", "3"] },
    { uav: "Kite", targets: [] },
  ]);
  assert.deepEqual(ordersOf(null), []);
});

test("on the strip what moves stands between its neighbours, and the rest stays", () => {
  const stops = [
    { target: "1", at: 100 },
    { target: "2", at: 200 },
    { target: "3", at: 300 },
  ];
  assert.deepEqual(
    stopsWished(stops, ["1", "3", "2"], 400)
      .map(({ target, at, isMoved }) => [target, at, isMoved])
      .filter(([, , isMoved]) => isMoved).length,
    1,
  );
  assert.deepEqual(
    stopsWished(stops, ["1", "9", "8", "2", "3"], 400).map(({ at }) => Math.round(at)),
    [100, 133, 167, 200, 300],
  );
  assert.deepEqual(
    stopsWished(stops, ["1", "2"], 400).map(({ isMoved }) => isMoved),
    [false, false],
  );
  assert.deepEqual(stopsWished([], ["7"], 0), [{ target: "7", at: 0, isMoved: true }]);
});

test("a run that is all that a UAV flies takes in a target that is placed there, and stands beside another UAV's", () => {
  const whole = { ...picked, locks: [run("Heron", ["1", "2", "3"], { at_start: true, at_end: true })] };
  const ends = { at_start: true, at_end: true };
  const at = (key, place) => placed(whole, ORDERS, [key], place).locks;
  assert.deepEqual(at("1", { uav: "Heron", index: 2 }), [run("Heron", ["2", "3", "1"], ends)]);
  assert.deepEqual(at("5", { uav: "Heron", index: 3 }), [run("Heron", ["1", "2", "3", "5"], ends)]);
  assert.deepEqual(at("5", { uav: "Kite", index: 0 }), [...whole.locks, run("Kite", ["5"], { at_start: true })]);
});

test("a neighbour that is tied to another UAV, or picked no more, is not locked along", () => {
  const free = placed(tied(picked, ["2"], "Kite"), ORDERS, ["5"], { uav: "Heron", index: 2 });
  assert.deepEqual(free.locks, [run("Heron", ["1", "5", "3"])]);
  assert.equal(free.targets[1].uav, "Kite");
  assert.deepEqual(
    settled(placed(withoutTargets(picked, ["1", "2"]), ORDERS, ["5"], { uav: "Heron", index: 2 })).locks,
    [run("Heron", ["5"], { at_start: true })],
  );
});

test("where two UAVs have the name nothing is locked to it, and what was stays until one of them goes", () => {
  const locked = { ...tied(picked, ["2"], "Heron"), locks: [run("Heron", ["1"])] };
  const two = settled({ ...locked, uavs: [...locked.uavs, uav("Heron")] });
  assert.deepEqual([two.locks, two.targets[1].uav], [[run("Heron", ["1"])], "Heron"]);
  assert.equal(placed(two, ORDERS, ["5"], { uav: "Heron", index: 1 }), two);
  assert.deepEqual(settled(withoutUavAt(two, 2)).locks, [run("Heron", ["1"])]);
});

test("of two UAVs with one name each keeps its own order", () => {
  const two = [
    { uav: "Heron", targets: ["1", "2"] },
    { uav: "Heron", targets: ["3"] },
  ];
  assert.deepEqual(wishedOrders(two, []), two);
  assert.deepEqual(wishedOrders(two, [run("Kite", ["2"])]), [
    { uav: "Heron", targets: ["1"] },
    two[1],
    { uav: "Kite", targets: ["2"] },
  ]);
});

/** What the server would refuse of a selection's locks: planning/assignment/options.py. */
function contradictionIn({ targets, uavs, locks }) {
  const known = new Map(targets.map((target) => [target.key, target]));
  for (const [index, lock] of locks.entries()) {
    if (!uavs.some(({ name }) => name === lock.uav)) return "an unknown UAV";
    if (!lock.targets.length || new Set(lock.targets).size < lock.targets.length)
      return "a target twice in a run, or none";
    if (lock.targets.some((key) => !known.has(key))) return "an unknown target";
    if (lock.targets.some((key) => ![undefined, null, lock.uav].includes(known.get(key).uav)))
      return "a tie against a lock";
    for (const other of locks.slice(0, index)) {
      if (other.targets.some((key) => lock.targets.includes(key))) return "a target in two runs";
      if (other.uav !== lock.uav) continue;
      if ((other.at_start && lock.at_start) || (other.at_end && lock.at_end)) return "two runs at one end";
      if ([lock, other].some(({ at_start, at_end }) => at_start && at_end)) return "another run beside a whole route";
      if (areContrary(lock, other)) return "not contrary, yet called so";
    }
  }
  return null;
}

test("whatever is wished one after the other, no lock contradicts another or a tie", () => {
  let seed = 5;
  const below = (most) => {
    seed = (seed * 1_103_515_245 + 12_345) % 2_147_483_648;
    return Math.floor((seed / 2_147_483_648) * most);
  };
  const name = () => ["Heron", "Kite"][below(2)];
  const key = () => `${1 + below(6)}`;
  const isPicked = (selection, one) => selection.targets.some((target) => target.key === one);
  const whole = [
    ["Heron", "123"],
    ["Kite", "456"],
  ].map(([uavName, keys]) => run(uavName, [...keys], { at_start: true, at_end: true }));
  const steps = {
    placed: (now, one) => placed(now, ORDERS, [one], { uav: name(), index: below(8) }),
    several: (now, one) =>
      placed(
        now,
        ORDERS,
        [one, key()].filter((each, at, all) => isPicked(now, each) && all.indexOf(each) === at),
        { uav: name(), index: below(8) },
      ),
    shifted: (now, one) => shifted(now, ORDERS, one, below(2) ? 1 : -1),
    lockedHere: (now, one) => lockedHere(now, ORDERS, one),
    unlocked: (now, one) => unlocked(now, one),
    tied: (now, one) => tied(now, [one], below(3) ? name() : null),
    removed: (now, one) => (below(4) ? now : withoutTargets(now, [one])),
  };
  for (let sequence = 0; sequence < 500; sequence += 1) {
    let now = sequence % 2 ? { ...picked, locks: whole } : picked;
    const walked = [];
    for (let step = 0; step < 12; step += 1) {
      const what = Object.keys(steps)[below(Object.keys(steps).length)];
      const one = key();
      if (!isPicked(now, one)) continue;
      now = settled(steps[what](now, one));
      walked.push(`${what} ${one}: ${JSON.stringify(now.locks)}`);
      assert.equal(contradictionIn(now), null, walked.join("\n"));
    }
  }
});
