import assert from "node:assert/strict";
import { test } from "node:test";
import { whyNotRehearsed } from "../../../static/js/mission/flying/next_act.js";
import {
  curvesOf,
  figuresOf,
  nearestOther,
  ownConditions,
  rulesUpTo,
  sentenceOf,
} from "../../../static/js/mission/rehearsal/rehearsal.js";

const plain = (text) => text.replaceAll("\u00a0", " ");
const run = (words, level, targets = []) => ({
  words,
  level,
  assessment: { routes: [{ targets: targets.map((name, target) => ({ target, level: name })) }], meetings: [] },
});
const detail = (level, ...runs) => ({ state: "done", level, runs, error: null });

test("the sentence tells how many targets fail in which conditions, each counted once", () => {
  assert.equal(
    sentenceOf(detail("pass", run("Calm", "pass"), run("As planned", "pass"))),
    "It passes: Calm, As planned.",
  );
  assert.equal(
    sentenceOf(detail("warnings", run("Calm", "pass"), run("Strong wind", "warnings"))),
    "It passes with warnings: Strong wind.",
  );
  const failing = detail(
    "fail",
    run("Calm", "pass", ["pass", "pass"]),
    run("Strong wind", "fail", ["fail", "pass"]),
    run("Storm", "fail", ["fail", "pass"]),
  );
  assert.equal(sentenceOf(failing), "1 of 2 targets fails: Strong wind, Storm.");
  assert.equal(sentenceOf(detail("fail", run("Calm", "fail", ["pass"]))), "It fails: Calm.");
  assert.equal(sentenceOf({ ...detail(""), state: "cancelled" }), "Stopped before it was done.");
  assert.equal(
    sentenceOf({ ...detail(""), state: "failed", error: { message: "The mission was changed." } }),
    "The mission was changed.",
  );
});

test("figures stand beside what is planned or allowed", () => {
  const route = {
    flown_s: 300,
    planned_s: null,
    used_wh: 20,
    planned_wh: 18,
    reserve_percent: 20,
    across: { max_m: 1.2 },
    height: { max_m: null },
    lowest: null,
    obstacle: null,
    energy: [{ left_percent: 60 }, { left_percent: 30 }],
    zones: [{ name: "Airport", beside_m: 30, height_m: 40 }],
  };
  const figures = figuresOf(route, [{ name: "across_fail_m", value: 10 }]);
  const of = (words) => figures.find((one) => one.words === words);
  assert.equal(of("Time").beside, "");
  assert.deepEqual([of("Battery at landing").flown, of("Battery at landing").beside].map(plain), [
    "30 %",
    "limit 20 %",
  ]);
  assert.deepEqual([of("From zones in force").flown, of("From zones in force").beside].map(plain), ["50 m", "Airport"]);
  assert.equal(of("Off the height, most").flown, "–");
  assert.equal(of("From towers and wires").flown, "none near");
});

test("curves count heights from the first take-off, flight by flight", () => {
  const flight = (amsl, relative) => ({
    t_s: [0, 1],
    altitude_amsl_m: amsl,
    altitude_relative_m: relative,
    battery_percent: [100, 99],
  });
  const planned = [
    { at_s: 0, altitude_relative_m: 0, battery_percent: null },
    { at_s: 9, altitude_relative_m: 60, battery_percent: null },
  ];
  const curves = curvesOf({ flights: [flight([100, 160], [0, 60]), flight([150, 210], [0, 60])], planned });
  assert.deepEqual(
    curves.flown.height.map((line) => line.map(({ value }) => value)),
    [
      [0, 60],
      [50, 110],
    ],
  );
  assert.deepEqual(curves.planned.battery, []);
  assert.equal(curves.planned.height[0].length, 2);
});

test("rules of a scale are two to four round figures", () => {
  assert.deepEqual(rulesUpTo(100), [50, 100]);
  assert.deepEqual(rulesUpTo(75), [20, 40, 60]);
  assert.deepEqual(rulesUpTo(0), []);
});

test("of two other UAVs the nearer one is told", () => {
  const meetings = [
    { uavs: [0, 1], beside_m: 30, height_m: 40 },
    { uavs: [2, 0], beside_m: 3, height_m: 4 },
    { uavs: [1, 2], beside_m: 1, height_m: 0 },
  ];
  assert.deepEqual(nearestOther({ meetings }, 0), { away_m: 5, other: 2 });
  assert.equal(nearestOther({ meetings: [] }, 0), null);
});

test("own figures leave out what is as planned", () => {
  assert.deepEqual(ownConditions({ wind_mps: 9, from_deg: 360, gusts_mps: NaN, battery_percent: 70 }), {
    wind: [{ altitude_agl_m: 10, speed_mps: 9, from_deg: 0 }],
    battery_percent: 70,
  });
  assert.deepEqual(ownConditions({ wind_mps: NaN, from_deg: NaN, gusts_mps: 2, battery_percent: NaN }), {
    gusts_mps: 2,
  });
});

test("only a stored plan is rehearsed", () => {
  assert.equal(whyNotRehearsed({ mission: null }), "Save the mission first: what is stored is rehearsed.");
  assert.equal(whyNotRehearsed({ mission: {}, plan: null }), "Plan the mission first.");
});
