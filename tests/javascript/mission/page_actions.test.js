import assert from "node:assert/strict";
import test from "node:test";

import {
  basisOf,
  EMPTY,
  targetOf,
  withoutTargets,
  withTargets,
  withWishes,
} from "../../../static/js/mission/selection.js";
import { createHistory, createStore } from "../../../static/js/store.js";

const spot = { replaceChildren() {}, textContent: "" };
globalThis.document ??= {
  cookie: "",
  querySelector: () => null,
  getElementById: () => spot,
  documentElement: { lang: "en", dataset: {} },
};
globalThis.location ??= { hash: "", pathname: "/", protocol: "http:", host: "here" };
globalThis.WebSocket = undefined; // jobs are asked for
const { createActions } = await import("../../../static/js/mission/actions/actions.js");
const { howFarWords } = await import("../../../static/js/mission/panels/foot.js");
const { isWorse } = await import("../../../static/js/mission/plan/compare.js");
const { planOf } = await import("../../../static/js/mission/plan/plan_results.js");
const { refusalOf } = await import("../../../static/js/mission/actions/refusals.js");
const { savedWords } = await import("../../../static/js/mission/panels/saved_state.js");

const tower = (id) => targetOf({ id, kind: "tower", properties: { label: `${id}` }, centre: [10, 50] });
const heron = {
  id: null,
  name: "Heron",
  position: [9, 49],
  max_range_m: null,
  cruise_speed_mps: 12,
  end_action: "hover",
};
const picked = { ...withTargets(EMPTY, [1, 2, 3].map(tower)), uavs: [heron] };
const planMade = (selection, more) => ({
  objective: selection.objective,
  return_to_start: true,
  total_length_m: 4000,
  longest_route_m: 4000,
  unassigned: [],
  warnings: [],
  routes: [{ uav: "Heron", targets: [0], length_m: 4000, duration_s: 400, geometry: {}, waypoints: [] }],
  ...more,
});
const json = (body, status = 200, headers = {}) => new Response(JSON.stringify(body), { status, headers });
const storedMission = (selection, more) => ({
  id: "m",
  name: "North",
  revision: 5,
  uavs: selection.uavs,
  targets: selection.targets.map(({ asset, kind, label }) => ({ asset, kind, label, position: [10, 50] })),
  objective: selection.objective,
  return_to_start: true,
  locks: [],
  plan: null,
  ...more,
});
const settle = async () => {
  for (let turn = 0; turn < 40; turn += 1) {
    await Promise.resolve();
    await new Promise(setImmediate);
  }
};

/** A page with the stored mission "m" open; serve({ method, path, body }): the answer to each request, all of which are kept in `asked`. */
function opened(context, serve, state = {}, drafts = { dropOwn() {}, keep: () => true, read: () => null }) {
  context.mock.timers.enable({ apis: ["setTimeout"] });
  const asked = [];
  context.mock.method(globalThis, "fetch", async (address, { method, body }) => {
    const request = { method, path: address.replace("/api/v1", ""), body: body ? JSON.parse(body) : null };
    asked.push(request);
    return serve(request, asked);
  });
  const store = createStore({
    selection: picked,
    name: "North",
    mission: { id: "m", name: "North", revision: 4 },
    stored: { name: "North", selection: picked },
    savedBasis: basisOf(picked),
    plan: null,
    planIsStored: false,
    figures: {},
    planning: null,
    planningBeside: null,
    saving: false,
    conflict: null,
    isAway: false,
    problem: null,
    fleet: [],
    lastPlan: null,
    shownPlan: null,
    why: null,
    chosenRoute: null,
    canUndo: false,
    canRedo: false,
    ...state,
  });
  const history = createHistory(store, "selection");
  const actions = createActions(store, history, { canPlan: true, userId: 1, userName: "opal" }, drafts);
  const tick = (ms) => {
    context.mock.timers.tick(ms);
    return settle();
  };
  return { store, history, actions, asked, tick };
}

const refusal = (message, more) => json({ error: { code: "invalid", message, ...more } }, 400);

test("why something is not planned is said until something else is picked, whatever is saved meanwhile", async (context) => {
  const { store, history, actions, asked, tick } = opened(context, ({ path, body }) =>
    path === "/plans" ? refusal("There is no base.") : json(storedMission({ ...picked, ...body })),
  );
  history.changeTo({ ...picked, objective: "total" });
  await actions.plan();
  assert.deepEqual([store.state.problem.title, store.state.problem.text], ["Not planned.", "There is no base."]);
  assert.equal(savedWords(store.state).words, "Not saved yet");
  await tick(2000);
  assert.equal(asked.at(-1).method, "PATCH");
  assert.equal(store.state.problem.text, "There is no base.");
  history.changeTo(withoutTargets(store.state.selection, [picked.targets[0].key]));
  assert.equal(store.state.problem, null);
});

test("what can neither be planned nor saved for the same reason is said once", async (context) => {
  const { store, history, actions, tick } = opened(context, () => refusal("There is no base."));
  history.changeTo({ ...picked, objective: "total" });
  await actions.plan();
  await tick(2000);
  assert.equal(store.state.problem.title, "Neither planned nor saved.");
  assert.equal(savedWords(store.state).words, "Not saved: see below");
});

test("a plan that is done after something else was picked says so", async (context) => {
  let answer;
  const { store, history, actions, asked } = opened(context, ({ path, body }) =>
    path === "/plans" ? new Promise((resolve) => (answer = resolve)) : json(storedMission({ ...picked, ...body })),
  );
  const underWay = actions.plan();
  history.changeTo(withoutTargets(picked, [picked.targets[0].key]));
  answer(json(planMade(picked)));
  await underWay;
  assert.deepEqual(
    [store.state.problem.title, store.state.problem.level],
    ["The selection has changed since.", "warning"],
  );
  assert.deepEqual(store.state.plan.targets, picked.targets);
  assert.equal(asked.filter(({ path }) => path === "/plans").length, 1); // the other way of planning it is of no use
  store.state.problem.actions[0].act();
  assert.deepEqual(asked.at(-1).body.targets, [{ asset: 2 }, { asset: 3 }]);
  assert.equal(store.state.problem, null);
});

const large = {
  ...withTargets(
    EMPTY,
    Array.from({ length: 14 }, (_, number) => tower(number + 1)),
  ),
  uavs: [heron],
};
const stateOfLarge = { selection: large, stored: { name: "North", selection: large }, savedBasis: basisOf(large) };
const jobDone = (id, selection) => json({ id, state: "done", result: planMade(selection) });

/** A server with as many open jobs of this person as `others` says; it begins jobs "j1", "j2" and so on, and ends only those of `ends`. */
function planner({ others = 0, ends = ["j1"], save }) {
  let jobs = 0;
  return ({ method, path, body }) => {
    if (path === "/plans") {
      jobs += 1;
      return json({ job: `j${jobs}` }, 202);
    }
    if (path.startsWith("/jobs?")) return json({ results: Array.from({ length: others }, () => ({})), next: null });
    if (path.endsWith("/cancel")) return json({});
    if (path.startsWith("/jobs/"))
      return ends.includes(path.slice(6))
        ? jobDone(path.slice(6), large)
        : json({ id: path.slice(6), state: "running", progress: 0.1 });
    return method === "PATCH" ? save(body) : json(storedMission(large));
  };
}

const storedWithPlan = () => json(storedMission(large, { plan: planMade(large) }));

test("the other way of a large plan is made once the plan is saved and nothing else runs", async (context) => {
  const { store, actions, asked, tick } = opened(context, planner({ save: storedWithPlan }), stateOfLarge);
  await actions.plan();
  assert.equal(asked.filter(({ path }) => path === "/plans").length, 1);
  await tick(2000);
  assert.deepEqual(
    asked
      .filter(({ method, path }) => method === "PATCH" || path === "/plans")
      .map(({ body }) => body.plan_of ?? body.objective),
    ["makespan", "j1", "total"],
  );
  assert.ok(store.state.planningBeside);
});

test("it is not made where another plan of this person's is waiting or running", async (context) => {
  const { store, actions, asked, tick } = opened(context, planner({ others: 1, save: storedWithPlan }), stateOfLarge);
  await actions.plan();
  await tick(2000);
  assert.equal(asked.filter(({ path }) => path === "/plans").length, 1);
  assert.equal(store.state.planningBeside, null);
});

test("it is stopped for a new plan that is asked for", async (context) => {
  const { actions, asked, tick } = opened(context, planner({ ends: ["j1", "j3"], save: storedWithPlan }), stateOfLarge);
  await actions.plan();
  await tick(2000);
  await actions.plan();
  assert.deepEqual(
    asked.filter(({ path }) => path === "/plans" || path.endsWith("/cancel")).map(({ path }) => path),
    ["/plans", "/plans", "/jobs/j2/cancel", "/plans"],
  );
});

test("a save for which the server has no room is tried again when the server says", async (context) => {
  const answers = [
    () =>
      json({ error: { code: "too_many_jobs", message: "4 of your jobs are waiting." } }, 429, { "Retry-After": "10" }),
    storedWithPlan,
  ];
  const { store, actions, asked, tick } = opened(context, planner({ save: () => answers.shift()() }), stateOfLarge);
  await actions.plan();
  await tick(2000);
  assert.deepEqual(
    [store.state.problem.title, store.state.problem.text],
    ["Not saved yet.", "4 of your jobs are waiting. Next try in 10 s."],
  );
  await tick(9000);
  assert.equal(asked.filter(({ method }) => method === "PATCH").length, 1);
  await tick(1000);
  assert.equal(asked.filter(({ method }) => method === "PATCH").length, 2);
  assert.deepEqual([store.state.problem, store.state.planIsStored], [null, true]);
});

test("a refusal is said without the places of fields, with what would help instead of another try", async (context) => {
  const locks = [
    { uav: "Heron", targets: picked.targets.slice(0, 2).map(({ key }) => key), at_start: false, at_end: false },
  ];
  const selection = { ...picked, uavs: [{ ...heron, most_targets: 1 }], locks };
  const words = "Heron may do 1 target at most, but 2 are locked to it.";
  const { store, actions } = opened(
    context,
    () => refusal(`uavs.0.most_targets: ${words}`, { details: { "uavs.0.most_targets": [words] } }),
    { selection },
  );
  await actions.plan();
  assert.equal(store.state.problem.text, words);
  const [raise, unlock] = store.state.problem.actions;
  assert.deepEqual([raise.label, unlock.label], ["Raise its limit to 2", "Unlock its targets"]);
  raise.act();
  assert.deepEqual([store.state.selection.uavs[0].most_targets, store.state.problem], [2, null]);
  unlock.act();
  assert.deepEqual(store.state.selection.locks, []);
});

test("a fault of a field names the UAV or the target that it is of", () => {
  const summary = (details) => refusalOf({ details }, picked)?.words;
  assert.equal(
    summary({ uavs: { 0: { max_range_m: ["Ensure this value is above 0."] } } }),
    "Heron: Ensure this value is above 0.",
  );
  assert.equal(summary({ "targets.1.asset": ["There is no such asset."] }), "2: There is no such asset.");
  assert.equal(
    summary({ "uavs.0.end_action": ["Heron is to land at a base, but there is none."] }),
    "Heron is to land at a base, but there is none.",
  );
  assert.equal(summary({ name: ["Too long."] }), "Too long.");
  assert.equal(summary(null), undefined);
});

test("a plan made anew that is worse than the one on the page does not take its place", async (context) => {
  const before = planMade(picked);
  const longer = planMade(picked, { routes: [{ ...before.routes[0], duration_s: 460 }] });
  const { store, actions } = opened(context, () => json(longer), {
    plan: { ...planOf(before, picked) },
    planIsStored: true,
    figures: { [basisOf(picked)]: before },
  });
  await actions.plan();
  assert.deepEqual([store.state.plan.result, store.state.planIsStored, store.state.planning], [before, true, null]);
});

test("a plan is worse where it reaches less, then where it is longer by what is asked for; on other ground it is another plan", () => {
  const plan = (more, selection = picked) => planOf(planMade(selection, more), selection);
  const missed = (...targets) => ({ unassigned: targets.map((target) => ({ target })) });
  assert.ok(isWorse(plan(missed(0, 1)), plan(missed(2))));
  const urgent = withWishes(picked, [picked.targets[0].key], { priority: "high" });
  assert.ok(isWorse(plan(missed(0), urgent), plan(missed(1, 2), urgent)));
  assert.ok(!isWorse(plan(missed(1)), plan(missed(2))));
  assert.ok(isWorse(plan({ total_length_m: 4100 }), plan({})));
  assert.ok(!isWorse(plan({ total_length_m: 4100, ground_revision: 8 }), plan({ ground_revision: 7 })));
  assert.ok(!isWorse(plan({ total_length_m: 4100, warnings: [{ code: "uav_out_of_service", uav: 0 }] }), plan({})));
});

test("a plan that no planner has taken yet is waiting, not at 0 %", async (context) => {
  const states = [
    { state: "queued", progress: 0 },
    { state: "running", progress: 0.4 },
  ];
  const { store, actions, tick } = opened(
    context,
    (request) =>
      request.path === "/jobs/j1" && states.length
        ? json({ id: "j1", message: "Planning 14 targets", ...states.shift() })
        : planner({ save: storedWithPlan })(request),
    stateOfLarge,
  );
  void actions.plan();
  await tick(0);
  assert.deepEqual([howFarWords(store.state.planning), store.state.planning.share], ["waiting", null]);
  await tick(1000);
  assert.equal(howFarWords(store.state.planning).replace("\u00a0", " "), "40 %");
  await tick(1000);
  assert.equal(store.state.planning, null);
});

test("a mission that is not stored keeps its comparison over a reload", async (context) => {
  let kept = null;
  document.createElement = () => ({ setAttribute() {}, addEventListener() {}, append() {} }); // of the toast
  const drafts = {
    dropOwn() {},
    keep: (_mission, draft) => {
      kept = JSON.parse(JSON.stringify(draft));
      return true;
    },
    read: () => kept,
  };
  const blank = { mission: null, stored: null, savedBasis: null, name: "" };
  const waypoints = [
    { kind: "start", position: [9, 49], along_m: 0 },
    { kind: "end", position: [9, 49], along_m: 4000 },
  ];
  const answer = ({ body }) => {
    const length_m = 1000 * body.targets.length;
    const route = { uav: "Heron", targets: [0], length_m, duration_s: 400, geometry: {}, waypoints };
    return json(planMade(picked, { total_length_m: length_m, routes: [route] }));
  };
  const first = opened(context, answer, blank, drafts);
  await first.actions.plan();
  first.history.changeTo(withoutTargets(picked, [picked.targets[0].key]));
  await first.actions.plan();
  assert.equal(first.store.state.lastPlan.total_length_m, 3000);
  first.actions.settleDraft();
  context.mock.timers.reset();
  context.mock.restoreAll();

  const again = opened(context, answer, { ...blank, selection: EMPTY }, drafts);
  again.actions.openDraft();
  assert.equal(again.store.state.lastPlan.total_length_m, 3000);
  again.history.changeTo(withoutTargets(again.store.state.selection, [picked.targets[1].key]));
  await again.actions.plan();
  assert.equal(again.store.state.plan.result.total_length_m, 1000);
  assert.equal(again.store.state.lastPlan.total_length_m, 2000);
});
