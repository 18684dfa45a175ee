import assert from "node:assert/strict";
import test from "node:test";

import { questionOf, reachabilityOf, reachText } from "../../../static/js/mission/map/reachable.js";
import { EMPTY } from "../../../static/js/mission/selection.js";

const plain = (text) => text.replaceAll("\u00a0", " ");
const heron = { id: 3, name: "Heron", position: [9, 49], max_range_m: null, cruise_speed_mps: 12, end_action: "hover" };
const answer = {
  flights: [{ uav: 0, base: null }],
  reasons: [
    { code: "beyond_range", message: "The range is too short.", count: 1 },
    { code: "partly_reachable", message: "Some spans can be inspected.", count: 1 },
  ],
  assets: { ids: [2, 5, 9], code: [0, 1, 2], flight: [0, -1, -1], missing_m: [0, 3200, 0] },
};

test("the question is of UAVs, ends, departure and air, whatever is picked", () => {
  assert.equal(questionOf(EMPTY), null);
  const asked = questionOf({ ...EMPTY, uavs: [heron], departs_at: "2026-11-21T18:30:00.000Z" });
  assert.deepEqual(Object.keys(asked).sort(), ["departs_at", "return_to_start", "uavs"]);
});

test("each asset has its reachability, and one that the answer does not speak of has none", () => {
  assert.deepEqual(
    [2, 5, 9, 1, 7, 10].map((id) => reachabilityOf(answer, id)),
    ["yes", "no", "partly", "", "", ""],
  );
});

test("an asset says who flies least to it, what is missing, or the reason", () => {
  assert.equal(reachText(answer, 2, [heron]), "Can be inspected: Heron has the shortest way.");
  assert.equal(plain(reachText(answer, 5, [heron])), "Out of range: 3.2 km are missing at best.");
  assert.equal(reachText(answer, 9, [heron]), "Some spans can be inspected.");
  assert.equal(reachText(answer, 7, [heron]), "");
});
