import assert from "node:assert/strict";
import test from "node:test";

import { cautionOf, cutOffText, factsOf, KINDS } from "../../../static/js/data_issues/kinds.js";

const SPACE = "\u00a0";

test("an issue says what it cuts off, and nothing where that is nothing", () => {
  assert.equal(cutOffText({ kind: "ends_apart", cut_off_m: 34_240 }), `cuts off 34.2${SPACE}km of network`);
  assert.equal(cutOffText({ kind: "line_without_towers", cut_off_m: 905 }), `concerns 905${SPACE}m`);
  assert.equal(cutOffText({ kind: "bridge_without_way", cut_off_m: 0 }), "");
});

test("facts repeat the figure in the words of its kind", () => {
  assert.deepEqual(factsOf({ kind: "tower_on_no_line", details: {}, cut_off_m: 1_200 }), [
    ["Concerns", `1.2${SPACE}km`],
  ]);
  assert.deepEqual(factsOf({ kind: "long_span", details: { beyond_m: 0 }, cut_off_m: 2_400 }), [
    ["Cuts off", `2.4${SPACE}km`],
    ["Beyond it", "also reached another way"],
  ]);
});

test("what cannot be known is said only where it matters", () => {
  assert.match(cautionOf({ kind: "dead_end", details: {} }), /keeps no substations/);
  assert.equal(cautionOf({ kind: "long_span", details: { is_impossible: true } }), "");
  for (const kind of Object.keys(KINDS)) assert.equal(typeof cautionOf({ kind, details: {} }), "string");
});
