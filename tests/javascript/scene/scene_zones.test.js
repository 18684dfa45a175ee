import assert from "node:assert/strict";
import test from "node:test";

import { makeFrame } from "../../../static/js/scene/frame.js";
import { cutBy, foldsOf } from "../../../static/js/scene/geometry/folds.js";
import { makeGround } from "../../../static/js/scene/geometry/ground.js";
import { area2, triangulate } from "../../../static/js/scene/geometry/triangulate.js";
import { withinFor, zoneVolume } from "../../../static/js/scene/geometry/zones.js";
import { drawer, heightsThrough, hill_m, mountains, RULES, randomScene } from "./random_scene.js";

const POINTS = 100; // random ones, of each kind
const WITHIN_M = 0.5;
const scene = randomScene(7);
const frame = makeFrame(scene.origin);
const ground = makeGround(scene.ground, frame);
const folds = foldsOf(ground);
const close = (actual, expected, within, message) =>
  assert.ok(Math.abs(actual - expected) <= within, `${message ?? ""} ${actual} is not ${expected}`);

test("a polygon with a notch and a hole becomes triangles of its area, all turned one way", () => {
  const outline = [
    [0, 0],
    [10, 0],
    [10, 10],
    [5, 5],
    [0, 10],
    [0, 0],
  ];
  const hole = [
    [2, 1],
    [4, 1],
    [3, 3],
  ];
  const { points, triangles } = triangulate([outline, hole]);
  let area = 0;
  for (let at = 0; at < triangles.length; at += 3) {
    const own = area2([points[triangles[at]], points[triangles[at + 1]], points[triangles[at + 2]]]) / 2;
    assert.ok(own > -1e-12);
    area += own;
  }
  close(area, 75 - 2, 1e-9);
  assert.deepEqual(
    triangulate([
      [
        [0, 0],
        [1, 1],
      ],
    ]).triangles,
    [],
  );
});

test("what is cut along the ground's folds covers the same area, in pieces over which the ground is a plane", () => {
  const { scene: steep, frame: own } = mountains(5);
  const rough = makeGround(steep.ground, own);
  const cuts = foldsOf(rough);
  const next = drawer(6);
  for (let round = 0; round < 20; round += 1) {
    const triangle = Array.from({ length: 3 }, () => [
      rough.west + next() * rough.stepX * (rough.columns - 1),
      rough.north + next() * rough.stepZ * (rough.rows - 1),
    ]);
    const turned = area2(triangle) > 0 ? triangle : [...triangle].reverse();
    for (const within of [0.15, 5]) {
      const pieces = cuts.pieces([turned], within);
      close(
        pieces.reduce((sum, piece) => sum + area2(piece), 0),
        area2(turned),
        1e-6 * area2(turned),
      );
      for (const piece of pieces.filter((_, number) => number % 50 === 0)) {
        const middle = [0, 1].map((axis) => piece.reduce((sum, point) => sum + point[axis], 0) / piece.length);
        const mean = piece.reduce((sum, [x, z]) => sum + rough.heightAt(x, z), 0) / piece.length;
        close(mean, rough.heightAt(...middle), 2 * within);
      }
    }
  }
  assert.deepEqual(
    cutBy(
      [
        [0, 0],
        [2, 0],
        [2, 2],
        [0, 2],
      ],
      (x) => 1 - x,
    ),
    [
      [0, 0],
      [1, 0],
      [1, 2],
      [0, 2],
    ],
  );
  assert.deepEqual(
    cutBy(
      [
        [0, 0],
        [2, 0],
        [2, 2],
      ],
      (x) => x - 3,
    ),
    [],
  );
});

test("random star-shaped polygons are covered whole", () => {
  const next = drawer(11);
  for (let round = 0; round < 50; round += 1) {
    const corners = 5 + Math.floor(next() * 60);
    const ring = Array.from({ length: corners }, (_, at) => {
      const [angle, reach] = [((at + next() * 0.8) / corners) * 2 * Math.PI, 0.2 + next()];
      return [reach * Math.cos(angle), reach * Math.sin(angle)];
    });
    const { points, triangles } = triangulate([ring]);
    let area = 0;
    for (let at = 0; at < triangles.length; at += 3)
      area += area2([0, 1, 2].map((corner) => points[triangles[at + corner]])) / 2;
    close(area, area2(ring) / 2, 1e-9);
  }
});

test("zones reach from limit to limit: over the ground they follow it, above the sea they are level", () => {
  const next = drawer(4);
  const volumes = scene.zones.map((zone) => zoneVolume(zone, { frame, ground, folds, clip: scene.clip, rules: RULES }));
  const sea = (m) => m - scene.origin.altitude_amsl_m;
  for (let point = 0; point < POINTS; point += 1) {
    const [angle, reach] = [next() * 2 * Math.PI, Math.sqrt(next()) * 0.98];
    const [lon, lat] = [10.02 + 0.004 * reach * Math.cos(angle), 56.03 + 0.002 * reach * Math.sin(angle)];
    const [x, y, z] = frame.toLocal(lon, lat, hill_m(lon, lat));
    const [floor, ceiling] = heightsThrough(volumes[0].caps.vertices, volumes[0].caps.index, x, z);
    close(ceiling, y + 120, WITHIN_M);
    close(floor, ground.heightAt(x, z), WITHIN_M);
  }
  const corner = scene.zones[1].polygons[0][0];
  for (let point = 0; point < POINTS; point += 1) {
    const [lon, lat] = [corner[0][0] + 0.009 * next(), corner[0][1] + 0.009 * next()];
    const [x, , z] = frame.toLocal(lon, lat, 0);
    const heights = heightsThrough(volumes[1].caps.vertices, volumes[1].caps.index, x, z);
    assert.ok(heights.length === 0 || heights.length === 2);
    if (heights.length) close(heights[1], sea(410), 1e-3);
    if (heights.length) close(heights[0], Math.max(sea(320), ground.heightAt(x, z)), WITHIN_M);
  }
  for (let point = 0; point < POINTS; point += 1) {
    const { vertices } = volumes[0].walls;
    const panel = Math.floor((next() * vertices.length) / 12) * 12;
    const share = next();
    const [x, z] = [0, 2].map(
      (axis) => vertices[panel + axis] + share * (vertices[panel + 6 + axis] - vertices[panel + axis]),
    );
    const [lon, lat] = frame.toGeographic([x, 0, z]);
    const top = vertices[panel + 4] + share * (vertices[panel + 10] - vertices[panel + 4]);
    close(top, hill_m(lon, lat) - 200 + 120, WITHIN_M);
  }
});

test("in mountains zones follow the ground as closely, up to where a limit above the sea is higher", () => {
  const { scene: steep, frame: own } = mountains(8);
  const rough = makeGround(steep.ground, own);
  const cuts = foldsOf(rough);
  const within_m = withinFor(steep.zones, own, cuts);
  const next = drawer(9);
  const sea = (m) => m - steep.origin.altitude_amsl_m;
  const limits = [
    [(y) => y, (y) => y + 120],
    [(y) => Math.max(y, sea(900)), (y) => Math.max(y, sea(1_400))],
    [(y) => y + 40, (y) => Math.max(y + 40, sea(1_300))],
  ];
  steep.zones.forEach((zone, number) => {
    const { walls, caps } = zoneVolume(zone, {
      frame: own,
      ground: rough,
      folds: cuts,
      clip: steep.clip,
      rules: RULES,
      within_m,
    });
    const [[west, south], , [east, north]] = zone.polygons[0][0];
    for (let point = 0; point < POINTS; point += 1) {
      const [x, , z] = own.toLocal(
        west + (east - west) * (0.01 + 0.98 * next()),
        south + (north - south) * (0.01 + 0.98 * next()),
        0,
      );
      const heights = heightsThrough(caps.vertices, caps.index, x, z);
      limits[number].forEach((expected, side) => {
        close(
          heights.at(-side),
          expected(rough.heightAt(x, z)),
          WITHIN_M,
          `zone ${number}, ${side ? "ceiling" : "floor"}`,
        );
      });
    }
    for (let point = 0; point < POINTS; point += 1) {
      const panel = Math.floor((next() * walls.vertices.length) / 12) * 12;
      const share = next();
      const [x, low, z] = [0, 1, 2].map(
        (axis) =>
          walls.vertices[panel + axis] + share * (walls.vertices[panel + 6 + axis] - walls.vertices[panel + axis]),
      );
      const high = walls.vertices[panel + 4] + share * (walls.vertices[panel + 10] - walls.vertices[panel + 4]);
      [low, high].forEach((height, side) => {
        close(height, limits[number][side](rough.heightAt(x, z)), WITHIN_M, `zone ${number}, wall`);
      });
    }
  });
});

test("a zone without an upper limit has no ceiling, and none has a wall where the scene was cut", () => {
  const open = zoneVolume(scene.zones[2], { frame, ground, folds, clip: scene.clip, rules: RULES });
  const [, , cut] = frame.toLocal(10, scene.clip[1], 0);
  const [, , side] = frame.toLocal(10, 56.05 - 0.035, 0);
  for (let at = 2; at < open.walls.vertices.length; at += 3) {
    close(open.walls.vertices[at], side, 0.01);
    assert.ok(Math.abs(open.walls.vertices[at] - cut) > 100);
  }
  assert.deepEqual([...new Set(open.walls.fade)].sort(), [0, 1]);
  const [x, z] = [0, (cut + side) / 2];
  assert.equal(heightsThrough(open.caps.vertices, open.caps.index, x + 0.123, z + 0.077).length, 1);
});
