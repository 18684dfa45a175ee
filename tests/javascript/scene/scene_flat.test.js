import assert from "node:assert/strict";
import { test } from "node:test";

import { drawGround } from "../../../static/js/scene/flat/flat_ground.js";
import { makeFrame } from "../../../static/js/scene/frame.js";
import { randomScene } from "./random_scene.js";

/** A canvas's context that notes each path that is stroked, with its colour. */
function noting() {
  const strokes = [];
  let path = [];
  const context = {
    strokeStyle: "",
    canvas: { width: 800, height: 600 },
    beginPath() {
      path = [];
    },
    lineTo: (x, y) => path.push([x, y]),
    moveTo: (x, y) => path.push([x, y]),
    stroke() {
      strokes.push({ colour: context.strokeStyle, path });
    },
  };
  for (const name of ["arc", "clip", "closePath", "fill", "restore", "save", "setLineDash"]) context[name] = () => {};
  return { context, strokes };
}

test("from above each ring of a bridge, each railway and each span is a line where it is", () => {
  const scene = randomScene(7);
  const frame = makeFrame(scene.origin);
  const { context, strokes } = noting();
  const onScreen = ([x, , z]) => [x, z];
  const palette = new Proxy({}, { get: (_target, name) => name });
  drawGround(context, { scene, frame, onScreen, palette, metresPerPixel: 1, size: { width: 800, height: 600 } });
  const placed = ([lon, lat]) => onScreen(frame.toLocal(lon, lat, 0));
  const drawn = (colour) => strokes.filter((stroke) => stroke.colour === colour).map(({ path }) => path);

  const rings = scene.bridges.flatMap(({ polygons }) => polygons.flat());
  assert.ok(rings.length > 0);
  assert.deepEqual(
    drawn("bridge"),
    rings.map((ring) => ring.map(placed)),
  );
  assert.deepEqual(
    drawn("railway"),
    scene.railways.map(({ line }) => line.map(placed)),
  );
  const spans = strokes.filter(({ colour }) => colour.startsWith("volt"));
  assert.deepEqual(
    spans.map(({ path }) => path),
    scene.spans.map(({ from, to }) => [from, to].map((place) => placed(scene.supports[place].position))),
  );
});
