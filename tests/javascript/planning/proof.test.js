/** The proof of a stored plan in the background: when it begins, what it says, when it ends. */

import assert from "node:assert/strict";
import test from "node:test";
import { EMPTY, targetOf } from "../../../static/js/mission/selection.js";
import { createStore } from "../../../static/js/store.js";

const spot = { replaceChildren() {}, textContent: "" };
globalThis.document ??= {
  cookie: "",
  querySelector: () => null,
  getElementById: () => spot,
  documentElement: { lang: "en", dataset: {} },
};
globalThis.location ??= { hash: "", pathname: "/", protocol: "http:", host: "here" };
globalThis.WebSocket = undefined; // jobs are asked for
const { canBeProven, createProof } = await import("../../../static/js/mission/actions/proof.js");
const { improvementWords } = await import("../../../static/js/mission/plan/compare.js");
const { planOf } = await import("../../../static/js/mission/plan/plan_results.js");

const tower = (id) => targetOf({ id, kind: "tower", properties: { label: `T${id}` }, centre: [9, 50] });
const selection = { ...EMPTY, targets: Array.from({ length: 14 }, (_, number) => tower(number + 1)) };
const result = (total_length_m, more = {}) => ({
  objective: "total",
  total_length_m,
  unassigned: [],
  warnings: [],
  gap: 0.1,
  is_proven: false,
  method: "ruin and recreate",
  routes: [{ uav: "Tern", geometry: {}, length_m: total_length_m, duration_s: 600, departs_s: 0, waypoints: [] }],
  ...more,
});
const stored = { id: "m", state: "planned", planned_at: "2026-11-30T12:00:00Z" };
const json = (body, status = 200) => new Response(JSON.stringify(body), { status });
const settle = async () => {
  for (let turn = 0; turn < 40; turn += 1) await new Promise(setImmediate);
};

/** A page with the plan of a mission; serve({ method, path }) is the answer to each request. */
function opened(context, serve, more = {}) {
  const asked = [];
  context.mock.method(globalThis, "fetch", async (address, { method }) => {
    asked.push(`${method} ${address.replace("/api/v1", "")}`);
    return serve(asked.at(-1));
  });
  const plan = planOf(result(40_000, more), selection);
  const store = createStore({
    plan,
    planIsStored: true,
    mission: { ...stored, plan: plan.result },
    selection,
    figures: { [plan.basis]: plan.result },
    planning: null,
    saving: false,
    hand: null,
    proof: null,
  });
  const shown = [];
  const actions = createProof({ store, page: { canPlan: true } }, (made) => shown.push(made.result));
  return { store, actions, asked, shown };
}

const serving = (job, known) => (request) =>
  request.endsWith("/proof")
    ? json({ job: "j" }, 202)
    : request.includes("/jobs/")
      ? json(job)
      : json({ ...stored, plan: known });

test("the better bound becomes that of the plan on the page", async (context) => {
  const known = result(40_000, { gap: 0, is_proven: true, lower_bound_m: 40_000, proof: "j" });
  const { store, asked } = opened(context, serving({ id: "j", state: "done", result: known }, known));
  await settle();
  assert.deepEqual(asked, ["POST /missions/m/proof", "GET /jobs/j", "GET /missions/m"]);
  assert.deepEqual([store.state.plan.result.is_proven, store.state.plan.result.gap], [true, 0]);
  assert.equal(store.state.plan.result, store.state.mission.plan);
  assert.deepEqual([store.state.proof.isOver, store.state.proof.better], [true, null]);
});

test("a better plan is offered, and shown with its job when it is chosen", async (context) => {
  const better = result(38_000, { method: "CP-SAT" });
  const { store, actions, shown } = opened(
    context,
    serving({ id: "j", state: "done", result: better }, result(40_000)),
  );
  await settle();
  assert.match(store.state.proof.words, /2\.0\skm/);
  actions.showBetterPlan();
  assert.deepEqual([shown[0].total_length_m, shown[0].job, store.state.proof.better], [38_000, "j", null]);
});

test("one that is better by metres alone is not offered", async (context) => {
  const better = result(39_980);
  const { store } = opened(context, serving({ id: "j", state: "done", result: better }, result(40_000)));
  await settle();
  assert.equal(store.state.proof.better, null);
});

test("by energy and by flying time their own figures decide", async (context) => {
  const before = result(40_000, { objective: "energy", total_energy_wh: 300, total_duration_s: 900 });
  const found = { ...before, total_energy_wh: 270, total_length_m: 41_000, method: "CP-SAT" };
  assert.equal(improvementWords(before, found).replaceAll("\u00a0", " "), "−30 Wh, +1.0 km");
  assert.equal(improvementWords(before, { ...before, total_energy_wh: 299.5 }), "");
  const slow = { ...before, objective: "time" };
  assert.match(improvementWords(slow, { ...slow, total_duration_s: 600 }), /^−5\smin of flight$/);
  context.mock.restoreAll();
});

test("a job that is cancelled tells nothing of better plans", async (context) => {
  const { store } = opened(context, serving({ id: "j", state: "cancelled", result: null }, result(40_000)));
  await settle();
  assert.deepEqual([store.state.proof.isOver, store.state.proof.isFinished], [true, false]);
});

test("a refusal leaves the plan as it is", async (context) => {
  const refused = json({ error: { code: "nothing_to_prove", message: "" } }, 409);
  const { store } = opened(context, () => refused);
  await settle();
  assert.deepEqual([store.state.proof.isOver, store.state.plan.result.gap], [true, 0.1]);
});

test("the job of a plan that is replaced ends, that of another mission goes on", async (context) => {
  const running = (request) =>
    request.endsWith("/proof") ? json({ job: "j" }, 202) : json({ id: "j", state: "running" });
  for (const [mission, ends] of [
    [{ ...stored, planned_at: "2026-11-30T12:05:00Z" }, true],
    [{ ...stored, id: "n", planned_at: "2026-11-30T11:00:00Z" }, false],
  ]) {
    const { store, asked } = opened(context, running);
    await settle();
    store.update({ mission, planIsStored: false });
    await settle();
    assert.equal(asked.includes("POST /jobs/j/cancel"), ends);
    assert.equal(store.state.proof, null);
    context.mock.restoreAll();
  }
});

test("only a stored plan of a search is proven", () => {
  const plan = planOf(result(40_000), selection);
  const state = { plan, planIsStored: true, mission: stored, planning: null, saving: false, hand: null, selection };
  assert.ok(canBeProven(state));
  for (const change of [
    { planIsStored: false },
    { saving: true },
    { mission: { ...stored, state: "approved" } },
    { selection: { ...selection, return_to_start: !selection.return_to_start } },
    { plan: planOf(result(40_000, { is_proven: true }), selection) },
    { plan: planOf(result(40_000, { method: "by hand" }), selection) },
  ])
    assert.ok(!canBeProven({ ...state, ...change }));
  const many = { ...selection, targets: Array.from({ length: 41 }, (_, number) => tower(number + 1)) };
  assert.ok(!canBeProven({ ...state, selection: many, plan: planOf(result(40_000), many) }));
});
