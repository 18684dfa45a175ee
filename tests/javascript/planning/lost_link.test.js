import assert from "node:assert/strict";
import { test } from "node:test";
import { merged } from "../../../static/js/mission/actions/merge.js";
import { changedParts } from "../../../static/js/mission/actions/save_request.js";
import { questionOf } from "../../../static/js/mission/map/reachable.js";
import * as link from "../../../static/js/mission/options/lost_link.js";
import { basisOf, EMPTY, requestOf, selectionOf, storedBasisOf } from "../../../static/js/mission/selection.js";

const YARD = [-82.95, 39.95];
const back = { behaviour: "return", rally_points: [], hold_s: 0 };
const spaces = (text) => text.replaceAll("\u00a0", " ");

const waypoints = [
  [-83, 40],
  [-82.99, 40],
  [-82.98, 40],
  [-82.97, 40],
].map((position) => ({ position }));
const failed = (waypoint, trouble, more = {}) => ({
  route: 0,
  waypoint,
  return_point: 0,
  trouble,
  missing_wh: null,
  zone: null,
  zone_id: null,
  over_m: null,
  ...more,
});
const planWith = (check, route = {}) => ({
  result: { routes: [{ uav: "Heron", geometry: {}, energy_wh: 12, waypoints, ...route }], lost_link: check },
});

test("going on without rally points is what nobody has to say", () => {
  assert.equal(link.lostLinkOf(null), null);
  assert.equal(link.lostLinkOf({ behaviour: "go_on", rally_points: [], hold_s: 30 }), null);
  assert.deepEqual(
    requestOf({ ...EMPTY, lost_link: { behaviour: "go_on", rally_points: [], hold_s: 0 } }).lost_link,
    undefined,
  );
  assert.deepEqual(requestOf({ ...EMPTY, lost_link: back }).lost_link, back);
});

test("rally points stay while UAVs go on, and seconds of holding go with holding alone", () => {
  const holding = link.withRallyPoint(link.withBehaviour(null, "hold"), [-82.9500004, 39.95]);
  assert.deepEqual(holding, { behaviour: "hold", rally_points: [YARD], hold_s: 60 });
  assert.deepEqual(link.withBehaviour(link.withHold(holding, 90), "go_on"), {
    behaviour: "go_on",
    rally_points: [YARD],
    hold_s: 0,
  });
  assert.equal(link.lostLinkOf(link.withoutRallyPoint(link.withBehaviour(holding, "go_on"), 0)), null);
  assert.deepEqual(link.withRallyPointAt(holding, 0, [1, 2]).rally_points, [[1, 2]]);
});

test("a mission takes no more rally points than the server does", () => {
  let many = back;
  for (let number = 0; number < link.MAX_RALLY_POINTS + 2; number += 1) many = link.withRallyPoint(many, [number, 1]);
  assert.equal(many.rally_points.length, link.MAX_RALLY_POINTS);
});

test("another wish is another mission to store, and the same routes", () => {
  const before = { ...EMPTY };
  const after = { ...EMPTY, lost_link: back };
  assert.equal(basisOf(after), basisOf(before));
  assert.notEqual(storedBasisOf(after), storedBasisOf(before));
  assert.deepEqual(changedParts(after, before), { lost_link: back });
  assert.deepEqual(changedParts(before, after), { lost_link: null });
  assert.equal(selectionOf({ targets: [], uavs: [], ...EMPTY, lost_link: { ...back } }).lost_link.behaviour, "return");
  assert.equal(questionOf({ ...after, uavs: [{ name: "Heron", position: YARD }] }).lost_link, undefined);
});

test("two people's rally points clash where both changed them, and come together where one did", () => {
  const version = (lost_link) => ({ name: "North", selection: { ...EMPTY, lost_link } });
  const [mine, theirs] = [link.withRallyPoint(back, [1, 1]), link.withRallyPoint(back, [2, 2])];
  assert.deepEqual(merged(version(back), version(mine), version(back)).selection.lost_link, mine);
  assert.deepEqual(merged(version(back), version(mine), version(theirs)).clashes, ["lost_link"]);
});

test("a check of another wish is none", () => {
  const plan = planWith({ ...back, failed: [] });
  assert.equal(link.checkStateOf(null, plan, true), "go-on");
  assert.equal(link.checkStateOf(back, null, false), "unplanned");
  assert.equal(link.checkStateOf(back, plan, false), "unplanned");
  assert.equal(link.checkStateOf(back, planWith(null), true), "unknown");
  assert.equal(link.checkStateOf(link.withRallyPoint(back, YARD), plan, true), "waiting");
  assert.equal(link.checkStateOf(back, plan, true), "home");
  assert.equal(link.checkStateOf(back, planWith({ ...back, failed: [failed(1, "wind")] }), true), "lost");
});

test("waypoints with one trouble are told together, with the worst figure and the zone", () => {
  const plan = planWith({
    ...back,
    failed: [
      failed(1, "battery", { missing_wh: 2.31 }),
      failed(2, "battery", { missing_wh: 4.52 }),
      failed(3, "zone", { zone: "Greenlawn", zone_id: 7 }),
    ],
  });
  const [short, barred] = link.failuresOf(plan);
  assert.deepEqual(short.waypoints, [1, 2]);
  assert.equal(link.failureText(short).where, "waypoints 2–3, back to its start");
  assert.equal(spaces(link.failureText(short).why), "up to 4.6 Wh are missing with the reserve kept");
  assert.equal(link.failureText(barred).where, "waypoint 4, back to its start");
  assert.equal(link.failureText(barred).why, "the way back meets Greenlawn");
  assert.equal(barred.zone_id, 7);
  assert.equal(link.checkText("lost", plan), "From 3 of 4 waypoints a UAV would not get home.");
});

test("the map shows each way back to where it would have led", () => {
  const rally = link.withRallyPoint(back, YARD);
  const lines = link.returnLinesOf(
    planWith({ ...rally, failed: [failed(1, "wind"), failed(3, "wind", { return_point: 1 })] }),
  );
  assert.deepEqual(
    lines.map(({ from, to }) => [from, to]),
    [
      [waypoints[1].position, waypoints[0].position],
      [waypoints[3].position, YARD],
    ],
  );
});

test("ways back that do not fail lead quietly to the nearest of start and rally points; from the ground none does", () => {
  const rally = link.withRallyPoint(back, YARD);
  const kinds = ["start", "pass", "base", "target"];
  const plan = planWith(
    { ...rally, failed: [failed(1, "wind")] },
    { waypoints: waypoints.map((waypoint, index) => ({ ...waypoint, kind: kinds[index] })) },
  );
  assert.deepEqual(link.quietReturnsOf(plan), [{ from: waypoints[3].position, to: waypoints[0].position }]);
  const near = link.withRallyPoint(back, [-82.975, 40]);
  assert.deepEqual(
    link.quietReturnsOf(planWith({ ...near, failed: [] })).map(({ to }) => to),
    [waypoints[0].position, [-82.975, 40], [-82.975, 40]],
  );
});

test("energy that nobody counts is not taken for enough", () => {
  const uncounted = planWith({ ...back, failed: [] }, { energy_wh: null });
  assert.equal(link.checkText("home", uncounted), "From every waypoint the way back meets no zone.");
  assert.equal(link.uncountedText(uncounted), "Energy is not checked for Heron: no battery is stated.");
  assert.equal(link.uncountedText(planWith({ ...back, failed: [] })), "");
});

test("how high UAVs have to climb for the way back is told, and a mast in the way", () => {
  assert.equal(
    spaces(link.heightsText(planWith({ ...back, failed: [], highest_m: [105] }))),
    "Highest way back, above the start: Heron 105 m.",
  );
  assert.equal(link.heightsText(planWith({ ...back, failed: [], highest_m: [null] })), "");
  assert.equal(link.heightsText(planWith({ ...back, failed: [] })), "");
  const [barred] = link.failuresOf(planWith({ ...back, failed: [failed(1, "obstacle", { over_m: 5 })] }));
  assert.equal(
    spaces(link.failureText(barred).why),
    "a mast, wires or a bridge is in the way: over it the path would be 5 m above the greatest allowed height",
  );
});

test("places of waypoints are counted from 1 and run together", () => {
  assert.equal(link.placesText([4, 2, 3, 11]), "3–5, 12");
});
