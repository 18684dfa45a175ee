import assert from "node:assert/strict";
import { test } from "node:test";
import { campaignOf, whyNoCampaign } from "../../../static/js/mission/options/launch_sites.js";
import { EMPTY, targetOf } from "../../../static/js/mission/selection.js";

const uav = { id: 4, name: "Kestrel 1", position: [9.5, 47.1], max_range_m: 24_000, cruise_speed_mps: 12 };
const target = targetOf({ id: 7, kind: "tower", properties: { label: "Tower 7" }, centre: [9.51, 47.1] });
const selection = {
  ...EMPTY,
  uavs: [uav],
  targets: [target],
  locks: [{ uav: "Kestrel 1", targets: [target.key], at_start: true, at_end: false }],
  departs_at: "2026-12-01T09:00:00Z",
  return_to_start: true,
};

test("a campaign has targets, UAVs and objective of the mission, without departure, locks and ends", () => {
  const { uavs, targets, ...rest } = campaignOf({ name: " Line 7 ", selection });
  assert.deepEqual(
    uavs.map(({ id }) => id),
    [4],
  );
  assert.deepEqual(targets, [{ asset: 7 }]);
  assert.deepEqual(rest, { name: "Line 7", objective: EMPTY.objective });
});

test("without a name it is called after its targets", () => {
  assert.equal(campaignOf({ name: "", selection }).name, "Tower 7");
});

test("it says what is missing", () => {
  assert.equal(whyNoCampaign({ selection }), "");
  assert.equal(whyNoCampaign({ selection: { ...selection, uavs: [] } }), "Add a UAV first.");
  assert.equal(whyNoCampaign({ selection: EMPTY }), "Add targets first.");
});
