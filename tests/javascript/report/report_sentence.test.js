import assert from "node:assert/strict";
import { test } from "node:test";

import { factsOf, figuresOf, qualityOf, reasonsOf, sentenceOf } from "../../../static/js/record/sentence.js";

const record = (state, { reports = 100, complete = 11, results = {}, alerts: counts = {}, estimates = {} } = {}) => ({
  mission: { state, started_at: null },
  routes: [{ flown: { reports } }],
  summary: {
    results: { inspected: complete, "not-confirmed": 0, "not-inspected": 12 - complete, open: 0, all: 12, ...results },
    clock_rate: 1,
    alerts: { critical: 0, warning: 0, advisory: 0, ...counts },
    planned: { length_m: 93_900, duration_s: 4_680, energy_wh: 1_940 },
    flown: { length_m: 94_600, duration_s: 4_500, energy_wh: null },
    across_rms_m: 0.7,
    height_rms_m: null,
    lowest_battery_percent: 24.9,
    estimates: { compared: 0, share_inside: null, rms_m: null, ...estimates },
  },
});

test("the sentence says what came of it, what is so far, or that nothing was flown", () => {
  assert.equal(sentenceOf(record("completed")), "11 of 12 targets inspected");
  assert.equal(sentenceOf(record("active")), "11 of 12 targets inspected so far");
  assert.equal(sentenceOf(record("planned", { reports: 0, complete: 0 })), "Not flown yet.");
  assert.equal(sentenceOf(record("aborted", { reports: 0, complete: 0 })), "0 of 12 targets inspected");
  assert.equal(factsOf(record("completed")), "Lowest battery in flight 24\u00a0%. No alerts.");
  assert.equal(
    sentenceOf(record("completed", { complete: 10, results: { "not-confirmed": 1 } })),
    "10 of 12 targets inspected, 1 not confirmed",
  );
  const simulated = { ...record("completed"), routes: [{ name: "Tern", is_simulated: true, flown: { reports: 9 } }] };
  assert.match(factsOf(simulated), /^Simulated flight\. /);
  assert.match(
    factsOf({
      ...simulated,
      routes: [...simulated.routes, { name: "Kite", is_simulated: false, flown: { reports: 9 } }],
    }),
    /^Simulated, no real aircraft: Tern\. /,
  );
  assert.equal(
    factsOf(record("completed", { alerts: { critical: 1, warning: 2 } })),
    "Lowest battery in flight 24\u00a0%. 3 alerts, 1 critical.",
  );
});

test("durations of a simulation that is faster than real time are told as simulated", () => {
  const fast = record("completed");
  fast.summary.clock_rate = 4;
  assert.match(factsOf(fast), /Simulation at 4\.0×; durations are simulated time\./);
  assert.equal(figuresOf(fast)[1].more, "−3\u00a0min", "both by the simulation's clock");
});

const target = (place, result, reason = null) => ({
  place,
  label: `E402-${place}`,
  flown_place: 10 - place,
  result,
  reason,
});
const crash = { code: "crashed-cause", message: "Sim 2 crashed, motor", at: "2026-09-10T09:34:00Z" };
const time = new Date(crash.at).toLocaleTimeString("en", { hour: "2-digit", minute: "2-digit", hourCycle: "h23" });

test("targets that one thing kept from being inspected are told together, in flown order", () => {
  const targets = [
    target(1, "inspected"),
    target(2, "not-inspected", crash),
    target(3, "not-inspected", crash),
    target(4, "not-confirmed", { code: "nearest-report", message: "nearest report 94 m away", at: null }),
  ];
  const reported = reasonsOf({ targets, incidents: [] });
  assert.deepEqual(
    reported.map(({ targets: of, words }) => [of.map(({ place }) => place), words]),
    [
      [[4], "{targets} not confirmed: nearest report 94 m away."],
      [[3, 2], `{targets} not inspected: Sim 2 crashed, motor (${time}).`],
    ],
  );
});

test("a crash after the last target and an abort are told too, each once", () => {
  const incidents = [
    { kind: "crashed", message: crash.message, at: crash.at },
    { kind: "link-lost", message: "Sim 1 lost its link", at: crash.at },
    { kind: "aborted", message: "mission aborted by Ada: rain", at: crash.at },
  ];
  const words = (targets) => reasonsOf({ targets, incidents }).map((one) => one.words);
  assert.deepEqual(words([target(1, "inspected")]), [
    `Sim 2 crashed, motor (${time}).`,
    `Mission aborted by Ada: rain (${time}).`,
  ]);
  assert.deepEqual(words([target(1, "not-inspected", crash)]), [
    `{targets} not inspected: Sim 2 crashed, motor (${time}).`,
    `Mission aborted by Ada: rain (${time}).`,
  ]);
});

test("figures are compared where both are known, and only once it is over", () => {
  const rows = figuresOf(record("completed"));
  assert.deepEqual(rows[0], { words: "Distance", planned: "93.9\u00a0km", flown: "94.6\u00a0km", more: "+700\u00a0m" });
  assert.equal(rows[1].more, "−3\u00a0min");
  assert.deepEqual([rows[2].flown, rows[2].more], ["—", ""]);
  assert.equal(rows.length, 3, "diagnostics are folded");
  const quality = qualityOf(record("completed", { estimates: { compared: 40, share_inside: 0.96, rms_m: 8.2 } }));
  assert.equal(quality[1].flown, "—");
  assert.deepEqual(quality[2], {
    words: "Position estimates within 95 % bound",
    planned: "95\u00a0%",
    flown: "96\u00a0%",
    more: "",
  });
  assert.equal(qualityOf(record("completed", { estimates: { compared: 3, share_inside: 0, rms_m: 10.3 } })).length, 2); // too few for a share
  assert.equal(figuresOf(record("active"))[0].more, "");
  assert.equal(figuresOf(record("planned", { reports: 0 }))[0].flown, "—");
});

test("a time without reports is told, and is no difference to the plan", () => {
  const found = record("completed");
  found.summary.flown = { ...found.summary.flown, length_m: 90_200, unreported_m: 4_400, unreported_s: 180 };
  const rows = figuresOf(found);
  assert.equal(rows[0].more, "+700\u00a0m");
  const gap = rows.find(({ words }) => words.startsWith("Without telemetry"));
  assert.equal(gap.flown, "3\u00a0min, 4.4\u00a0km");
  assert.ok(!figuresOf(record("completed")).some(({ words }) => words.startsWith("Without telemetry")));
});
