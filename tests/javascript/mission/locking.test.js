import assert from "node:assert/strict";
import test from "node:test";

import { EMPTY, targetOf } from "../../../static/js/mission/selection.js";
import { createHistory, createStore } from "../../../static/js/store.js";

const element = () => ({
  summary: "",
  append(...children) {
    this.summary = children.map((child) => child.summary ?? child).join(" ");
  },
  replaceChildren(...children) {
    this.append(...children);
  },
  setAttribute() {},
  addEventListener() {},
});
const toasts = element();
globalThis.document = {
  cookie: "",
  querySelector: () => null,
  documentElement: { lang: "en", dataset: {} },
  createElement: element,
  getElementById: (id) => (id === "toasts" ? toasts : element()),
};
const { createFleetActions } = await import("../../../static/js/mission/actions/fleet_actions.js");
const { createLocking } = await import("../../../static/js/mission/actions/locking.js");

const tower = (id) => targetOf({ id, kind: "tower", properties: { label: `Tower ${id}` }, centre: [10, 50] });
const uav = (id, name) => ({ id, name, position: [9, 49] });
const targets = [1, 2, 3].map(tower);

/** A page with a plan: Heron flies towers 1 and 2, Kite tower 3. */
function pageWith(context, uavs, fleet = []) {
  context.mock.timers.enable({ apis: ["setTimeout"] });
  toasts.summary = "";
  const plan = {
    targets,
    result: {
      routes: [
        { uav: "Heron", targets: [0, 1] },
        { uav: "Kite", targets: [2] },
      ],
    },
  };
  const store = createStore({ selection: { ...EMPTY, targets, uavs }, plan, fleet });
  const history = createHistory(store, "selection");
  const how = { store, history, selection: () => store.state.selection, change: (next) => history.changeTo(next) };
  return { store, ...createLocking(how), ...createFleetActions(how) };
}

test("a target that is dropped on a UAV is told to be locked there", (context) => {
  const page = pageWith(context, [uav(1, "Heron"), uav(2, "Kite")]);
  assert.equal(page.placeTargets([targets[2].key], { uav: "Heron", index: 1 }), true);
  assert.match(toasts.summary, /Tower 3 is locked as target 2 of Heron\./);
});

test("where two UAVs have the name nothing is locked, and that is said", (context) => {
  const page = pageWith(context, [uav(1, "Heron"), uav(2, "Kite"), uav(null, "Heron")]);
  for (const act of [
    () => page.placeTargets([targets[2].key], { uav: "Heron", index: 1 }),
    () => page.lockTarget(targets[0].key),
    () => page.shiftTarget(targets[0].key, 1),
  ]) {
    toasts.summary = "";
    assert.equal(act(), false);
    assert.match(toasts.summary, /Nothing is locked: 2 UAVs of this mission are called Heron\./);
  }
  assert.deepEqual(page.store.state.selection.locks, []);
});

test("a UAV that is called otherwise in the mission is told so", (context) => {
  const page = pageWith(context, [uav(null, "Heron")], [uav(1, "Heron"), uav(2, "Kite")]);
  page.addUavOfFleet(2);
  assert.equal(toasts.summary, "");
  page.addUavsOfFleet([1, 2]);
  assert.deepEqual(
    page.store.state.selection.uavs.map(({ name }) => name),
    ["Heron", "Kite", "Heron 2"],
  );
  assert.match(toasts.summary, /Heron is called Heron 2 in this mission: another UAV has its name\./);
});

test("any UAV may fly a target that was locked, once that is chosen", (context) => {
  const page = pageWith(context, [uav(1, "Heron"), uav(2, "Kite")]);
  page.placeTargets([targets[2].key], { uav: "Heron", index: 0 });
  assert.equal(page.store.state.selection.locks.length, 1);
  assert.equal(page.tieTargets([targets[2].key], null), true);
  assert.deepEqual(page.store.state.selection.locks, []);
});
