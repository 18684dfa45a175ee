import assert from "node:assert/strict";
import test from "node:test";

import { EMPTY, targetOf, withTargets } from "../../../static/js/mission/selection.js";
import { createHistory, createStore } from "../../../static/js/store.js";

globalThis.document ??= { cookie: "", querySelector: () => null, documentElement: { lang: "en", dataset: {} } };
const { createSaving } = await import("../../../static/js/mission/actions/saving.js");

const tower = targetOf({ id: 7, kind: "tower", properties: { label: "18" }, centre: [10, 50] });

/** A page with mission "m" open, and what it has asked of the server: [{ method, body }]. answers: one function for each request. */
function opened(context, answers, { meet = async () => {} } = {}) {
  context.mock.timers.enable({ apis: ["setTimeout"] });
  const asked = [];
  context.mock.method(globalThis, "fetch", (_address, { method, body }) => {
    asked.push({ method, body: body ? JSON.parse(body) : null });
    return answers.shift()();
  });
  globalThis.location ??= { hash: "" };
  globalThis.history ??= { replaceState() {} };
  const store = createStore({
    selection: EMPTY,
    name: "North",
    mission: { id: "m", name: "North", revision: 4 },
    stored: { name: "North", selection: EMPTY },
    plan: null,
    planIsStored: false,
    savedBasis: "",
    fleet: [],
    figures: {},
    saving: false,
    planning: null,
    conflict: null,
    isAway: false,
    problem: null,
  });
  const history = createHistory(store, "selection");
  const saving = createSaving(
    {
      store,
      history,
      selection: () => store.state.selection,
      change: (value) => history.changeTo(value),
      problem() {},
      failed() {},
      running: {},
      page: { canPlan: true },
      drafts: { dropOwn() {}, keep: () => true },
    },
    { waitForJob() {}, makeRoom() {} },
    { meet },
  );
  return { store, history, saving, asked };
}

const away = () => Promise.reject(new TypeError("no network"));

test("a save that the server took, but whose answer was lost, is known as one's own when the next one is refused", async (context) => {
  const refusal = new Response(JSON.stringify({ error: { code: "mission_changed", message: "" } }), { status: 412 });
  const met = [];
  const { store, history, saving } = opened(context, [away, () => Promise.resolve(refusal)], {
    meet: async (lost) => void met.push(lost),
  });
  const sent = withTargets(EMPTY, [tower]);
  history.changeTo(sent);
  await saving.save();
  assert.deepEqual([store.state.isAway, met], [true, []]);
  await saving.save();
  assert.deepEqual(met, [{ selection: sent, name: "North" }]);
});

test("a copy made after a change was not answered holds the whole mission, not the change alone", async (context) => {
  const made = {
    id: "copy",
    name: "North (copy)",
    revision: 1,
    uavs: [],
    targets: [{ asset: 7, kind: "tower", label: "18", position: [10, 50] }],
    objective: "makespan",
    return_to_start: true,
    plan: null,
  };
  const stored = () =>
    Promise.resolve(
      new Response(JSON.stringify(made), { status: 201, headers: { "Content-Type": "application/json" } }),
    );
  const { store, history, saving, asked } = opened(context, [away, stored]);
  history.changeTo(withTargets(EMPTY, [tower]));
  await saving.save();
  store.update({ name: "North", conflict: null });
  await saving.keepMineAsCopy();
  assert.deepEqual(
    asked.map(({ method }) => method),
    ["PATCH", "POST"],
  );
  assert.equal(asked[1].body.name, "North (copy)");
  assert.deepEqual(asked[1].body.targets, [{ asset: 7 }]);
  assert.equal(asked[1].body.objective, "makespan");
  assert.equal(store.state.mission.id, "copy");
});

test("a save asked for while another is under way is made after it", async (context) => {
  let answer;
  const first = () => new Promise((resolve) => (answer = resolve));
  const mission = {
    id: "m",
    name: "North",
    revision: 5,
    uavs: [],
    targets: [],
    objective: "makespan",
    return_to_start: true,
    plan: null,
  };
  const { history, saving, asked } = opened(context, [
    first,
    () => Promise.resolve(new Response(JSON.stringify({ ...mission, id: "copy" }), { status: 201 })),
  ]);
  history.changeTo(withTargets(EMPTY, [tower]));
  const underWay = saving.save({ byItself: true });
  await saving.keepMineAsCopy();
  assert.equal(asked.length, 1);
  answer(new Response(JSON.stringify(mission), { status: 200 }));
  await underWay;
  assert.deepEqual(
    asked.map(({ method }) => method),
    ["PATCH", "POST"],
  );
});
