import assert from "node:assert/strict";
import test from "node:test";

import { outlineOf, parseGeometry, pointText, positionsOf } from "../../../static/js/admin/geometry_text.js";

const RING = [
  [10, 56],
  [11, 56],
  [11, 57],
  [10, 56],
];

test("a geometry in the text is found, with its positions", () => {
  const { geometry, fault } = parseGeometry(JSON.stringify({ type: "MultiPolygon", coordinates: [[RING]] }));
  assert.equal(fault, undefined);
  assert.deepEqual(positionsOf(geometry), RING);
});

test("what is no geometry is told in a sentence", () => {
  for (const text of [
    "{",
    "null",
    "3",
    '{"type": "Point"}',
    '{"type": "LineString", "coordinates": []}',
    '{"type": "Point", "coordinates": [500, 95]}',
    '{"type": "Point", "coordinates": ["a", 1]}',
  ]) {
    assert.match(parseGeometry(text).fault, /\.$/, text);
  }
});

test("empty text is neither a geometry nor a fault", () => {
  assert.deepEqual(parseGeometry(" \n"), {});
});

test("every ring and line is drawn as a path", () => {
  const paths = (geometry) => outlineOf(geometry).geometry.coordinates;
  assert.deepEqual(paths({ type: "LineString", coordinates: RING }), [RING]);
  assert.deepEqual(paths({ type: "Polygon", coordinates: [RING, RING] }), [RING, RING]);
  assert.deepEqual(paths({ type: "MultiPolygon", coordinates: [[RING], [RING]] }), [RING, RING]);
});

test("a dragged point is written to the centimetre", () => {
  assert.equal(pointText(10.123456789, -56), '{"type":"Point","coordinates":[10.1234568,-56]}');
});
