import assert from "node:assert/strict";
import { test } from "node:test";

import { taskOf } from "../../../static/js/scene/instruments/task.js";
import { boxRound } from "../../../static/js/scene/sources/box.js";
import { addSample, liveSample, liveSource } from "../../../static/js/scene/sources/live_source.js";
import { completed, ESTIMATED, LOST, MEASURED, momentOf } from "../../../static/js/scene/sources/pieces.js";
import { planSource, windAtHeight } from "../../../static/js/scene/sources/plan_source.js";
import { usualSource, worstRun } from "../../../static/js/scene/sources/read.js";
import { recordSource } from "../../../static/js/scene/sources/record_source.js";
import { rehearsalSource } from "../../../static/js/scene/sources/rehearsal_source.js";
import { eastOf, FRAME, HOME, MISSION, near, nearAll, T0, WAYPOINTS } from "./flown_mission.js";

const samples = [0, 10, 20].map((seconds) => ({
  at_ms: T0 + seconds * 1_000,
  position: eastOf(seconds * 10),
  altitude_amsl_m: 100 + seconds,
  altitude_relative_m: 60 + seconds,
  heading_deg: seconds ? 10 : 350,
  roll_deg: seconds,
  battery_percent: 90,
  isInAir: true,
}));

test("between two samples numbers are in proportion and headings go the short way", () => {
  const moment = momentOf([{ kind: MEASURED, samples }], T0 + 5_000);
  nearAll(moment.position, eastOf(50), 1e-9);
  assert.deepEqual([moment.kind, moment.altitude_amsl_m, moment.roll_deg, moment.heading_deg], [MEASURED, 105, 5, 0]);
  assert.equal(momentOf([{ kind: MEASURED, samples }], T0 - 1), null);
});

test("after the last word a UAV is lost where it was; after a landing it stands there", () => {
  const lost = momentOf([{ kind: MEASURED, samples }], T0 + 60_000);
  assert.deepEqual([lost.kind, lost.position, lost.speed_mps], [LOST, samples[2].position, 0]);
  const landed = momentOf(
    [{ kind: MEASURED, samples: [...samples.slice(0, 2), { ...samples[2], isInAir: false }] }],
    T0 + 60_000,
  );
  assert.equal(landed.kind, MEASURED);
});

test("in a stretch of estimates the bound grows from the report", () => {
  const stretch = [samples[0], { ...samples[1], bound: { along_m: 40, across_m: 10, bearing_deg: 80, height_m: 4 } }];
  const moment = momentOf([{ kind: ESTIMATED, samples: stretch }], T0 + 5_000);
  assert.deepEqual([moment.kind, moment.bound.along_m, moment.bound.height_m], [ESTIMATED, 20, 2]);
});

test("a heading, a speed and a climb that nobody told are those of the way", () => {
  const [first, , last] = completed(samples.map(({ heading_deg, ...rest }) => rest));
  near(first.heading_deg, 90, 0.1);
  near(first.speed_mps, 10, 0.05);
  near(first.climb_mps, 1);
  near(last.heading_deg, 90, 0.1);
});

test("a plan is flown by its own times", () => {
  const source = planSource(MISSION);
  assert.deepEqual([source.span.from_ms, source.span.to_ms], [T0, T0 + 180_000]);
  assert.deepEqual(
    source.targets.map(({ label, asset }) => [label, asset]),
    [
      ["A1", 7],
      ["A2", 8],
    ],
  );
  const moment = momentOf(source.routes[0].pieces, T0 + 45_000);
  nearAll(moment.position, eastOf(450), 1e-7);
  assert.equal(moment.waypoint, 2);
  assert.equal(taskOf(source.routes[0], moment).target, 1);
});

const FLIGHT = {
  ending: "landed",
  t_s: [0, 10, 40, 100],
  position: [0, 0, 300, 300].map((east_m) => eastOf(east_m)),
  altitude_amsl_m: [40, 100, 100, 40],
  altitude_relative_m: [0, 60, 60, 0],
  battery_percent: [100, 99, 95, 90],
  used_wh: [0, 1, 2, 3],
  waypoint: [null, 0, 1, 1],
};

test("a rehearsed run has the simulated attitude, and hangs level in tracks of before", () => {
  const track = {
    run: 0,
    routes: [
      {
        uav: 0,
        name: "Wigeon",
        flights: [{ ...FLIGHT, roll_deg: [0, 1, 2, 0], pitch_deg: [0, -9, -9, 0], heading_deg: [90, 90, 91, 91] }],
        planned: WAYPOINTS.map(({ sequence, ...point }) => ({ ...point, waypoint: sequence, at_s: 0 })),
      },
    ],
  };
  const detail = {
    id: "r",
    runs: [
      {
        words: "Calm",
        conditions: { wind: [] },
        assessment: { routes: [{ uav: 0, targets: [{ target: 0, at_s: 40 }] }] },
      },
    ],
  };
  const source = rehearsalSource({ detail, track, mission: MISSION });
  assert.equal(source.isSimulated, true);
  assert.equal(momentOf(source.routes[0].pieces, T0 + 20_000).pitch_deg, -9);
  assert.deepEqual(
    source.events.map(({ kind }) => kind),
    ["take-off", "target", "landing"],
  );
  assert.equal(source.routes[0].pieces[0].samples[0].isInAir, false);
  const before = rehearsalSource({
    detail,
    track: { ...track, routes: [{ ...track.routes[0], flights: [FLIGHT] }] },
    mission: MISSION,
  });
  const moment = momentOf(before.routes[0].pieces, T0 + 20_000);
  assert.equal(moment.pitch_deg, null);
  near(moment.heading_deg, 90, 0.1);
});

test("a record is measured, estimated in its silence, and has the wind that was told last", () => {
  const record = {
    mission: { departs_at: null, started_at: "2026-09-10T09:10:00Z", state: "completed" },
    targets: [],
    routes: [
      {
        place: 0,
        uav: 3,
        name: "Wigeon",
        waypoints: WAYPOINTS.map((point) => ({ ...point, arrival_s: null })),
        is_simulated: false,
      },
    ],
  };
  const report = (seconds, more = {}) => ({
    geometry: { coordinates: eastOf(seconds * 10) },
    properties: {
      uav: 3,
      measured_at: new Date(T0 + seconds * 1_000).toISOString(),
      altitude_relative_m: 60,
      roll_deg: 3,
      is_in_air: true,
      ...more,
    },
  });
  const guess = {
    geometry: { coordinates: eastOf(300) },
    properties: {
      uav: 3,
      estimated_for: new Date(T0 + 30_000).toISOString(),
      bound_along_m: 30,
      bound_across_m: 10,
      bound_bearing_deg: 90,
      bound_height_m: 5,
      altitude_relative_m: 60,
      is_lost: false,
    },
  };
  const source = recordSource({
    record,
    alerts: [],
    records: {
      features: [
        report(0, { wind_north_mps: -3, wind_east_mps: 0 }),
        report(10),
        report(50),
        report(51, { is_in_air: false }),
      ],
      every_s: null,
    },
    estimates: {
      features: [report(20), report(40)]
        .map(({ geometry, properties }) => ({
          geometry,
          properties: { ...guess.properties, ...properties, estimated_for: properties.measured_at },
        }))
        .concat(guess),
      every_s: null,
    },
  });
  const { pieces } = source.routes[0];
  assert.deepEqual(
    pieces.map(({ kind }) => kind),
    [MEASURED, ESTIMATED, MEASURED],
  );
  assert.equal(momentOf(pieces, T0 + 5_000).roll_deg, 3);
  assert.equal(momentOf(pieces, T0 + 30_000).bound.along_m, 30);
  const wind = source.windAt(T0 + 40_000);
  assert.deepEqual([wind.speed_mps, wind.from_deg], [3, 0], "the air goes south: it comes from the north");
});

test("a record goes on growing while its mission is under way: the same routes with more flown", () => {
  const report = (at_s) => ({
    geometry: { coordinates: eastOf(at_s * 10) },
    properties: {
      uav: 3,
      measured_at: new Date(T0 + at_s * 1_000).toISOString(),
      altitude_relative_m: 50,
      is_in_air: true,
    },
  });
  const record = (state) => ({
    mission: { departs_at: "2026-09-10T09:10:00Z", state },
    targets: [],
    routes: [
      {
        place: 0,
        uav: 3,
        name: "Wigeon",
        is_simulated: false,
        waypoints: WAYPOINTS.map((point, sequence) => ({ ...point, sequence, arrival_s: sequence })),
      },
    ],
  });
  const loaded = (state, until_s) => ({
    record: record(state),
    alerts: [],
    records: { features: Array.from({ length: until_s }, (_, at_s) => report(at_s)), every_s: null },
    estimates: { features: [], every_s: null },
  });
  const source = recordSource(loaded("active", 5));
  const [route] = source.routes;
  assert.deepEqual([source.isGrowing, source.isSimulated, source.span.to_ms], [true, false, T0 + 4_000]);
  source.renew(loaded("completed", 9));
  assert.equal(source.routes[0], route);
  assert.deepEqual([source.isGrowing, source.span.to_ms, route.pieces[0].samples.length], [false, T0 + 8_000, 9]);
});

const live = (more = {}) => ({
  id: 3,
  name: "Wigeon",
  mission: "m",
  place: 0,
  is_simulated: true,
  link: { is_in_air: true },
  estimated: null,
  rhythm: { interval_s: 1, late_after_s: 5, silent_after_s: 10 },
  measured: {
    measured_at: new Date(T0).toISOString(),
    position: eastOf(0),
    altitude_relative_m: 60,
    heading_deg: 90,
    roll_deg: -4,
    pitch_deg: 2,
    speed_mps: 10,
    battery_percent: 70,
    is_in_air: true,
    waypoint_sequence: 1,
    wind_speed_mps: 5,
    wind_from_deg: 200,
    ...more,
  },
});

test("live a UAV is measured with its attitude, estimated when it is silent, and lost after that", () => {
  const measured = liveSample(live(), T0 + 500);
  assert.deepEqual([measured.kind, measured.roll_deg, measured.waypoint], [MEASURED, -4, 1]);
  const estimated = {
    at: new Date(T0 + 20_000).toISOString(),
    position: eastOf(200),
    altitude_relative_m: 60,
    speed_mps: 10,
    heading_deg: 90,
    bound: { along_m: 25, across_m: 8, bearing_deg: 90, height_m: 4 },
    is_measured: false,
    is_lost: false,
    waypoint_sequence: 2,
  };
  const guess = liveSample({ ...live(), estimated }, T0 + 20_500);
  assert.deepEqual([guess.kind, guess.roll_deg, guess.bound.along_m, guess.waypoint], [ESTIMATED, 0, 25, 2]);
  assert.equal(liveSample({ ...live(), estimated: { ...estimated, is_lost: true } }, T0 + 20_500).kind, LOST);
  assert.equal(liveSample({ ...live(), measured: null }, T0), null);
});

test("a live source glides from word to word, and its way grows by reports alone", () => {
  const source = liveSource({ detail: MISSION });
  assert.equal(source.take({ uavs: [live()], now_ms: T0 + 200 }), true);
  assert.equal(source.take({ uavs: [live()], now_ms: T0 + 400 }), false, "the same word");
  source.take({
    uavs: [live({ measured_at: new Date(T0 + 1_000).toISOString(), position: eastOf(10) })],
    now_ms: T0 + 1_200,
  });
  const [route] = source.routes;
  const half = source.momentAt(route, T0 + 1_350);
  near(FRAME.toLocal(...half.position, 0)[0], 5, 0.05);
  near(FRAME.toLocal(...source.momentAt(route, T0 + 1_600).position, 0)[0], 10, 0.01);
  assert.equal(route.pieces[0].samples.length, 2);
  assert.equal(source.isSimulated, true);
  assert.deepEqual(source.windAt(), { speed_mps: 5, from_deg: 200 });
});

test("over a long silence no way is drawn, and a very long one keeps a bounded number of points", () => {
  const pieces = [];
  const sample = (seconds) => ({ at_ms: T0 + seconds * 1_000, position: eastOf(seconds) });
  for (const seconds of [0, 1, 100, 100]) addSample(pieces, sample(seconds));
  assert.deepEqual(
    pieces.map((piece) => piece.samples.length),
    [2, 1],
  );
  for (let seconds = 101; seconds < 20_000; seconds += 1) addSample(pieces, sample(seconds));
  assert.ok(pieces.at(-1).samples.length <= 4_001);
});

test("what is looked at where nothing is said, and the worst of a rehearsal's runs", () => {
  const rehearsals = [{ id: "r", level: "pass" }];
  assert.equal(usualSource({ state: "active" }, rehearsals).kind, "live");
  assert.equal(usualSource({ state: "completed" }, rehearsals).kind, "record");
  assert.equal(usualSource({ state: "approved" }, rehearsals).kind, "rehearsal");
  assert.equal(usualSource({ state: "planned" }, [{ level: "" }]).kind, "plan");
  assert.equal(
    worstRun({
      runs: [
        { sequence: 0, level: "pass" },
        { sequence: 1, level: "fail" },
        { sequence: 2, level: "" },
      ],
    }),
    1,
  );
  assert.equal(worstRun({ runs: [{ sequence: 0, level: "" }] }), null);
});

test("the box round a flight has room on each side and never more than can be asked for", () => {
  const [west, south, east, north] = boxRound([HOME, eastOf(1_000, 500)]);
  near(FRAME.toLocal(west, south, 0)[0], -900, 15);
  near(FRAME.toLocal(east, north, 0)[0], 1_900, 15);
  const wide = boxRound([
    [9, 54],
    [12, 57],
  ]);
  assert.ok((wide[3] - wide[1]) * 111_195 < 40_000 && (wide[2] - wide[0]) * 64_000 < 40_500);
  assert.equal(boxRound([]), null);
});

test("wind at a height lies between its layers", () => {
  const layers = [
    { altitude_agl_m: 10, speed_mps: 4, from_deg: 350 },
    { altitude_agl_m: 110, speed_mps: 8, from_deg: 10 },
  ];
  const wind = windAtHeight(layers, 60);
  near(wind.speed_mps, 5.93, 0.05);
  assert.ok(wind.from_deg < 10 || wind.from_deg > 350);
  assert.equal(windAtHeight(layers, 5).speed_mps, 4);
  assert.equal(windAtHeight([], 5), null);
});
