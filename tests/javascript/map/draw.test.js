/** The drawing engine's pure parts: shapes, measures, what is wrong, undo. */

import assert from "node:assert/strict";
import { test } from "node:test";
import { distance_m, measure, ringArea_m2, towards } from "../../../static/js/domain/geodesy.js";
import { createSteps } from "../../../static/js/draw/history.js";
import * as shapes from "../../../static/js/draw/shape.js";
import { faultsOf } from "../../../static/js/draw/validity.js";

const square = (west, south, side) => [
  [west, south],
  [west + side, south],
  [west + side, south + side],
  [west, south + side],
];
const closed = (ring) => [...ring, ring[0]];
const area = (...rings) => ({ kind: "area", parts: [rings], radius_m: null });

test("GeoJSON of every kind comes back as it was", () => {
  const geometries = [
    { type: "Point", coordinates: [9, 47] },
    {
      type: "LineString",
      coordinates: [
        [9, 47],
        [9.1, 47.1],
      ],
    },
    { type: "Polygon", coordinates: [closed(square(9, 47, 1)), closed(square(9.4, 47.4, 0.1))] },
    { type: "MultiPolygon", coordinates: [[closed(square(9, 47, 1))], [closed(square(11, 47, 1))]] },
  ];
  for (const geometry of geometries) assert.deepEqual(shapes.geometryOf(shapes.shapeOf(geometry)), geometry);
});

test("a circle is its centre and its radius", () => {
  const shape = shapes.shapeOf(null, { centre: [9, 47], radius_m: 500 });
  assert.deepEqual(shapes.circleOf(shape), { centre: [9, 47], radius_m: 500 });
  assert.equal(shapes.geometryOf(shape), null);
  assert.ok(Math.abs(distance_m([9, 47], shapes.radiusHandle(shape)) - 500) < 0.01);
  assert.equal(shapes.radiusTo(shape, towards([9, 47], 200, 750)).radius_m, 750);
});

test("steps leave the shape that they start from alone", () => {
  const shape = area(square(0, 0, 1));
  const before = structuredClone(shape);
  shapes.move(shape, [0, 0, 1], [5, 5]);
  shapes.insertAfter(shape, [0, 0, 3], [0, 0.5]);
  shapes.removeVertex(shape, [0, 0, 0]);
  shapes.moveAll(shape, [1, 1]);
  assert.deepEqual(shape, before);
  assert.deepEqual(shapes.insertAfter(shape, [0, 0, 3], [0, 0.5]).parts[0][0].at(-1), [0, 0.5]);
});

test("an area keeps three vertices, a hole that loses its third is gone", () => {
  const holed = area(square(0, 0, 4), [
    [1, 1],
    [2, 1],
    [2, 2],
  ]);
  assert.equal(shapes.removeVertex(holed, [0, 1, 0]).parts[0].length, 1);
  const triangle = area([
    [0, 0],
    [1, 0],
    [1, 1],
  ]);
  assert.equal(shapes.removeVertex(triangle, [0, 0, 0]), triangle);
  const line = shapes.shapeOf({
    type: "LineString",
    coordinates: [
      [0, 0],
      [1, 1],
    ],
  });
  assert.equal(shapes.removeVertex(line, [0, 0, 0]), line);
});

test("middles stand on every side, also on the one that closes", () => {
  assert.equal(shapes.middlesOf(area(square(0, 0, 2))).length, 4);
  assert.deepEqual(shapes.middlesOf(area(square(0, 0, 2)))[3].position, [0, 1]);
  assert.equal(
    shapes.middlesOf(
      shapes.shapeOf({
        type: "LineString",
        coordinates: [
          [0, 0],
          [1, 1],
          [2, 0],
        ],
      }),
    ).length,
    2,
  );
});

test("a hole that was begun and left is no part of the shape", () => {
  const shape = shapes.append(shapes.addHole(area(square(0, 0, 4)), 0), [0, 1], [1, 1]);
  assert.equal(shapes.withoutStubs(shape).parts[0].length, 1);
});

test("the ring that is not whole is the one to go on with", () => {
  assert.equal(shapes.stubOf(area(square(0, 0, 4))), null);
  assert.deepEqual(
    shapes.stubOf(
      area(square(0, 0, 4), [
        [1, 1],
        [2, 2],
      ]),
    ),
    [0, 1],
  );
  assert.deepEqual(shapes.stubOf(shapes.empty("line")), [0, 0]);
});

test("lengths and areas are those of the sphere", () => {
  assert.ok(Math.abs(distance_m([9, 47], [9, 48]) - 111_195) < 1);
  assert.ok(Math.abs(ringArea_m2(square(0, 0, 1)) / 1.2364e10 - 1) < 1e-3);
  const { area_m2 } = measure(area(square(0, 0, 1), square(0.25, 0.25, 0.5)));
  assert.ok(Math.abs(area_m2 / ringArea_m2(square(0, 0, 1)) - 0.75) < 1e-3);
});

test("a border that crosses itself is told with the place and both sides", () => {
  const [fault, ...others] = faultsOf(
    area([
      [0, 0],
      [2, 2],
      [2, 0],
      [0, 2],
    ]),
  );
  assert.equal(others.length, 0);
  assert.deepEqual(fault.position, [1, 1]);
  assert.equal(fault.sides.length, 2);
});

test("rings that touch or cross each other are told", () => {
  assert.ok(faultsOf(area(square(0, 0, 4), square(3, 3, 2))).length > 0);
  assert.equal(faultsOf(area(square(0, 0, 4), square(1, 1, 1))).length, 0);
  assert.match(faultsOf(area(square(0, 0, 4), square(9, 9, 1)))[0].message, /outside/);
});

test("a spike that goes back on itself is told", () => {
  assert.ok(
    faultsOf(
      area([
        [0, 0],
        [2, 0],
        [4, 0],
        [2, 0],
        [2, 2],
      ]),
    ).length > 0,
  );
});

test("too few points, repeated points and the 180th meridian are told", () => {
  assert.match(faultsOf(shapes.empty("line"))[0].message, /two points/);
  assert.match(faultsOf(shapes.empty("circle"))[0].message, /centre/);
  assert.match(
    faultsOf(
      area([
        [0, 0],
        [0, 0],
        [1, 1],
        [0, 1],
      ]),
    )[0].message,
    /one place/,
  );
  assert.match(
    faultsOf(
      shapes.shapeOf({
        type: "LineString",
        coordinates: [
          [179, 0],
          [-179, 0],
        ],
      }),
    )[0].message,
    /180th/,
  );
});

test("a large fair ring is checked, and nothing is wrong with it", () => {
  const ring = Array.from({ length: 1_500 }, (_, index) => [
    Math.cos((index * Math.PI) / 750),
    Math.sin((index * Math.PI) / 750),
  ]);
  assert.deepEqual(faultsOf(area(ring)), []);
  assert.ok(shapes.isInside([0, 0], ring));
});

test("undo and redo go all the way", () => {
  const steps = createSteps(0);
  for (let value = 1; value <= 500; value += 1) steps.take(value);
  assert.equal(steps.take(500), false);
  while (steps.undo());
  assert.equal(steps.value, 0);
  while (steps.redo());
  assert.equal(steps.value, 500);
  steps.undo();
  steps.take(7);
  assert.equal(steps.canRedo, false);
});
