import assert from "node:assert/strict";
import { test } from "node:test";
import { isSmallChange, replanSmallChanges } from "../../../static/js/mission/actions/replanning.js";
import { differenceWords } from "../../../static/js/mission/plan/compare.js";
import { basisOf, EMPTY, targetOf } from "../../../static/js/mission/selection.js";
import { createHistory, createStore } from "../../../static/js/store.js";

const tower = (id) => targetOf({ id, kind: "tower", properties: { label: `T${id}` }, centre: [9, 50] });
const uav = (id, name) => ({
  id,
  name,
  position: [9, 50],
  max_range_m: 9000,
  cruise_speed_mps: 12,
  end_action: "hover",
});
const before = { ...EMPTY, targets: [tower(1), tower(2), tower(3)], uavs: [uav(1, "Heron"), uav(2, "Kite")] };
const { targets, uavs } = before;

test("another UAV, a removed target and another order are small changes", () => {
  assert.ok(isSmallChange(before, { ...before, uavs: [...uavs, uav(3, "Tern")] }));
  assert.ok(isSmallChange(before, { ...before, uavs: [uavs[1]] }));
  assert.ok(isSmallChange(before, { ...before, targets: targets.slice(1) }));
  const lock = { uav: "Heron", targets: [targets[0].key], at_start: true, at_end: false };
  assert.ok(isSmallChange(before, { ...before, locks: [lock] }));
});

test("other changes are planned on request", () => {
  assert.ok(!isSmallChange(before, { ...before, targets: [...targets, tower(4)] }));
  assert.ok(!isSmallChange(before, { ...before, objective: "total" }));
  assert.ok(!isSmallChange(before, { ...before, return_to_start: false }));
  assert.ok(!isSmallChange(before, { ...before, uavs: [{ ...uavs[0], position: [9, 51] }, uavs[1]] }));
  assert.ok(!isSmallChange(before, { ...before, targets: [] }));
  assert.ok(!isSmallChange(before, { ...before, uavs: [] }));
});

test("the difference is told in time, distance and what is not reached any more", () => {
  const plan = (duration_s, total_length_m, missed = 0) => ({
    routes: [{ duration_s, departs_s: 0 }],
    total_length_m,
    unassigned: Array.from({ length: missed }, () => ({})),
  });
  assert.equal(differenceWords(plan(600, 9_000), plan(780, 7_900)), "+3\u00a0min, −1.1\u00a0km");
  assert.equal(differenceWords(plan(600, 9_000), plan(600, 9_010)), "as long and as far as before");
  assert.equal(differenceWords(plan(600, 9_000), plan(600, 9_000, 1)), "1 more target is not reached");
});

/** A page with a plan of `before` whose small changes are planned again; the elements of its toasts are kept in `made`. */
function pageWith(context, state = {}) {
  context.mock.timers.enable({ apis: ["setTimeout"] });
  const made = [];
  const element = (tag) => ({
    tag,
    listeners: {},
    addEventListener(name, act) {
      this.listeners[name] = act;
    },
    append() {},
    replaceChildren() {},
    setAttribute() {},
  });
  globalThis.document = {
    createElement(tag) {
      made.push(element(tag));
      return made.at(-1);
    },
    getElementById: () => element("p"),
  };
  context.after(() => delete globalThis.document);
  const planOf = (selection, length_m) => ({
    basis: basisOf(selection),
    ...selection,
    result: { routes: [{ duration_s: 600, departs_s: 0 }], total_length_m: length_m, unassigned: [] },
  });
  const store = createStore({
    selection: before,
    plan: planOf(before, 9_000),
    planning: null,
    hand: null,
    isAway: false,
    conflict: null,
    restoredBasis: null,
    ...state,
  });
  const history = createHistory(store, "selection");
  let plans = 0;
  const plan = async () => {
    plans += 1;
    store.update({ plan: planOf(store.state.selection, 8_000) });
  };
  const parts = { store, history, page: { canPlan: true }, selection: () => store.state.selection };
  replanSmallChanges({ ...parts, change: history.changeTo }, plan);
  const rest = () => context.mock.timers.tick(400);
  const pressUndo = () => made.findLast(({ tag }) => tag === "button").listeners.click();
  return { store, history, rest, pressUndo, plans: () => plans };
}

test("Undo brings back what was planned before, also where several changes were planned at once", (context) => {
  const { store, history, rest, pressUndo } = pageWith(context);
  history.changeTo({ ...before, targets: targets.slice(1) });
  history.changeTo({ ...before, targets: targets.slice(2) });
  rest();
  pressUndo();
  assert.deepEqual(store.state.selection, before);
});

test("Undo after a later change takes back that change alone", (context) => {
  const { store, history, rest, pressUndo } = pageWith(context);
  const fewer = { ...before, targets: targets.slice(1) };
  history.changeTo(fewer);
  rest();
  history.changeTo({ ...fewer, objective: "total" });
  pressUndo();
  assert.deepEqual(store.state.selection, fewer);
});

test("nothing is planned again in a conflict, nor what was merged with another user's save", (context) => {
  const { store, history, rest, plans } = pageWith(context, { conflict: { whose: "vera's" } });
  const fewer = { ...before, targets: targets.slice(1) };
  history.changeTo(fewer);
  rest();
  assert.equal(plans(), 0);
  store.update({ restoredBasis: basisOf(fewer), conflict: null });
  rest();
  assert.equal(plans(), 0);
  history.changeTo({ ...fewer, uavs: uavs.slice(1) });
  rest();
  assert.equal(plans(), 1);
});

test("a change made while the server is away is planned once it is back", (context) => {
  const { store, history, rest, plans } = pageWith(context, { isAway: true });
  history.changeTo({ ...before, targets: targets.slice(1) });
  rest();
  assert.equal(plans(), 0);
  store.update({ isAway: false });
  rest();
  assert.equal(plans(), 1);
});
