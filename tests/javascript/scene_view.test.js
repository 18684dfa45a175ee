import assert from "node:assert/strict";
import { test } from "node:test";

import { directionOf, lengthOf, minus } from "../../static/js/scene/cameras/vectors.js";
import { drawFlight } from "../../static/js/scene/flight/drawn_flight.js";
import { makeFrame } from "../../static/js/scene/frame.js";
import { stepped } from "../../static/js/scene/geometry/ribbon.js";
import {
  nearestTower,
  nearestWire,
  nearestZone,
  roomRound,
  surroundingsOf,
} from "../../static/js/scene/instruments/distances.js";
import { headingText, readingsOf } from "../../static/js/scene/instruments/readings.js";
import { taskOf } from "../../static/js/scene/instruments/task.js";
import { placeLabels } from "../../static/js/scene/label_places.js";
import { linkText, readLink, readSource, sourceText } from "../../static/js/scene/link.js";
import { boxRound } from "../../static/js/scene/sources/box.js";
import { addSample, liveSample, liveSource } from "../../static/js/scene/sources/live_source.js";
import { completed, ESTIMATED, LOST, MEASURED, momentOf } from "../../static/js/scene/sources/pieces.js";
import { planSource, windAtHeight } from "../../static/js/scene/sources/plan_source.js";
import { usualSource, worstRun } from "../../static/js/scene/sources/read.js";
import { recordSource } from "../../static/js/scene/sources/record_source.js";
import { rehearsalSource } from "../../static/js/scene/sources/rehearsal_source.js";
import { nextOf, sunTime, targetToSee } from "../../static/js/scene/state.js";
import { fileName } from "../../static/js/scene/still.js";

const T0 = Date.parse("2026-09-10T09:10:00Z");
const HOME = [10, 55];
const FRAME = makeFrame({ position: HOME, altitude_amsl_m: 40 });
const plain = (text) => text.replace(/[\u00a0\u2009]/g, " ");
const near = (found, wanted, slack = 1e-6) => assert.ok(Math.abs(found - wanted) <= slack, `${found} is not ${wanted}`);
const nearAll = (found, wanted, slack) => wanted.forEach((value, axis) => near(found[axis], value, slack));
const eastOf = (metres, north_m = 0) => FRAME.toGeographic([metres, 0, -north_m]).slice(0, 2);

function numbers(seed) {
  let state = seed;
  return () => (state = (state * 48_271) % 2_147_483_647) / 2_147_483_647;
}

// links

test("a link says the same moment and camera when it is read", () => {
  const camera = { mode: "orbit", bearing_deg: 215.25, elevation_deg: 18, distance_m: 85, offset: [1, 0, -2.55] };
  const source = { kind: "rehearsal", rehearsal: "65828de3-3b8d-4a38-92e0-bc7b176f74f2", run: 1 };
  const read = readLink(linkText({ source, at_ms: T0, uav: 1, target: 4, camera }));
  assert.deepEqual(read.source, source);
  assert.deepEqual([read.at_ms, read.since_s, read.uav, read.target], [T0, null, 1, 4]);
  assert.deepEqual(read.camera, { mode: "orbit", view: [215.3, 18, 85], place: null, offset: [1, 0, -2.5] });
  const free = readLink(
    linkText({
      source: { kind: "live" },
      camera: {
        mode: "free",
        bearing_deg: 1,
        elevation_deg: 2,
        distance_m: 0,
        place: [10.1234567, 55, 81.26],
        offset: [0, 0, 0],
      },
    }),
  );
  assert.deepEqual(free.camera.place, [10.123457, 55, 81.3]);
  assert.equal(readLink(linkText({ source: { kind: "plan" }, since_s: 61.25 })).since_s, 61.3);
});

test("an address of nonsense says nothing", () => {
  assert.deepEqual(readLink("?source=elsewhere&t=soon&uav=-1&camera=side&view=a,b"), {
    source: null,
    at_ms: null,
    since_s: null,
    uav: null,
    target: null,
    camera: null,
  });
  assert.deepEqual(readSource("rehearsal:../x:9999"), { kind: "rehearsal", rehearsal: null, run: null });
  assert.equal(sourceText({ kind: "record" }), "record");
});

// sources

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

const WAYPOINTS = [
  ["start", 0, null],
  ["target", 300, 0],
  ["pass", 600, null],
  ["target", 900, 1],
  ["end", 0, null],
].map(([kind, east_m, target], index) => ({
  kind,
  target,
  position: eastOf(east_m),
  altitude_amsl_m: 100,
  altitude_agl_m: 60,
  altitude_relative_m: 60,
  sequence: index,
}));
const MISSION = {
  id: "m",
  name: "North belt",
  uavs: [{ id: 3, is_simulated: true }],
  departs_at: "2026-09-10T09:10:00Z",
  state: "planned",
  targets: [
    { label: "Tower 1", asset: 7 },
    { label: "Tower 2", asset: 8 },
  ],
  plan: {
    conditions: { wind: [{ altitude_agl_m: 10, speed_mps: 4, from_deg: 270 }] },
    routes: [{ uav: "Wigeon", uav_id: 3, waypoints: WAYPOINTS, arrival_s: [0, 30, 60, 90, 180] }],
  },
};

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
        verdict: { routes: [{ uav: 0, targets: [{ target: 0, at_s: 40 }] }] },
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

// places and heights

const hills = (x, z) => 5 * Math.sin(x / 90) + 4 * Math.cos(z / 70);

test("paths stand within half a metre of what the data say, at 100 random points", () => {
  const next = numbers(11);
  const ground = { frame: FRAME, groundAt: hills, groundKind: "terrain" };
  const points = Array.from({ length: 100 }, () => ({
    position: eastOf(next() * 4_000 - 2_000, next() * 4_000 - 2_000),
    altitude_amsl_m: 120 + next() * 80,
    altitude_relative_m: 50 + next() * 60,
  }));
  const planned = points.map((point, index) => ({ ...point, sequence: index, target: null, at_s: index }));
  const pieces = [{ kind: MEASURED, samples: points.map((point, index) => ({ ...point, at_ms: T0 + index * 1_000 })) }];
  const rehearsed = drawFlight({ kind: "rehearsal", routes: [{ place: 0, planned, pieces }] }, ground);
  const [line] = rehearsed.plannedLines();
  const [
    {
      pieces: [flown],
    },
  ] = rehearsed.flownLines();
  const reported = drawFlight({ kind: "record", routes: [{ place: 0, planned, pieces }] }, ground).flownLines()[0]
    .pieces[0];
  const takeOff = FRAME.toLocal(...points[0].position, 0);
  points.forEach(({ position, altitude_amsl_m, altitude_relative_m }, index) => {
    const wanted = FRAME.toLocal(...position, altitude_amsl_m);
    nearAll(line.positions.slice((index + 1) * 3, (index + 2) * 3), wanted, 0.5); // one point more at the beginning: on the ground
    nearAll(flown.positions.slice(index * 3, index * 3 + 3), wanted, 0.5);
    near(reported.positions[index * 3 + 1], hills(takeOff[0], takeOff[2]) + altitude_relative_m, 0.5);
  });
  assert.ok(
    Math.abs(line.positions[1] - hills(line.positions[0], line.positions[2])) < 0.5,
    "it rises from the ground",
  );
});

test("a long stretch of a way gets points in between, with their times; a short one stays", () => {
  const { positions, at_s, place } = stepped(
    { place: 3, positions: [0, 0, 0, 4, 0, 0, 4, 50, 0], at_s: [0, 1, 11] },
    20,
  );
  assert.equal(place, 3);
  assert.deepEqual(
    positions.filter((_, number) => number % 3 === 1).map((y) => Math.round(y * 10) / 10),
    [0, 0, 16.7, 33.3, 50],
  );
  assert.deepEqual(
    at_s.map((time) => Math.round(time * 10) / 10),
    [0, 1, 4.3, 7.7, 11],
  );
  assert.equal(stepped({ positions: [0, 0, 0, 4, 0, 0], at_s: null }, 20).at_s, null);
});

test("over flat ground heights are those above take-off, and nothing flies under the ground", () => {
  const ground = { frame: makeFrame({ position: HOME, altitude_amsl_m: 0 }), groundAt: () => 0, groundKind: "flat" };
  const route = {
    place: 0,
    planned: [{ position: HOME, altitude_amsl_m: null, altitude_relative_m: 60, sequence: 0 }],
    pieces: [],
  };
  const flight = drawFlight({ kind: "plan", routes: [route] }, ground);
  assert.equal(
    flight.at(route, { position: HOME, altitude_relative_m: 60, altitude_amsl_m: 312, isInAir: true }).place[1],
    60,
  );
  assert.ok(flight.at(route, { position: HOME, altitude_relative_m: -3, isInAir: false }).place[1] > 0);
});

test("its camera is on the target while that is near, else ahead and down", () => {
  const ground = { frame: FRAME, groundAt: () => 0, groundKind: "terrain" };
  const route = {
    place: 0,
    planned: [{ position: HOME, altitude_amsl_m: 40, altitude_relative_m: 0, sequence: 0 }],
    pieces: [],
  };
  const flight = drawFlight({ kind: "rehearsal", routes: [route] }, ground);
  const moment = { position: HOME, altitude_amsl_m: 100, heading_deg: 90, isInAir: true };
  near(directionOf(flight.at(route, moment).camera).bearing_deg, 90);
  const seen = flight.at(route, moment, [0, 30, -50]);
  near(directionOf(seen.camera).bearing_deg, 0);
  assert.equal(seen.seesTarget, true);
  assert.equal(flight.at(route, moment, [0, 30, -900]).seesTarget, false);
});

// instruments

const SCENE = {
  supports: [
    {
      id: 7,
      label: "Tower 1",
      kind: "tower",
      position: HOME,
      ground_amsl_m: 40,
      height_m: 30,
      likely_m: 30,
      arms: [[24, -5, 5]],
    },
    {
      id: 9,
      label: null,
      kind: "vertex",
      position: eastOf(20),
      ground_amsl_m: 40,
      height_m: 20,
      likely_m: 20,
      arms: [],
    },
  ],
  spans: [],
  zones: [
    {
      id: 1,
      name: "Reserve",
      polygons: [[[eastOf(100), eastOf(200), eastOf(200, 100), eastOf(100, 100), eastOf(100)]]],
      lower: { above: "ground", m: 0 },
      upper: { above: "ground", m: 50 },
    },
    {
      id: 2,
      name: "Upper air",
      polygons: [[[eastOf(-900), eastOf(900), eastOf(900, 900), eastOf(-900, 900), eastOf(-900)]]],
      lower: { above: "sea", m: 540 },
      upper: { above: "open", m: null },
      schedule: "later",
    },
  ],
};
const WIRES = {
  points: Float64Array.from([0, 25, 0, 0, 20, -100, 0, 25, -200]),
  first: Uint32Array.from([0, 3]),
  span: Uint32Array.from([0]),
};
const AROUND = surroundingsOf(SCENE, FRAME, WIRES, () => 0);

test("distances to wire, tower and zone are those in space", () => {
  near(nearestWire(AROUND, [6, 20, -100]).away_m, 6, 0.01);
  near(nearestWire(AROUND, [0, 60, 0]).away_m, 35, 0.01);
  assert.equal(nearestWire(AROUND, [0, 60, 0], 30), null);
  const tower = nearestTower(AROUND, [30, 70, 0]);
  near(tower.away_m, 50, 1e-3);
  assert.equal(tower.tower.label, "Tower 1");
  near(nearestTower(AROUND, [12, 10, 0]).away_m, 12, 1e-3);
});

test("where planners count a wire higher than it is drawn, that one is near, too", () => {
  const pole = (id, position) => ({
    id,
    label: `Pole ${id}`,
    kind: "pole",
    position,
    ground_amsl_m: 40,
    height_m: 45,
    likely_m: 10,
    arms: [],
  });
  const around = surroundingsOf(
    { supports: [pole(1, HOME), pole(2, eastOf(100))], spans: [{ from: 0, to: 1 }], zones: [] },
    FRAME,
    { points: Float64Array.from([0, 9, 0, 100, 9, 0]), first: Uint32Array.from([0, 2]) },
    () => 0,
  );
  const over = nearestWire(around, [50, 50, 0]);
  near(over.away_m, 5, 0.01);
  assert.equal(over.isCounted, true);
  const low = nearestWire(around, [50, 12, 0]);
  near(low.away_m, 3, 0.01);
  assert.equal(low.isCounted, false);
});

test("the room round a camera is that to ground, towers with their arms, wires and UAVs", () => {
  near(roomRound(AROUND, [8, 10, 0]), 3, 0.01); // beside arms of 5 m
  assert.equal(roomRound(AROUND, [4, 10, 0]), 0);
  near(roomRound(AROUND, [500, 60, 500]), 60, 0.01);
  near(roomRound(AROUND, [500, 60, 500], [[500, 60, 490]]), 10, 1e-9);
  near(roomRound(AROUND, [2, 21, -100]), 2.2, 0.05);
  near(roomRound(AROUND, [0, 40_000, 0]), 39_800, 1);
});

test("a zone is a volume: beside it, over it, inside it", () => {
  near(nearestZone(AROUND, [70, 20, -50]).away_m, 30, 0.05);
  near(nearestZone(AROUND, [150, 90, -50]).away_m, 40, 1e-6);
  near(nearestZone(AROUND, [60, 80, -50]).away_m, 50, 0.05);
  assert.deepEqual(
    [nearestZone(AROUND, [150, 20, -50]).isInside, nearestZone(AROUND, [150, 20, -50]).zone.name],
    [true, "Reserve"],
  );
  const high = nearestZone(AROUND, [-300, 450, -300]);
  assert.deepEqual([high.zone.name, Math.round(high.away_m)], ["Upper air", 50]);
  assert.equal(nearestZone(AROUND, [-300, 450, -300], ({ schedule }) => schedule !== "later").zone.name, "Reserve");
});

test("distances agree with a search through many points of the wires", () => {
  const next = numbers(5);
  const points = Array.from({ length: 40 }, (_, index) => [
    index * 30,
    25 + 6 * Math.cos(index),
    40 * Math.sin(index / 5),
  ]);
  const wires = {
    points: Float64Array.from(points.flat()),
    first: Uint32Array.from([0, 20, 40]),
    span: Uint32Array.from([0, 1]),
  };
  const around = surroundingsOf({ supports: [], spans: [], zones: [] }, FRAME, wires, () => 0);
  for (let trial = 0; trial < 100; trial += 1) {
    const at = [next() * 1_300 - 50, next() * 100, next() * 200 - 100];
    let least = Infinity;
    for (const [from, to] of [
      [0, 19],
      [20, 39],
    ]) {
      for (let index = from; index < to; index += 1)
        for (let step = 0; step <= 50; step += 1)
          least = Math.min(
            least,
            lengthOf(
              minus(
                at,
                points[index].map((value, axis) => value + ((points[index + 1][axis] - value) * step) / 50),
              ),
            ),
          );
    }
    near(nearestWire(around, at).away_m, least, 0.5);
  }
});

test("what a UAV does is told by the waypoint that it flies to", () => {
  const route = planSource(MISSION).routes[0];
  const at = (east_m, waypoint, more = {}) =>
    taskOf(route, { position: eastOf(east_m), waypoint, isInAir: true, climb_mps: 0, ...more });
  assert.deepEqual(at(150, 1), { kind: "to", target: 0 });
  assert.deepEqual(at(298, 1), { kind: "at", target: 0 });
  assert.deepEqual(at(400, 2), { kind: "to", target: 1 });
  assert.deepEqual(at(500, 4), { kind: "home", target: null });
  assert.deepEqual(at(0, 4, { climb_mps: -1 }), { kind: "landing", target: null });
  assert.deepEqual(at(0, null, { climb_mps: 2 }), { kind: "take-off", target: 0 });
  assert.deepEqual(at(0, 0, { isInAir: false }), { kind: "ground", target: null });
});

test("instruments say what they know, and that it is a guess", () => {
  const drawn = {
    height_agl_m: 61.04,
    moment: {
      kind: ESTIMATED,
      altitude_relative_m: 60,
      speed_mps: 9.96,
      heading_deg: 224.6,
      battery_percent: null,
      climb_mps: 1.5,
      bound: { along_m: 40, across_m: 12 },
    },
  };
  const nearest = {
    wire: { away_m: 12.34 },
    tower: null,
    zone: { away_m: 0, isInside: true, zone: { name: "Reserve" } },
  };
  const said = Object.fromEntries(
    readingsOf(drawn, {
      nearest,
      task: { kind: "at", target: 0 },
      wind: null,
      labels: new Map([[0, { label: "A1", name: "Tower 1" }]]),
    }).map(({ name, value, note }) => [name, plain(note ? `${value}; ${note}` : value)]),
  );
  assert.equal(said.task, "at A1; Tower 1");
  assert.equal(said.agl, "~61 m");
  assert.equal(said.speed, "~10 m/s; 1.5 m/s up");
  assert.equal(said.heading, "~225°, south-west");
  assert.equal(said.battery, "–");
  assert.equal(said.wire, "~12.3 m");
  assert.equal(said.tower, "–");
  assert.equal(said.zone, "~0 m; inside Reserve");
  assert.equal(headingText(359.7), "000°, north");
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

// labels, state

test("labels never cover each other, the heavier one stands, and where there is no room there is none", () => {
  const next = numbers(3);
  const items = Array.from({ length: 120 }, (_, key) => ({
    key,
    x: next() * 800,
    y: next() * 500,
    width: 40 + next() * 80,
    height: 16 + next() * 20,
    weight: key,
  }));
  const placed = placeLabels(items, { width: 800, height: 500 });
  const boxes = items
    .filter(({ key }) => placed.has(key))
    .map(({ key, width, height }) => ({ ...placed.get(key), width, height }));
  for (const [index, a] of boxes.entries())
    for (const b of boxes.slice(index + 1))
      assert.ok(
        a.left + a.width <= b.left ||
          b.left + b.width <= a.left ||
          a.top + a.height <= b.top ||
          b.top + b.height <= a.top,
      );
  assert.ok(placed.has(119) && placed.size < 120 && placed.size > 20);
  const under = { left: 0, top: 0, right: 800, bottom: 250 };
  for (const [key, { top }] of placeLabels(items, { width: 800, height: 500 }, new Map(), [under]))
    assert.ok(top >= 250, `${key} is not below what covers it`);
  const again = placeLabels(items, { width: 800, height: 500 }, placed);
  assert.deepEqual(again.get(119), placed.get(119));
});

test("the next one goes round, a target is chosen by task, and the sun stands at the flight's time", () => {
  assert.deepEqual(
    [nextOf([0, 2, 5], 5, 1), nextOf([0, 2, 5], 0, -1), nextOf([0, 2], 9, 1), nextOf([], 0, 1)],
    [0, 5, 0, null],
  );
  const source = planSource(MISSION);
  assert.equal(targetToSee(source, null, { target: 1 }, 0).label, "A2");
  assert.equal(targetToSee(source, 0, { target: 1 }, 0).label, "A1");
  assert.equal(targetToSee({ targets: [] }, null, null, 0), null);
  assert.equal(sunTime(source, T0, 10).getTime(), T0);
  const undated = sunTime({ hasDate: false, departs_ms: 0 }, 60_000, 90, T0);
  assert.equal(undated.toISOString(), "2026-09-10T04:01:00.000Z");
});

test("the file of a picture is named by letters of any language", () => {
  assert.equal(fileName("Südring, Trasse 3/4", "20260910", "chase"), "südring-trasse-3-4-20260910-chase.png");
  assert.equal(fileName("…", "", "top"), "mission-top.png");
});
