/** What clicks, steps back and ends do to a drawing, and what is told of rings that meet. */

import assert from "node:assert/strict";
import { test } from "node:test";
import { continuous, distance_m, measure } from "../../../static/js/domain/geodesy.js";
import * as drawings from "../../../static/js/draw/drawing.js";
import { createSteps } from "../../../static/js/draw/history.js";
import * as shapes from "../../../static/js/draw/shape.js";
import { faultsOf } from "../../../static/js/draw/validity.js";

const square = (west, south, side) => [
  [west, south],
  [west + side, south],
  [west + side, south + side],
  [west, south + side],
];
const area = (...rings) => ({ kind: "area", parts: [rings], radius_m: null });
const clicks = (state, ...positions) => positions.reduce((now, position) => drawings.placed(now, position), state);
const drawn = (kind, ...positions) => clicks(drawings.begin(shapes.empty(kind)), ...positions);

test("a point is whole with its first click, a circle with its second", () => {
  assert.equal(drawn("point", [9, 47]).growing, null);
  const centre = drawn("circle", [9, 47]);
  assert.deepEqual(centre.growing, [0, 0]);
  assert.equal(drawings.placed(centre, [9, 47], "last"), centre);
  const circle = drawings.placed(centre, [9.01, 47]);
  assert.equal(circle.growing, null);
  assert.ok(Math.abs(circle.shape.radius_m - distance_m([9, 47], [9.01, 47])) <= 0.5);
});

test("a click on the first or last point ends an area, once it has three", () => {
  const two = drawn("area", [0, 0], [1, 0]);
  assert.equal(drawings.placed(two, [0, 0], "first"), two);
  assert.equal(drawings.placed(two, [1, 0], "last"), two);
  const three = clicks(two, [1, 1]);
  assert.equal(drawings.placed(three, [0, 0], "first").growing, null);
  assert.equal(drawings.placed(three, [1, 1], "last").shape.parts[0][0].length, 3);
});

test("a line may end where it began", () => {
  const loop = drawings.placed(drawn("line", [0, 0], [1, 0], [1, 1]), [0, 0], "first");
  assert.deepEqual(loop.shape.parts[0][0].at(-1), [0, 0]);
  assert.notEqual(loop.growing, null);
});

test("what has too few points is not ended, a hole of too few is dropped", () => {
  const two = drawn("area", [0, 0], [1, 0]);
  assert.equal(drawings.ended(two), two);
  const hole = clicks(drawings.withHole(drawings.begin(area(square(0, 0, 4)))), [1, 1], [2, 1]);
  assert.deepEqual(drawings.ended(hole), { shape: area(square(0, 0, 4)), growing: null });
});

test("undo opens the ring again that was ended, and redo ends it", () => {
  const steps = createSteps(drawings.begin(shapes.empty("area")));
  for (const position of square(0, 0, 4)) steps.take(drawings.placed(steps.value, position));
  steps.take(drawings.ended(steps.value));
  steps.take(drawings.withHole(steps.value));
  steps.take(drawings.placed(steps.value, [1, 1]));
  steps.undo();
  steps.undo();
  assert.equal(steps.value.growing, null);
  steps.undo();
  assert.deepEqual(steps.value.growing, [0, 0]);
  while (steps.redo());
  assert.deepEqual(steps.value.growing, [0, 1]);
  assert.deepEqual(steps.value.shape.parts[0][1], [[1, 1]]);
});

test("steps back go vertex by vertex, then give the hole up", () => {
  let state = clicks(drawings.withHole(drawings.begin(area(square(0, 0, 4)))), [1, 1], [2, 1]);
  state = drawings.stepBack(drawings.stepBack(state));
  assert.deepEqual(state.growing, [0, 1]);
  assert.deepEqual(drawings.stepBack(state), { shape: area(square(0, 0, 4)), growing: null });
  const nothing = drawings.begin(shapes.empty("line"));
  assert.equal(drawings.stepBack(nothing), nothing);
});

test("a hole belongs to the part that it lies in", () => {
  const parts = { kind: "area", parts: [[square(0, 0, 4)], [square(10, 0, 4)]], radius_m: null };
  const hole = clicks(drawings.withHole(drawings.begin(parts)), [11, 1], [12, 1], [12, 2]);
  const { shape } = drawings.ended(hole);
  assert.deepEqual(
    shape.parts.map((part) => part.length),
    [1, 2],
  );
  assert.deepEqual(faultsOf(shape), []);
});

test("a drawing that was left in the middle goes on there", () => {
  assert.deepEqual(drawings.begin(drawn("line", [0, 0]).shape).growing, [0, 0]);
  assert.equal(drawings.begin(area(square(0, 0, 1))).growing, null);
});

test("the pointer shows what would be, and changes nothing", () => {
  const centre = drawn("circle", [9, 47]);
  assert.ok(drawings.preview(centre, [9.01, 47]).radius_m > 700);
  assert.equal(centre.shape.radius_m, 0);
  assert.equal(drawings.preview(drawings.begin(shapes.empty("area")), [0, 0]).parts[0][0].length, 0);
});

test("the side that would close a growing ring is not there yet", () => {
  const state = drawn("area", [0, 0], [4, 0], [4, 4], [2, 4], [2, 1], [3, 3]);
  assert.equal(faultsOf(state.shape, state.growing).length, 0);
  assert.ok(faultsOf(state.shape).length > 0);
});

test("rings may touch in a point, not along a side", () => {
  assert.deepEqual(
    faultsOf(
      area(square(0, 0, 4), [
        [0, 0],
        [2, 1],
        [1, 2],
      ]),
    ),
    [],
  );
  const alongside = { kind: "area", parts: [[square(0, 0, 2)], [square(2, 0, 2)]], radius_m: null };
  assert.match(faultsOf(alongside)[0].message, /parts/);
  const corner = { kind: "area", parts: [[square(0, 0, 2)], [square(2, 2, 2)]], radius_m: null };
  assert.deepEqual(faultsOf(corner), []);
  assert.ok(
    faultsOf(
      area([
        [0, 0],
        [4, 0],
        [4, 4],
        [2, 0],
        [0, 4],
      ]),
    ).length > 0,
  );
});

test("a hole that crosses the border and a part within another are told by their names", () => {
  assert.match(
    faultsOf(
      area(square(0, 0, 4), [
        [1, 1],
        [5, 1],
        [1, 2],
      ]),
    )[0].message,
    /hole crosses/,
  );
  assert.match(
    faultsOf({ kind: "area", parts: [[square(0, 0, 9)], [square(1, 1, 1)]], radius_m: null })[0].message,
    /within another/,
  );
});

test("an area over the 180th meridian is whole, as large as elsewhere, and keeps its holes", () => {
  const over = area(
    [
      [179, 0],
      [-179, 0],
      [-179, 2],
      [179, 2],
    ],
    [
      [179.5, 0.5],
      [-179.5, 0.5],
      [-179.5, 1.5],
    ],
  );
  assert.deepEqual(faultsOf(over), []);
  const same = area(
    [
      [9, 0],
      [11, 0],
      [11, 2],
      [9, 2],
    ],
    [
      [9.5, 0.5],
      [10.5, 0.5],
      [10.5, 1.5],
    ],
  );
  assert.ok(Math.abs(measure(over).area_m2 / measure(same).area_m2 - 1) < 1e-9);
  assert.deepEqual(continuous(over.parts[0][0]), [
    [179, 0],
    [181, 0],
    [181, 2],
    [179, 2],
  ]);
  assert.deepEqual(shapes.middlesOf(over)[0].position, [180, 0]);
  assert.match(
    faultsOf(
      area([
        [179, 0],
        [-179, 2],
        [-179, 0],
        [179, 2],
      ]),
    )[0].message,
    /crosses itself/,
  );
});

test("a shape that is moved over the 180th meridian stays within ±180", () => {
  const { parts } = shapes.moveAll(area(square(178, 0, 1)), [2.5, 0]);
  assert.deepEqual(parts[0][0], [
    [-179.5, 0],
    [-178.5, 0],
    [-178.5, 1],
    [-179.5, 1],
  ]);
});

test("a part is removed with its holes, the last one stays", () => {
  const two = { kind: "area", parts: [[square(0, 0, 4), square(1, 1, 1)], [square(10, 0, 4)]], radius_m: null };
  assert.equal(shapes.removeRing(two, [0, 1, 0]).parts[0].length, 1);
  assert.equal(shapes.removeRing(two, [0, 0, 0]).parts.length, 1);
  const one = area(square(0, 0, 4));
  assert.equal(shapes.removeRing(one, [0, 0, 0]), one);
});
