/** The page of assets: voltages as people write them. */

import assert from "node:assert/strict";
import { test } from "node:test";

import { voltsOf } from "../../../static/js/assets/voltages.js";

test("voltages are read with and without their unit, highest first, each once", () => {
  assert.deepEqual(voltsOf("20 kV; 110kV"), [110_000, 20_000]);
  assert.deepEqual(voltsOf("110, 20, 110"), [110_000, 20_000]);
  assert.deepEqual(voltsOf("0.4"), [400]);
  assert.deepEqual(voltsOf(""), []);
});

test("what is no voltage is told, not left out", () => {
  for (const words of ["110, high", "-20", "0", "2001", "1e9", "20 V"]) assert.equal(voltsOf(words), null, words);
});
