import assert from "node:assert/strict";
import { test } from "node:test";

import { directionOf, lengthOf, minus } from "../../../static/js/scene/cameras/vectors.js";
import { drawFlight } from "../../../static/js/scene/flight/drawn_flight.js";
import { makeFrame } from "../../../static/js/scene/frame.js";
import { stepped } from "../../../static/js/scene/geometry/ribbon.js";
import {
  nearestTower,
  nearestWire,
  nearestZone,
  roomRound,
  surroundingsOf,
} from "../../../static/js/scene/instruments/distances.js";
import { headingText, readingsOf } from "../../../static/js/scene/instruments/readings.js";
import { taskOf } from "../../../static/js/scene/instruments/task.js";
import { ESTIMATED, MEASURED } from "../../../static/js/scene/sources/pieces.js";
import { planSource } from "../../../static/js/scene/sources/plan_source.js";
import { eastOf, FRAME, HOME, MISSION, near, nearAll, numbers, T0 } from "./flown_mission.js";

const plain = (text) => text.replace(/[\u00a0\u2009]/g, " ");

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
  const summary = Object.fromEntries(
    readingsOf(drawn, {
      nearest,
      task: { kind: "at", target: 0 },
      wind: null,
      labels: new Map([[0, { label: "A1", name: "Tower 1" }]]),
    }).map(({ name, value, note }) => [name, plain(note ? `${value}; ${note}` : value)]),
  );
  assert.equal(summary.task, "at A1; Tower 1");
  assert.equal(summary.agl, "~61 m");
  assert.equal(summary.speed, "~10 m/s; 1.5 m/s up");
  assert.equal(summary.heading, "~225°, south-west");
  assert.equal(summary.battery, "–");
  assert.equal(summary.wire, "~12.3 m");
  assert.equal(summary.tower, "–");
  assert.equal(summary.zone, "~0 m; inside Reserve");
  assert.equal(headingText(359.7), "000°, north");
});
