import assert from "node:assert/strict";
import { test } from "node:test";
import { certaintyText } from "../../../static/js/scene/instruments/readings.js";
import { ESTIMATED, MEASURED } from "../../../static/js/scene/sources/pieces.js";

test("the place of a simulated UAV is never called measured", () => {
  assert.equal(certaintyText({ kind: MEASURED }, false), "measured");
  assert.equal(certaintyText({ kind: MEASURED }, true), "simulated");
  assert.match(certaintyText({ kind: ESTIMATED, bound: { along_m: 12, across_m: 3 } }, true), /^estimated/);
});
