import assert from "node:assert/strict";
import test from "node:test";

import { createStore } from "../../../static/js/store.js";

globalThis.document ??= { cookie: "", querySelector: () => null, documentElement: { lang: "en", dataset: {} } };
globalThis.document.addEventListener ??= () => {};
globalThis.addEventListener ??= () => {};
const { watchMission } = await import("../../../static/js/mission/actions/together.js");

const json = (body, status = 200) => new Response(status === 304 ? null : JSON.stringify(body), { status });
const settle = async () => {
  for (let turn = 0; turn < 20; turn += 1) await new Promise(setImmediate);
};

test("a page that plans says so at once, goes on being seen meanwhile, and reads nothing of others", async (context) => {
  context.mock.timers.enable({ apis: ["setInterval", "Date"], now: Date.UTC(2026, 10, 24) });
  const asked = [];
  context.mock.method(globalThis, "fetch", async (_address, { method, body }) => {
    const { planning } = body ? JSON.parse(body) : {};
    asked.push({ method, planning });
    const others = [{ name: "opal", is_me: true, is_planning: true }];
    return method === "POST" ? json({ others, ground_revision: planning ? 7 : 3, uav_changes: [] }) : json(null, 304);
  });
  const store = createStore({ mission: null, saving: false, planning: null, isAway: false, others: [], fleet: [] });
  watchMission(store, {
    editor: "one",
    readFleet: async () => [],
    take: async () => {},
    connectedAgain() {},
    showDeleted() {},
  });
  const summary = () => asked.filter(({ method }) => method === "POST").map(({ planning }) => planning);
  const pass = async (ms) => {
    context.mock.timers.tick(ms);
    await settle();
  };

  store.update({ mission: { id: "m", revision: 4, plan: { ground_revision: 3 }, uav_changes: [] } });
  await pass(3000);
  assert.deepEqual(summary(), [false]);
  asked.length = 0;
  store.update({ planning: { what: "Planning" } });
  await settle();
  assert.deepEqual(summary(), [true]);
  for (let look = 0; look < 10; look += 1) await pass(3000);
  assert.ok(summary().length >= 4, `${summary()}: others forget a page that says nothing for 25 s`);
  assert.ok(asked.every(({ method }) => method === "POST"));
  store.update({ planning: { what: "Planning", share: 0.5 } });
  asked.length = 0;
  store.update({ planning: null });
  await settle();
  assert.deepEqual(summary(), [false]);
  assert.deepEqual(store.state.others, [{ name: "opal", is_me: true, is_planning: true }]);
});
