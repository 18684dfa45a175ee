import assert from "node:assert/strict";
import test from "node:test";
import { isAlike, merged, wordsOfChange } from "../../../static/js/mission/actions/merge.js";
import { EMPTY, targetOf } from "../../../static/js/mission/selection.js";
import { tied } from "../../../static/js/mission/targets/locks.js";

const tower = (id, task = null) =>
  targetOf({ id, kind: "tower", properties: { label: String(id) }, centre: [10, 50], task });
const heron = {
  id: 3,
  name: "Heron",
  position: [9, 49],
  max_range_m: 80_000,
  cruise_speed_mps: 12,
  end_action: "hover",
};
const at = (name, targets, more = {}) => ({ name, selection: { ...EMPTY, targets, uavs: [heron], ...more } });
const keys = ({ selection }) => selection.targets.map(({ asset }) => asset);
const base = at("North", [tower(1), tower(2)]);

test("what each added and took away comes together", () => {
  const both = merged(base, at("North", [tower(2), tower(3)]), at("North, checked", [tower(1), tower(2), tower(4)]));
  assert.deepEqual(both.clashes, []);
  assert.equal(both.name, "North, checked");
  assert.deepEqual(keys(both), [2, 4, 3]);
});

test("with nothing of mine the result is theirs", () => {
  const theirs = at("South", [tower(4)], { return_to_start: false });
  const both = merged(base, base, theirs);
  assert.deepEqual({ name: both.name, selection: both.selection }, theirs);
});

test("what both changed differently is a clash, and mine stands", () => {
  const both = merged(base, at("Mine", base.selection.targets), at("Theirs", base.selection.targets));
  assert.deepEqual([both.name, both.clashes], ["Mine", ["name"]]);
  const moved = (lon) => at("North", base.selection.targets, { uavs: [{ ...heron, position: [lon, 49] }] });
  const uavs = merged(base, moved(8), moved(7));
  assert.deepEqual([uavs.selection.uavs[0].position[0], uavs.clashes], [8, ["uavs"]]);
});

test("the same change by both is none", () => {
  assert.deepEqual(merged(base, at("Both", [tower(1)]), at("Both", [tower(1)])).clashes, []);
});

test("a target that one took away and the other gave another task stays, as a clash", () => {
  const old = at("North", [tower(1, { kind: "look", hold_s: 5 })]);
  const both = merged(old, at("North", []), at("North", [tower(1, { kind: "hold", hold_s: 60 })]));
  assert.deepEqual([keys(both), both.clashes], [[1], ["targets"]]);
});

test("a task that the server wrote down is no change", () => {
  assert.ok(isAlike(at("North", [tower(1)]), at("North", [tower(1, { kind: "photo", hold_s: 10 })])));
  assert.ok(!isAlike(base, at("North", [tower(1)])));
  assert.ok(!isAlike(base, { ...base, name: "South" }));
});

test("an emptied name is not a name", () => {
  assert.deepEqual(merged(base, { ...base, name: " " }, at("South", base.selection.targets)).name, "South");
});

test("what somebody did is said in words", () => {
  assert.deepEqual(wordsOfChange(base, at("South", [tower(1), tower(5), tower(6)])), [
    "renamed to “South”",
    "2 targets added",
    "1 target removed",
  ]);
  assert.deepEqual(wordsOfChange(base, at("North", base.selection.targets, { objective: "total" })), [
    "options changed",
  ]);
});

const [first, second, third] = [1, 2, 3].map((id) => tower(id));
const kite = { ...heron, id: 4, name: "Kite" };
const run = (uav, targets, more = {}) => ({
  uav,
  targets: targets.map(({ key }) => key),
  at_start: false,
  at_end: false,
  ...more,
});
const locked = (locks, more = {}) => at("North", [first, second, third], { uavs: [heron, kite], locks, ...more });
const mergedLocks = (before, mine, theirs) => {
  const { selection, clashes } = merged(before, mine, theirs);
  return [selection.locks, clashes];
};

test("locks that no plan can keep together are a clash, and mine stand", () => {
  const none = locked([]);
  const [start, end] = [{ at_start: true }, { at_end: true }];
  for (const [mine, theirs] of [
    [run("Heron", [first], start), run("Heron", [second], start)],
    [run("Heron", [first], end), run("Heron", [second, third], end)],
    [run("Heron", [first, third], { ...start, ...end }), run("Heron", [second])],
    [run("Heron", [first]), run("Heron", [second, third], { ...start, ...end })],
    [run("Heron", [first, second]), run("Kite", [second, third])],
  ])
    assert.deepEqual(mergedLocks(none, locked([mine]), locked([theirs])), [[mine], ["locks"]]);
});

test("locks that go together come together", () => {
  const [mine, theirs] = [run("Heron", [first], { at_start: true }), run("Heron", [second], { at_end: true })];
  assert.deepEqual(mergedLocks(locked([]), locked([mine]), locked([theirs])), [[theirs, mine], []]);
  const kept = run("Kite", [third], { at_start: true, at_end: true });
  assert.deepEqual(mergedLocks(locked([kept]), locked([kept, mine]), locked([kept, theirs])), [
    [kept, theirs, mine],
    [],
  ]);
});

test("a lock of before that they alone changed is changed, and no clash", () => {
  const [before, longer] = [run("Heron", [first, second]), run("Heron", [first, second, third])];
  assert.deepEqual(mergedLocks(locked([before]), locked([before]), locked([longer])), [[longer], []]);
  assert.deepEqual(mergedLocks(locked([before]), locked([run("Heron", [second, first])]), locked([longer])), [
    [run("Heron", [second, first])],
    ["locks"],
  ]);
});

test("a tie of one against a lock of the other is a clash, and mine stands", () => {
  const none = locked([]);
  const isTied = { ...none, selection: tied(none.selection, [first.key], "Kite") };
  const isLocked = locked([run("Heron", [first, second])]);
  const tieIsMine = merged(none, isTied, isLocked);
  assert.deepEqual(
    [tieIsMine.selection.targets[0].uav, tieIsMine.selection.locks, tieIsMine.clashes],
    ["Kite", [], ["locks"]],
  );
  const lockIsMine = merged(none, isLocked, isTied);
  assert.deepEqual(
    [lockIsMine.selection.targets[0].uav, lockIsMine.selection.locks, lockIsMine.clashes],
    [null, isLocked.selection.locks, ["locks"]],
  );
  const toHeron = { ...none, selection: tied(none.selection, [first.key], "Heron") };
  assert.deepEqual(merged(none, toHeron, isLocked).clashes, []);
});
