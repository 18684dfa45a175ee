import assert from "node:assert/strict";
import { test } from "node:test";

globalThis.document ??= { cookie: "", querySelector: () => null, documentElement: { lang: "en", dataset: {} } };
globalThis.location ??= { hash: "", pathname: "/", protocol: "http:", host: "here" };
const { isShown, orderLines, startWords } = await import("../../../static/js/page/planned_starts.js");

const NOW_MS = Date.parse("2026-09-21T14:15:00Z");
const start = (more) => ({ name: "Tern", state: "waiting", due_at: "2026-09-21T14:16:05Z", why: "", ...more });

test("a start that waits counts down, and then says what it waits for", () => {
  assert.equal(startWords(start({}), true, NOW_MS), "in 1:05");
  assert.equal(startWords(start({}), true, NOW_MS + 66_000), "now");
  assert.equal(startWords(start({ why: "Kite is near." }), true, NOW_MS + 66_000), "Waits: Kite is near.");
});

test("what became of a start is said, and of one that was stopped that it was not started", () => {
  assert.equal(startWords(start({ state: "started" }), true, NOW_MS), "Start given");
  assert.equal(startWords(start({ state: "refused", why: "No route." }), true, NOW_MS), "Not started: No route.");
  assert.equal(startWords(start({}), false, NOW_MS), "Not started");
});

test("the question names each UAV in its order with its time after the first", () => {
  const waiting = [
    { name: "Tern", after_s: 60 }, // one that is left on the ground was to go first
    { name: "Kite", after_s: 240 },
  ];
  assert.deepEqual(orderLines(waiting), ["Tern: in 10 s", "Kite: 3:00 after the first"]);
});

test("starts that were all given are told for half a minute, others for five", () => {
  const starts = (end, state) => ({ ended_at: "2026-09-21T14:15:00Z", end, uavs: [start({ state })] });
  assert.equal(isShown(starts("done", "started"), NOW_MS + 20_000), true);
  assert.equal(isShown(starts("done", "started"), NOW_MS + 40_000), false);
  assert.equal(isShown(starts("done", "refused"), NOW_MS + 40_000), true);
  assert.equal(isShown(starts("stopped", "waiting"), NOW_MS + 299_000), true);
  assert.equal(isShown(starts("stopped", "waiting"), NOW_MS + 301_000), false);
});
