import assert from "node:assert/strict";
import { test } from "node:test";

globalThis.document ??= { cookie: "", querySelector: () => null, documentElement: { lang: "en", dataset: {} } };
globalThis.location ??= { hash: "", pathname: "/", protocol: "http:", host: "here" };
const { canUploadToAll, firstStep, nextStep, summaryOf } = await import("../../../static/js/domain/preflight_step.js");
const { rehearsalCheck } = await import("../../../static/js/monitor/panels/preflight.js");

const check = (code, state, message = code) => ({ code, state, message });
const row = (name, more = {}) => {
  const { is_loaded = false, blocks = false } = more;
  return { uav: 1, name, place: 0, is_loaded, blocks, is_ready: is_loaded && !blocks, checks: [], ...more };
};
const preflight = (next_act, uavs, checks = []) => ({ next_act, checks, uavs });

test("the button names the next act and how many UAVs it is about", () => {
  const [tern, kite] = [row("Tern"), row("Kite", { is_loaded: true })];
  assert.equal(nextStep(preflight("upload", [tern, kite]), false).words, "Upload to 1 UAV");
  assert.equal(nextStep(preflight("connect", [tern, kite]), false).why.startsWith("Not connected: Tern."), true);
  assert.equal(nextStep(preflight("start", [kite, kite]), true).words, "Start 2 UAVs");
  assert.equal(nextStep(preflight(null, []), true), null);
});

test("a start waits for the pilot's tick", () => {
  const ready = preflight("start", [row("Kite", { is_loaded: true })]);
  assert.notEqual(nextStep(ready, false).why, "");
  assert.equal(nextStep(ready, true).why, "");
});

test("what has failed blocks the start with its reason, whatever was ticked", () => {
  const blocked = row("Kite", { is_loaded: true, blocks: true, checks: [check("battery", "failed")] });
  assert.equal(nextStep(preflight("start", [blocked]), true).why, "Blocked: Kite");
  const zone = check("zone", "failed", "A zone came.");
  assert.equal(nextStep(preflight("start", [blocked], [zone]), true).why, "A zone came.");
});

test("one that is not connected is left, named, and blocks no others", () => {
  const ready = ["Tern", "Crow"].map((name, uav) => row(name, { uav, is_loaded: true }));
  const kite = row("Kite", { uav: 7, blocks: true, checks: [check("link", "failed", "It was never heard.")] });
  const step = nextStep(preflight("start", [...ready, kite]), true);
  assert.deepEqual([step.words, step.why, step.left], ["Start 2 of 3 UAVs", "", ["Kite is not connected"]]);
  assert.deepEqual(step.uavs, [0, 1]);
  const low = row("Kite", { is_loaded: true, blocks: true, checks: [check("battery", "failed", "It has 20 %.")] });
  assert.deepEqual(nextStep(preflight("start", [...ready, low]), true).left, ["Kite: It has 20 %."]);
  assert.equal(nextStep(preflight("start", [...ready, kite]), false).why, "Tick what was looked at on site.");
});

test("a zone in the way keeps an approved mission from being uploaded", () => {
  const zone = check("zone", "failed", "A zone came.");
  assert.equal(nextStep(preflight("upload", [row("Tern")], [zone]), false).why, "A zone came.");
});

test("the worst check of a UAV is what is said of it", () => {
  const [ok, failed] = [check("link", "ok"), check("battery", "failed", "It would land with 5 %.")];
  assert.equal(summaryOf({ checks: [ok] }), "Ready");
  assert.equal(
    summaryOf({ checks: [ok, check("return", "warning"), check("fence", "warning")] }),
    "Warning: return path, fence",
  );
  assert.equal(summaryOf({ checks: [check("return", "warning"), failed, ok] }), "It would land with 5 %.");
  assert.equal(
    summaryOf({
      checks: [ok, ...["battery", "wind", "mission", "home", "home"].map((code) => check(code, "unknown"))],
    }),
    "Not known: battery, wind, home position",
  );
});

test("a rehearsal of another plan is none", () => {
  assert.equal(rehearsalCheck(null).state, "warning");
  assert.equal(rehearsalCheck({ state: "done", level: "pass", is_outdated: true }).state, "warning");
  assert.equal(rehearsalCheck({ state: "done", level: "fail", is_outdated: false }).message, "Its rehearsal failed");
  assert.equal(rehearsalCheck({ state: "done", level: "pass", is_outdated: false }).state, "ok");
  assert.equal(rehearsalCheck({ state: "running", level: "", is_outdated: false }).state, "unknown");
});

test("simulated UAVs are not waited for: the button flies them in simulation, then says that they start", () => {
  const [tern, kite] = ["Tern", "Kite"].map((name, uav) => row(name, { uav, checks: [check("link", "failed")] }));
  const off = nextStep(preflight("connect", [tern, kite]), false, "off");
  assert.deepEqual([off.act, off.words, off.why], ["simulate", "Fly in simulation", ""]);
  const received = row("Kite", { uav: 1, checks: [check("link", "ok")] });
  const starting = nextStep(preflight("upload", [tern, received]), false, "starting");
  assert.equal(starting.act, "connect");
  assert.match(starting.why, /Waiting for: Tern\./);
  assert.equal(nextStep(preflight("connect", [tern, kite]), false, "running").act, "connect");
  assert.equal(nextStep(preflight("upload", [tern, received]), false, "running").act, "upload");
});

test("the mission goes to simulated UAVs once all are connected", () => {
  const [lost, received] = ["failed", "ok"].map((state) => row("Tern", { checks: [check("link", state)] }));
  assert.equal(canUploadToAll(preflight("upload", [lost, received])), false);
  assert.equal(canUploadToAll(preflight("upload", [received, received])), true);
  assert.equal(canUploadToAll(preflight("connect", [received])), false);
});

test("before the checks have arrived the button says what is being checked", () => {
  assert.match(firstStep().why, /Link, position, battery/);
});
