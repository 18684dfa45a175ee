import assert from "node:assert/strict";
import test from "node:test";

import { abortQuestion, questionOf } from "../../../static/js/domain/command_questions.js";
import { commandWords } from "../../../static/js/domain/flying.js";
import {
  holdLine,
  holdLinesOfAll,
  landingLines,
  returnLines,
  returnLinesOfAll,
  returnOf,
  returnStatus,
  saferReturn,
  separateReturns,
  togetherLine,
  warningsOfAll,
} from "../../../static/js/domain/rtl_check.js";

const check = (state, warnings = [], more = {}) => ({
  place: 1,
  state,
  warnings,
  height_m: 30,
  read_at: "2027-05-04T09:00:00Z",
  fence_warning: "",
  present: { is_measured: true, age_s: 2, uncertainty_m: 1 },
  battery: { landing_percent: 46, reserve_percent: 20, unknown: "" },
  met: [],
  ...more,
});

test("a question before Return or Abort says something of the way home in any case", () => {
  assert.deepEqual(returnLines(undefined), ["Return path not checked: it flies straight, at its own return altitude."]);
  assert.equal(returnLines(check("unknown", ["Not read."]))[0], "Not read.");
  assert.match(returnLines(check("clear"))[0], /Return path clear, 30\Wm/);
});

test("it says whence that was looked at, and how certain that is", () => {
  assert.match(returnLines(check("clear")).at(-1), /^Checked from where it was measured 2\Ws ago\.$/);
  const estimated = { present: { is_measured: false, age_s: 34, uncertainty_m: 60 } };
  assert.match(
    returnLines(check("clear", [], estimated)).at(-1),
    /where it is estimated, ± 60\Wm; last report 34\Ws ago/,
  );
  assert.equal(returnLines(check("unknown", ["Not known."], { present: null })).length, 2);
});

test("it says what is left of the battery at the landing, or why nobody knows", () => {
  assert.match(returnLines(check("clear"))[1], /^Lands with about 46\W% of its battery \(reserve 20\W%\)\.$/);
  const unknown = { battery: { landing_percent: null, reserve_percent: null, unknown: "Tern reports none." } };
  assert.equal(returnLines(check("clear", [], unknown))[1], "Battery at landing not known: Tern reports none.");
  const short = { battery: { landing_percent: 12, reserve_percent: 20, unknown: "" } };
  assert.equal(returnLines(check("clear", ["It would land with 12 %."], short)).length, 3, "the warning is enough");
});

test("of several it says whether they keep apart on the way home", () => {
  const met = { met: [{ name: "Kite" }] };
  assert.match(togetherLine([check("clear"), check("clear")]), /their return paths are separated/);
  assert.match(
    togetherLine([check("clear"), check("clear", ["Returning now, …"], met)]),
    /their return paths are not separated/,
  );
  assert.match(togetherLine([check("clear"), undefined]), /their return paths are not separated/);
  assert.equal(togetherLine([check("clear")]), "");
});

test("a landing where it is says what lies below", () => {
  const landing = {
    warnings: ["Railway Dee line is below it."],
    facts: ["It is 42 m above the ground.", "The ground slopes by 3° there."],
    present: { is_measured: true, age_s: 1, uncertainty_m: 1 },
  };
  const { lines } = questionOf("land", { name: "Tern", landing });
  assert.equal(lines[1], "Railway Dee line is below it.");
  assert.equal(lines[2], "It is 42 m above the ground. The ground slopes by 3° there.");
  assert.deepEqual(landingLines(null), ["Landing place not checked."]);
});

test("a hold says how long it can last", () => {
  assert.match(holdLine(400), /^It can hold for about 7\Wmin, with battery left for the return/);
  assert.match(holdLine(10), /^It cannot hold/);
  assert.equal(holdLine(null), "Hold time unknown.");
  assert.match(questionOf("hold", { name: "Tern", hold_s: 400 }).lines[1], /7\Wmin/);
  const [shortest, unknown] = holdLinesOfAll([
    { name: "Tern", hold_s: 900 },
    { name: "Kite", hold_s: 400 },
    { name: "Crow", hold_s: null },
  ]);
  assert.match(shortest, /^Kite: It can hold for about 7\Wmin/);
  assert.equal(unknown, "Hold time unknown: Crow.");
});

test("what is in the way is a warning, what is not known is said", () => {
  const summary = returnStatus(
    check("in_the_way", ["From waypoint 3 on it crosses Heliport.", "Use Hold and Land instead."]),
  );
  assert.deepEqual(
    [summary.level, summary.words],
    ["warning", "From waypoint 3 on it crosses Heliport. Use Hold and Land instead."],
  );
  assert.deepEqual(
    [returnStatus(check("unknown", ["Not read."])).level, returnStatus(check("clear")).level, returnStatus(undefined)],
    [null, null, null],
  );
});

test("a fence that the autopilot ignores is a warning under its name and before a start", () => {
  const fence_warning = "Tern ignores the fence that goes with the mission: its autopilot has FENCE_ENABLE 0.";
  const summary = returnStatus({ ...check("clear"), fence_warning });
  assert.deepEqual([summary.level, summary.image], ["warning", "triangle-alert"]);
  assert.match(summary.words, /Return path clear.*FENCE_ENABLE 0\.$/);
  const flyer = { name: "Tern", route: { length_m: 900, duration_s: 120 }, speed_mps: 8 };
  assert.ok(
    questionOf("start", { ...flyer, planned: { ...check("clear"), fence_warning } }).lines.includes(fence_warning),
  );
  assert.deepEqual(questionOf("start", flyer).lines.filter(Boolean).length, 1);
});

test("each UAV has its own", () => {
  assert.equal(returnOf([check("clear")], 1).state, "clear");
  assert.equal(returnOf([check("clear")], 0), undefined);
  assert.equal(returnOf(null, 0), undefined);
});

test("an abort says what each aircraft does, and what is in the way of each", () => {
  const wires = "Between waypoints 2 and 4, the way home passes wires too low.";
  const inTheWay = check("in_the_way", [wires]);
  const uavs = [
    { name: "Tern", check: inTheWay },
    { name: "Kite", check: inTheWay },
    { name: "Crow", check: undefined },
  ];
  const { lines } = abortQuestion({ name: "South", isActive: true, uavs });
  assert.match(lines[1], /^In the air: it returns and lands where it took off/);
  assert.match(lines[2], /^All return at once/);
  assert.equal(lines[3], `Tern, Kite: ${wires}`);
  assert.match(lines.at(-1), /^Crow: Return path not checked/);
  assert.match(questionOf("abort", { name: "Tern", returns: inTheWay }).lines[0], /^In the air: it returns/);
  assert.equal(abortQuestion({ name: "South", isActive: true, uavs: uavs.slice(0, 1) }).lines[2], "");
});

const way = (more = {}) => ({ height_m: null, wait_s: 0, along_route: false, ...more });

test("what meets less than a straight return at once is offered in its place", () => {
  const offered = (more) => saferReturn(check("in_the_way", ["…"], { safest: way(more) }));
  assert.deepEqual(offered({ height_m: 75 }).parameters, { height_m: 75 });
  assert.match(offered({ height_m: 75 }).words, /^Return at 75\Wm$/);
  assert.deepEqual(offered({ wait_s: 40 }).parameters, { wait_s: 40 });
  assert.match(offered({ height_m: 75, wait_s: 40 }).words, /^Hold 40\Ws, then return at 75\Wm$/);
  assert.deepEqual(offered({ along_route: true }).parameters, { along_route: true });
  assert.equal(offered({}), null, "straight at once");
  assert.equal(saferReturn(check("in_the_way", ["…"], { safest: null })), null, "no way is clear");
  const returns = check("in_the_way", ["…"], { safest: way({ along_route: true }) });
  const question = questionOf("return", { name: "Tern", returns });
  assert.deepEqual([question.safer.words, question.act], ["Return along the route", "Return straight now"]);
  assert.equal(questionOf("return", { name: "Tern", returns: check("clear") }).act, "Return Tern");
});

test("an abort offers what meets less than its straight returns", () => {
  const returns = check("in_the_way", ["…"], { uav: 1, name: "Tern", safest: way({ along_route: true }) });
  const one = questionOf("abort", { name: "Tern", returns });
  assert.deepEqual([one.safer.words, one.act, one.isDanger], ["Return along the route", "Abort Tern", true]);
  assert.equal(questionOf("abort", { name: "Tern", returns: check("clear") }).safer, null);
  const asked = (found) => abortQuestion({ name: "South", isActive: true, uavs: [{ name: "Tern", check: found }] });
  assert.deepEqual([...asked(returns).safer.parameters.ways], [[1, { along_route: true }]]);
  assert.ok(asked(returns).lines.includes("The mission then stays open: close it once all UAVs are down."));
  assert.equal(asked(check("clear")).safer, null);
});

test("a return along the route says to where, how long, and with what it lands", () => {
  const along = { waypoint: 8, length_m: 1240, duration_s: 150, targets: 1, landing_percent: 34.4 };
  const summary = returnLines(check("in_the_way", ["…"], { safest: way({ along_route: true }), along })).join(" ");
  assert.match(
    summary,
    /straight to waypoint 9, then as approved, .*1 target is still visited\..*Lands with about 34\W%/,
  );
});

test("several return on separate ways where they meet otherwise, and it is said of whom no way is clear", () => {
  const one = check("clear", [], { uav: 1, name: "Tern", safest: way(), is_clear: false });
  const other = { ...one, uav: 2, name: "Kite", safest: way({ height_m: 66 }) };
  const { ways, lines } = separateReturns([one, other, { ...one, uav: 3, name: "Crow", safest: null }]);
  assert.deepEqual([...ways], [[2, { height_m: 66 }]]);
  assert.match(lines[0], /Kite: Return at 66\Wm/);
  assert.match(lines[1], /^Crow: no return path is clear/);
  assert.equal(separateReturns([one]), null);
});

test("a return that waits says until when its UAV holds", () => {
  const command = {
    kind: "return",
    state: "queued",
    created_at: "2027-05-04T09:00:00Z",
    parameters: { wait_s: 40 },
    outcome: "",
  };
  assert.match(commandWords(command).words, /^Return: holds until .*:00:40/);
  assert.match(commandWords({ ...command, parameters: {} }).words, /^Return: waiting/);
});

test("that no return altitude is reported is said once of several UAVs, and its parameter only in the tooltip", () => {
  const unreported = (name) =>
    check("unknown", [`Return altitude of ${name} not reported by the autopilot.`], {
      name,
      height_m: null,
      detail: "RTL_ALT",
    });
  const [tern, kite] = [unreported("Tern"), unreported("Kite")];
  assert.deepEqual(warningsOfAll([tern]), tern.warnings);
  const lines = warningsOfAll([tern, kite, check("in_the_way", ["A zone is in the way."])]);
  assert.equal(lines.length, 2);
  assert.match(lines[0], /^Return altitude not reported by 2 UAVs: Tern, Kite\./);
  const ofAll = returnLinesOfAll([tern, kite].map((one) => ({ name: one.name, check: one })));
  assert.match(ofAll[0], /^Return altitude not reported by 2 UAVs/);
  assert.equal(ofAll.filter((line) => line.includes("not reported")).length, 1);
  assert.equal(returnStatus(tern).title, "Autopilot parameter: RTL_ALT");
  assert.doesNotMatch(returnStatus(tern).words, /RTL/);
});
