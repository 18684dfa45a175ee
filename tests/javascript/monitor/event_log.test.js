import assert from "node:assert/strict";
import { test } from "node:test";
import { lineOf, merged } from "../../../static/js/monitor/event_log.js";
import { ago } from "./live_uav.js";

const MISSIONS = new Map([["m", "Belt"]]);
const event = (kind, more = {}) => ({
  key: `x:${kind}`,
  at: ago(10),
  kind,
  mission: "m",
  uav: { id: 1, name: "Kite" },
  who: null,
  level: null,
  is_simulated: false,
  message: "",
  values: {},
  ...more,
});
const words = (kind, more) => lineOf(event(kind, more), MISSIONS).words;

test("take-off, landing, crash and drop-out name the UAV", () => {
  assert.equal(words("take-off"), "Kite took off");
  assert.equal(words("landing"), "Kite landed");
  assert.equal(words("crash", { values: { text: "Crash: Disarming" } }), "Kite has crashed – Crash: Disarming");
  assert.equal(words("drop-out"), "Kite has dropped out");
});

test("a command names who gave it, and at its end what became of it", () => {
  const hold = { command_kind: "hold" };
  assert.equal(words("command-given", { who: "Opal Reed", values: hold }), "Kite: Hold, given by Opal Reed");
  assert.equal(
    words("command-given", { values: { ...hold, why: "wind" } }),
    "Kite: Hold, given by somebody who has left – wind",
  );
  assert.equal(words("command-sent", { values: hold }), "Kite: Hold, sent");
  assert.equal(
    words("command-failed", { values: { ...hold, outcome: "no answer" } }),
    "Kite: Hold, failed – no answer",
  );
});

test("an alert that is over is resolved, or closed by a person", () => {
  const values = { message: "Kite is late.", reason: "cleared" };
  assert.equal(words("alert-resolved", { values }), "Resolved: Kite is late.");
  assert.equal(
    words("alert-resolved", { who: "Opal", values: { ...values, reason: "by-person" } }),
    "Closed by Opal: Kite is late.",
  );
  assert.equal(words("alert-acknowledged", { who: "Opal", values }), "Acknowledged by Opal: Kite is late.");
  const { image, level } = lineOf(event("alert-opened", { level: "critical", values }), MISSIONS);
  assert.deepEqual([image, level], ["octagon-alert", "critical"]);
});

test("a fault that was injected says what it is, and that all is well again", () => {
  const injected = (faults, more) => words("fault-injected", { who: "Ada", values: { faults }, ...more });
  assert.equal(injected({ motor_failed: 0 }), "Kite: motor 1 has failed, injected by Ada");
  assert.equal(
    injected({ link_lost_for_s: 60, gps_lost_for_s: 0 }),
    "Kite: link lost for 60 s of simulated time, injected by Ada",
  );
  assert.equal(
    injected({ link_lost_for_s: 0, gps_lost_for_s: 0, motor_failed: null }, { uav: null }),
    "All UAVs: faults cleared, injected by Ada",
  );
  assert.equal(words("simulation-changed", { who: "Ada", values: { speed: 5 } }), "Kite: speed 5×, set by Ada");
});

test("missions and offers say who decided", () => {
  assert.equal(words("mission-aborted", { who: "Ada", values: { why: "storm" } }), "“Belt” aborted by Ada – storm");
  assert.equal(words("mission-ended", { values: { state: "completed" } }), "“Belt” has ended: completed");
  assert.equal(words("offer-made", { values: { code: "uav-out" } }), "Re-plan: A UAV has dropped out – Kite");
  assert.equal(words("offer-accepted", { who: "Ada" }), "Re-plan accepted by Ada");
  assert.equal(
    words("target-skipped", { values: { label: "T1", reason: "not-held" } }),
    "T1: Skipped, The UAV did not stay long enough.",
  );
});

test("a page read anew adds what is new and repeats nothing", () => {
  const [old, newer] = [event("take-off", { at: ago(30) }), event("landing", { at: ago(5) })];
  assert.deepEqual(
    merged([old], [newer, old]).map(({ kind }) => kind),
    ["landing", "take-off"],
  );
});
