import assert from "node:assert/strict";
import { test } from "node:test";
import { certaintyOf, ESTIMATED, LOST, MEASURED, standsAt } from "../../../static/js/domain/certainty.js";
import { distance_m } from "../../../static/js/domain/geodesy.js";
import { flyingUavs, inAir } from "../../../static/js/domain/in_air.js";
import { alertsInOrder, inOrder, newAlerts } from "../../../static/js/domain/order.js";
import { colourClass, routeNumber } from "../../../static/js/domain/palette.js";
import { boardRows } from "../../../static/js/monitor/board.js";
import { unreachableLines } from "../../../static/js/monitor/commands/unreachable.js";
import { progressOf } from "../../../static/js/monitor/live_strip.js";
import { ellipseRing, metresPerPixel } from "../../../static/js/monitor/map/ellipse.js";
import { between } from "../../../static/js/monitor/map/glide.js";
import { addReport, flownParts } from "../../../static/js/monitor/mission_details.js";
import { ofPage, placed } from "../../../static/js/monitor/placed.js";
import {
  causeWords,
  overWords,
  sentenceOf,
  targetLines,
  validWords,
  whyNotDecided,
} from "../../../static/js/monitor/text/offer_text.js";
import { ageWords, estimateWords, stateOf } from "../../../static/js/monitor/text/uav_text.js";
import { ago, EACH_TEN_SECONDS, estimate, NOW_MS, plain, uav } from "./live_uav.js";

test("a UAV with a fresh report is measured, a silent one is estimated, and lost once nobody vouches for it", () => {
  assert.equal(certaintyOf(uav(), NOW_MS), MEASURED);
  assert.equal(certaintyOf(uav({ age_s: 74, estimated: estimate() }), NOW_MS), ESTIMATED);
  assert.equal(certaintyOf(uav({ age_s: 74, estimated: estimate({ is_lost: true }) }), NOW_MS), LOST);
});

test("an estimate that nobody renews does not make a silent UAV look certain", () => {
  assert.equal(certaintyOf(uav({ age_s: 74, estimated: estimate({ at: ago(60) }) }), NOW_MS), LOST);
  assert.equal(certaintyOf(uav({ age_s: 74, estimated: estimate({ is_measured: true }) }), NOW_MS), LOST);
  assert.equal(certaintyOf({ measured: null, estimated: null, link: {} }, NOW_MS), null);
});

test("an estimated UAV stands where the estimate says, a measured one where it was measured", () => {
  assert.deepEqual(standsAt(uav({ age_s: 74, estimated: estimate() }), ESTIMATED).position, [10.01, 50]);
  assert.deepEqual(standsAt(uav({ estimated: estimate({ is_measured: true }) }), MEASURED).position, [10, 50]);
});

test("a UAV that reports each ten seconds is late when alerts call it late, and no sooner", () => {
  const late = (age_s) => ageWords(uav({ age_s, rhythm: EACH_TEN_SECONDS }), NOW_MS);
  assert.deepEqual(late(9.6), { figure: "9.6\u00a0s", isLate: false });
  assert.deepEqual([late(24.9).isLate, late(25).isLate], [false, true]);
  assert.deepEqual([plain(late(29).figure), plain(late(31).figure)], ["29 s", "31 s"]);
  assert.equal(
    certaintyOf(uav({ age_s: 20, rhythm: EACH_TEN_SECONDS }), NOW_MS),
    MEASURED,
    "nobody estimates it, and it is in time",
  );
  const between = uav({ age_s: 8, rhythm: EACH_TEN_SECONDS, estimated: estimate({ report_at: ago(8) }) });
  assert.equal(certaintyOf(between, NOW_MS), ESTIMATED);
  assert.equal(estimateWords(between, ESTIMATED, NOW_MS), null, "nothing is said of a gap that is usual");
});

test("a flight that was told to be over is over, whatever the last report said", () => {
  const down = { ...uav(), link: { mode: "Mission", is_in_air: false, waypoint_sequence: null } };
  assert.equal(inAir(down), false);
  assert.equal(stateOf(down).words, "On the ground");
  assert.equal(inAir({ ...uav(), measured: null }), true);
  const switchedOff = uav({ age_s: 7200, is_in_air: false });
  assert.equal(certaintyOf(switchedOff, NOW_MS), MEASURED, "it stands where it landed");
  assert.deepEqual(ageWords(switchedOff, NOW_MS), { figure: "2\u00a0h", isLate: false });
});

test("a UAV keeps its letter after its mission, until it flies another that is on the page", () => {
  const mission = (id, ended_at, place) => ({ id, ended_at, uavs: [{ place, uav: 1, name: "Kite" }] });
  const over = { ...uav({ estimated: estimate() }), mission: null, place: null };
  assert.deepEqual(
    placed([over], [mission("a", ago(900), 1), mission("b", ago(60), 2)]).map((one) => [one.mission, one.place]),
    [["b", 2]],
  );
  const elsewhere = { ...over, mission: "other", place: 5 };
  assert.equal(placed([elsewhere], [mission("a", ago(900), 1)])[0], elsewhere, "it flies another mission");
  assert.deepEqual(ofPage([elsewhere, over], "a"), [over], "and is not on the page of this one");
  assert.deepEqual(ofPage([elsewhere, over], null), [elsewhere, over]);
  const flying = { ...over, mission: "a", place: 1 };
  assert.equal(placed([flying], [mission("a", null, 1), mission("b", ago(60), 2)])[0], flying);
  assert.equal(placed([over], [])[0], over);
});

test("the age of a report is a figure, late ones in amber", () => {
  assert.deepEqual(ageWords(uav(), NOW_MS), { figure: "0.7\u00a0s", isLate: false });
  assert.deepEqual(ageWords(uav({ age_s: 6 }), NOW_MS), { figure: "6.0\u00a0s", isLate: true });
  assert.equal(plain(ageWords(uav({ age_s: 74 }), NOW_MS).figure), "74 s");
});

test("the box says how far off an estimate may be", () => {
  const { strong, rest } = estimateWords(uav({ age_s: 74, estimated: estimate() }), ESTIMATED, NOW_MS);
  assert.equal(plain(strong), "Estimated position ±410 m (95 %).");
  assert.match(rest, /^Next contact expected \d\d:\d\d:\d\d/);
  const overdue = estimate({ contact_expected_at: ago(5) });
  assert.match(estimateWords(uav({ age_s: 74, estimated: overdue }), ESTIMATED, NOW_MS).rest, /Contact overdue since/);
  assert.equal(estimateWords(uav(), MEASURED, NOW_MS), null);
});

test("modes of autopilots are said in one word each", () => {
  assert.equal(stateOf(uav({ mode: "AUTO.LOITER" })).words, "Holding");
  assert.equal(stateOf(uav({ mode: "RTL" })).words, "Returning");
  assert.equal(stateOf(uav({ is_in_air: false, is_armed: false })).words, "On the ground");
  assert.equal(stateOf(uav({ mode: "ZIGZAG" })).words, "ZIGZAG");
});

const alert = (id, level, change = {}) => ({
  id,
  uav: id,
  mission: "m",
  level,
  code: "x",
  message: `alert ${id}`,
  opened_at: ago(id),
  closed_at: null,
  acknowledged_at: null,
  acknowledged_by: null,
  ...change,
});

test("UAVs stand mission by mission in the order of their letters, whatever happens to them", () => {
  const of = (id, mission, place) => ({ ...uav({ id }), mission, place });
  const uavs = [of(1, null, null), of(2, "b", 0), of(3, "a", 1), of(4, "a", 0)];
  assert.deepEqual(
    inOrder(uavs, [{ id: "a" }, { id: "b" }]).map(({ id }) => id),
    [4, 3, 2, 1],
  );
});

test("alerts stand by level, the newest first; what somebody knows of comes after", () => {
  const alerts = [
    alert(1, "advisory"),
    alert(2, "critical", { acknowledged_at: ago(1) }),
    alert(3, "warning"),
    alert(4, "critical"),
    alert(5, "critical"),
  ];
  assert.deepEqual(
    alertsInOrder(alerts).map(({ id }) => id),
    [4, 5, 3, 1, 2],
  );
});

test("a cause is told once, and again where it has become worse", () => {
  const reported = new Map([
    [1, "warning"],
    [2, "warning"],
  ]);
  assert.deepEqual(
    newAlerts(
      [
        alert(1, "warning"),
        alert(2, "critical"),
        alert(3, "warning"),
        alert(4, "critical", { acknowledged_at: ago(1) }),
      ],
      reported,
    ).map(({ id }) => id),
    [2, 3],
  );
});

test("the board shows what goes on before what is to come and what is done", () => {
  const target = (place, state, state_at = null) => ({
    place,
    label: `Tower ${place}`,
    state,
    state_at,
    state_reason: "",
    uav: 0,
  });
  const missions = [
    {
      id: "m",
      targets: [
        target(0, "complete", ago(100)),
        target(1, "complete", ago(50)),
        target(2, "pending"),
        target(3, "pending"),
        target(4, "failed", ago(60)),
      ],
    },
  ];
  const details = new Map([["m", { plan: { routes: [{ targets: [0, 1, 2, 3, 4] }] } }]]);
  const rows = boardRows(missions, [uav({ estimated: estimate() })], details);
  assert.deepEqual(
    rows.map(({ pill, state }) => `${pill} ${state}`),
    ["A3 next", "A4 pending", "A5 failed", "A2 complete", "A1 complete"],
  );
  assert.equal(boardRows(missions, [uav({ mode: "Hold", estimated: estimate() })], details)[0].state, "held");
});

test("a ring is as large as its bound and lies along its bearing", () => {
  const ring = ellipseRing([10, 50], { along_m: 400, across_m: 100, bearing_deg: 90 });
  assert.ok(Math.abs(distance_m([10, 50], ring[0]) - 400) < 1);
  assert.ok(ring[0][0] > 10 && Math.abs(ring[0][1] - 50) < 1e-9); // east
  assert.ok(Math.abs(distance_m([10, 50], ring[12]) - 100) < 1);
  assert.deepEqual(ring[0], ring.at(-1));
  assert.ok(
    Math.abs(distance_m([10, 50], ellipseRing([10, 50], { along_m: 1, across_m: 1, bearing_deg: 0 }, 30)[5]) - 30) <
      0.2,
  );
  assert.ok(Math.abs(metresPerPixel(0, 0) - 78_271.5) < 1);
});

test("a marker glides and never overshoots", () => {
  assert.deepEqual(between([0, 0], [2, 4], 150, 300), [1, 2]);
  assert.deepEqual(between([0, 0], [2, 4], 900, 300), [2, 4]);
  assert.deepEqual(between([0, 0], [2, 4], 0, 0), [2, 4]);
});

test("a flown line is broken where nothing was heard, and takes no report twice", () => {
  const report = (seconds, longitude) => ({
    geometry: { coordinates: [longitude, 50] },
    properties: { uav: 7, measured_at: ago(seconds) },
  });
  const flown = flownParts([
    report(100, 1),
    report(99, 2),
    report(20, 3),
    report(20, 3),
    { geometry: null, properties: { uav: 7, measured_at: ago(10) } },
  ]);
  assert.deepEqual(flown.get(7).parts, [
    [
      [1, 50],
      [2, 50],
    ],
    [[3, 50]],
  ]);
  assert.equal(addReport(flown, 7, [4, 50], NOW_MS - 19_000), true);
  assert.equal(addReport(flown, 7, [4, 50], NOW_MS - 30_000), false);
});

test("progress along the route is the estimate's, else that of the last waypoint passed", () => {
  assert.deepEqual(progressOf(uav({ estimated: estimate() }), [0, 100]), { at_m: 2000, within_m: 410 });
  assert.deepEqual(progressOf(uav({ waypoint_sequence: 2 }), [0, 100, 300]), { at_m: 100, within_m: 0 });
  assert.equal(progressOf(uav(), [0, 100]), null);
});

test("an offer for a zone names it, the UAV and the leg", () => {
  const cause = { zone_name: "Air show", uav_name: "Kite", leg: ["B1", "B2"] };
  assert.equal(causeWords({ code: "zone-active", cause }), "Air show lies across the route of Kite, B1 to B2");
  assert.equal(
    causeWords({ code: "zone-active", cause: { ...cause, leg: ["", "B1"] } }),
    "Air show lies across the route of Kite, start to B1",
  );
  assert.equal(causeWords({ code: "uav-out", cause: {} }), "A UAV has dropped out");
});

test("an offer is said in a sentence, and target by target", () => {
  const offer = {
    difference: {
      uavs: [{ change: "changed" }, { change: "out" }],
      targets: [
        { label: "Tower 31", from: 1, to: 2, message: "" },
        { label: "Tower 51", from: 1, to: null, message: "Its battery does not last for it." },
      ],
      unreached: 1,
    },
  };
  assert.equal(sentenceOf(offer), "1 UAV gets another route, 1 target is reassigned, 1 target stays open");
  assert.deepEqual(targetLines(offer), ["Tower 31: B → C", "Tower 51: B → Its battery does not last for it."]);
});

test("of an offer that is over it is said what became of it, and by whom or why", () => {
  const { strong, rest } = overWords({ state: "accepted", outcome: "", decided_by: "opal", decided_at: ago(0) });
  assert.match(`${strong} ${rest}`, /^Re-plan accepted\. Decided by opal, /);
  const none = { state: "impossible", outcome: "Kite has no range left.", decided_by: null, decided_at: null };
  assert.equal(overWords(none).rest, "Kite has no range left.");
  assert.equal(overWords(none, ["E402-2"]).rest, "Kite has no range left. E402-2 stays open: plan a follow-up.");
  const many = ["1", "2", "3", "4", "5", "6"];
  assert.match(overWords(none, many).rest, /1, 2, 3, 4 and 2 more stay open: plan a follow-up\.$/);
});

test("the time that is left to take an offer counts down to zero", () => {
  assert.equal(validWords(ago(-42.5), NOW_MS), "Valid for 0:43. Dashed on the map.");
  assert.equal(validWords(ago(5), NOW_MS), "Valid for 0:00. Dashed on the map.");
});

test("of UAVs that are not heard it is said who is told all the same", () => {
  const named = (name, kind, received_s) => ({
    name,
    link: { kind, last_message_at: received_s === null ? null : ago(received_s) },
  });
  const uavs = [
    named("Tern", "mavlink", 60),
    named("Kite", "http", 60),
    named("Gull", "mavlink", 7_200),
    named("Wren", "mavlink", null),
  ];
  const [sent, waiting] = unreachableLines(uavs, "return", NOW_MS);
  assert.match(sent, /^No telemetry from Tern: the command is sent repeatedly/);
  assert.match(waiting, /^No link to Kite, Gull, Wren: the command is sent on contact/);
  assert.match(unreachableLines(uavs.slice(0, 1), "resume", NOW_MS)[0], /^No link to Tern/);
  assert.deepEqual(unreachableLines([], "return", NOW_MS), []);
});

test("who is in the air can be told something, also after its mission", () => {
  const uav = (id, mission, isInAir, received_s = 5) => ({
    id,
    mission,
    measured: null,
    link: { is_in_air: isInAir, last_message_at: ago(received_s) },
  });
  const missions = [
    { id: "m", state: "active" },
    { id: "over", state: "aborted" },
  ];
  const uavs = [
    uav(1, "m", true),
    uav(2, "m", null),
    uav(3, "m", false),
    uav(4, "over", true),
    uav(5, null, true),
    uav(6, null, null),
    uav(7, null, true, 7_200),
  ];
  assert.deepEqual(
    flyingUavs({ uavs, missions, now_ms: NOW_MS }).map(({ id }) => id),
    [1, 2, 4, 5],
  );
});

test("a UAV without a GPS fix is drawn as estimated, though it reports", () => {
  assert.equal(certaintyOf(uav({ gps_fix: 1 }), NOW_MS), ESTIMATED);
  assert.equal(certaintyOf(uav({ gps_fix: 3 }), NOW_MS), MEASURED);
});

test("an offer that has expired cannot be decided, nor one on a device that has no data", () => {
  const offer = { difference: { valid_until: ago(-30) } };
  assert.equal(whyNotDecided(offer, { now_ms: NOW_MS, silent_ms: 0 }), "");
  assert.match(whyNotDecided(offer, { now_ms: NOW_MS + 30_000, silent_ms: 0 }), /^Expired/);
  assert.match(whyNotDecided(offer, { now_ms: NOW_MS, silent_ms: 6_000 }), /^No data on this device/);
  assert.match(whyNotDecided(offer, { now_ms: NOW_MS, silent_ms: 31_000 }), /^Expired/);
});

test("a UAV has the colour that the service gives it in its mission, also on the board and once it is over", () => {
  assert.deepEqual([routeNumber(0), routeNumber(9)], [1, 2]);
  const colours = [4, 5, 3, 1, 2, 6, 7, 8];
  assert.deepEqual([routeNumber(0, colours), routeNumber(9, colours)], [4, 5]);
  assert.deepEqual([colourClass(4), colourClass(null)], ["route-4", ""]);
  const over = { ...uav(), mission: null, place: null, colour: null };
  const last = { id: "m", ended_at: ago(60), uavs: [{ place: 1, uav: 1, name: "Kite" }], colours };
  assert.equal(placed([over], [last])[0].colour, 5);
  const target = { place: 0, label: "T", state: "pending", state_at: null, state_reason: "", uav: 1 };
  assert.equal(boardRows([{ ...last, targets: [target] }], [], new Map())[0].colour, 5);
});
