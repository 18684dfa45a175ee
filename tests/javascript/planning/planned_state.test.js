/** The chip of a planned mission says what its plan reaches. */

import assert from "node:assert/strict";
import { test } from "node:test";
import { plannedChip } from "../../../static/js/domain/planned_state.js";

test("a plan that reaches all, some or none of its targets has a chip of its own", () => {
  assert.deepEqual(plannedChip(11, 0), { className: "chip planned", words: "Planned" });
  assert.deepEqual(plannedChip(11, 4), { className: "chip aborted", words: "Partly planned, 7 of 11" });
  assert.deepEqual(plannedChip(488, 488), { className: "chip failed", words: "Not possible" });
  assert.deepEqual(plannedChip(0, 0), { className: "chip planned", words: "Planned" });
});
