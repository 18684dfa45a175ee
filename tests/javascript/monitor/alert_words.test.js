import assert from "node:assert/strict";
import { test } from "node:test";
import { positionIn } from "../../../static/js/map/coordinates_read.js";
import {
  actsNow,
  besideWords,
  createSeenLevels,
  messageWords,
  overtakenWords,
  SEEN_AFTER_MS,
} from "../../../static/js/monitor/text/alert_text.js";
import { drawnOffer } from "../../../static/js/monitor/text/offer_text.js";
import { createStore } from "../../../static/js/store.js";
import { positionText } from "../../../static/js/units.js";
import { ago, estimate, NOW_MS, plain, uav } from "./live_uav.js";

globalThis.document ??= { cookie: "", querySelector: () => null, documentElement: { lang: "en", dataset: {} } };
globalThis.location ??= { hash: "", pathname: "/", protocol: "http:", host: "here" };
const { watchOvertaken } = await import("../../../static/js/monitor/commands/commanding.js");

const anAlert = (change) => ({
  id: 1,
  uav: 1,
  code: "battery-short",
  level: "critical",
  message: "UAV 1: battery 19 %, below the reserve of 20 %.",
  details: {},
  acts: [],
  advice: "",
  own_act: null,
  closed_at: null,
  ...change,
});
const silent = (change) =>
  anAlert({
    code: "link-lost",
    level: "warning",
    message: "UAV 1: no telemetry for 6 s.",
    details: { received_s: NOW_MS / 1000 - 6 },
    ...change,
  });

test("the alert of a silent link has the age of this moment, and the time of the last message", () => {
  const words = (now_ms, change) => plain(messageWords(silent(change), uav(), now_ms));
  assert.match(words(NOW_MS), /^UAV 1: no telemetry for 6\.0 s \(last message .*:14:54.*\)\.$/);
  assert.match(words(NOW_MS + 8_000), /^UAV 1: no telemetry for 14 s \(last message .*:14:54.*\)\.$/);
  assert.match(words(NOW_MS + 30_000, { level: "critical" }), /^Link to UAV 1 lost: no telemetry for 36 s \(last/);
});

test("other alerts, ended ones and those of UAVs that are not on the page say what the server says", () => {
  for (const [alert, of] of [
    [silent({ closed_at: ago(1) }), uav()],
    [silent(), undefined],
    [anAlert(), uav()],
  ])
    assert.equal(messageWords(alert, of, NOW_MS), alert.message);
});

test("beside the alert of a silent link stands what the UAV does by itself, and what the expected time rests on", () => {
  const advice = "Planned for link loss: it continues its mission by itself.";
  const summary = plain(besideWords(silent({ advice }), uav({ estimated: estimate() }), NOW_MS));
  assert.match(
    summary,
    /^Planned for link loss: it continues its mission by itself\. Next contact expected \S+.*\. Calculated from/,
  );
  assert.match(
    plain(besideWords(silent({ advice }), uav({ estimated: estimate() }), NOW_MS + 300_000)),
    /Contact overdue since/,
  );
  assert.equal(besideWords(silent({ advice }), uav(), NOW_MS), advice, "nobody knows when");
  assert.equal(besideWords(silent({ advice, closed_at: ago(1) }), uav(), NOW_MS), "");
});

test("an alert says that its UAV returns or lands already, by itself or as commanded, and since when", () => {
  const summary = (own_act) => besideWords(anAlert({ own_act, advice: "It lands with about 8 %." }), uav(), NOW_MS);
  const [since, is_commanded] = [ago(60), false];
  assert.match(
    summary({ kind: "return", since, is_commanded }),
    /^Returning by itself since \S+.*: failsafe or pilot\. It lands with/,
  );
  assert.match(summary({ kind: "land", since, is_commanded }), /^Landing by itself since/);
  assert.match(summary({ kind: "return", since, is_commanded: true }), /^Returning since \S+.*, as commanded\./);
  assert.match(summary({ kind: "land", since: null, is_commanded }), /^Landing by itself: failsafe or pilot\./);
});

test("no act is offered that the UAV does already", () => {
  const acts = [
    { kind: "return", uav: 1 },
    { kind: "land", uav: 1 },
    { kind: "hold", uav: 9 },
  ];
  const offered = (mode) => actsNow(anAlert({ acts }), [uav({ mode })]).map(({ kind }) => kind);
  assert.deepEqual([offered("AUTO"), offered("RTL"), offered("LAND")], [["return", "land"], ["land"], []]);
  assert.equal(overtakenWords("return", uav({ mode: "RTL" })), "UAV 1 is already returning.");
});

test("a level that rose just before the click was not seen", () => {
  const seen = createSeenLevels();
  const shows = (level, at_ms) => seen.show([{ id: 1, level }], at_ms);
  shows("warning", 0);
  assert.equal(seen.of(1, 10), "warning", "a new alert has no other level");
  shows("critical", 5_000);
  shows("critical", 5_500);
  assert.equal(seen.of(1, 5_000 + SEEN_AFTER_MS - 1), "warning");
  assert.equal(seen.of(1, 5_000 + SEEN_AFTER_MS), "critical");
  assert.equal(seen.of(2, 0), undefined);
});

test("a question is over once its UAV has started to return meanwhile", async () => {
  const store = createStore({ uavs: [uav({ mode: "AUTO" }), uav({ id: 2, mode: "RTL" })] });
  const watch = watchOvertaken(store, store.state.uavs[0], "return");
  store.update({ uavs: [uav({ mode: "AUTO", battery_percent: 18 })] });
  store.update({ uavs: [uav({ mode: "RTL" })] });
  assert.equal(await watch.overtaken, "UAV 1 is already returning. This command was not sent.");
  watch.stop();
  const early = watchOvertaken(store, uav({ mode: "RTL" }), "return");
  store.update({ uavs: [uav({ mode: "RTL", battery_percent: 17 })] });
  assert.equal(await Promise.race([early.overtaken, Promise.resolve("asked all the same")]), "asked all the same");
});

test("the routes of an offer are on the map only while it can be decided", () => {
  const offer = (state, until) => ({ id: "o", state, difference: { valid_until: until } });
  const times = { now_ms: NOW_MS, silent_ms: 0 };
  const open = offer("open", ago(-60));
  assert.equal(drawnOffer([offer("outdated", ago(-60)), open], times), open);
  assert.equal(drawnOffer([offer("open", ago(1))], times), undefined, "it has expired");
  assert.equal(drawnOffer([offer("outdated", ago(-60)), offer("computing", null)], times), undefined);
});

test("a position is copied as alerts say it, and read again", () => {
  assert.equal(positionText([10.123456, 56.1]), "56.10000° N, 10.12346° E");
  assert.equal(positionText([-82.99, -39.96]), "39.96000° S, 82.99000° W");
  const { position } = positionIn(positionText([-82.99, 39.96]));
  assert.deepEqual(position, [-82.99, 39.96]);
});
