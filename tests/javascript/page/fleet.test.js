import assert from "node:assert/strict";
import { test } from "node:test";
import { blankBody, bodyOf } from "../../../static/js/fleet/bodies.js";
import { KINDS } from "../../../static/js/fleet/kinds.js";
import { ageText, flat, fromType, rangeText } from "../../../static/js/fleet/words.js";
import { BOUNDS, boundsIn, usualOf } from "../../../static/js/uav_figures.js";

const feature = {
  type: "Feature",
  id: 7,
  geometry: { type: "Point", coordinates: [26.5, 25.7, 12] },
  properties: {
    name: "Kestrel 1",
    type: 2,
    type_name: "Kestrel",
    base: 3,
    base_name: "Depot",
    state: "active",
    serial_number: "",
    mavlink_system_id: null,
    max_range_m: 60000,
    cruise_speed_mps: 9,
    battery_percent: 80,
    sensor: "",
    sensors: ["Lidar"],
    end_action: "hover",
    from_type: ["max_range_m"],
    located_at: null,
    mission_count: 0,
    credentials: [],
    revision: 4,
  },
};

test("a UAV of the API becomes one object with its place", () => {
  const uav = flat(feature);
  assert.deepEqual(uav.position, [26.5, 25.7]);
  assert.equal(uav.id, 7);
  assert.equal(uav.name, "Kestrel 1");
});

test("what a UAV has from its type is not sent back as its own", () => {
  const body = bodyOf("uavs", flat(feature));
  assert.equal(body.max_range_m, null);
  assert.equal(body.cruise_speed_mps, 9);
});

test("only what can be written is in a body", () => {
  const body = bodyOf("uavs", flat(feature));
  for (const name of ["id", "revision", "sensors", "type_name", "mission_count", "credentials", "located_at", "state"])
    assert.ok(!(name in body), name);
});

test("a blank row of each kind has every field of its body", () => {
  for (const tab of Object.keys(KINDS)) {
    const blank = blankBody(tab);
    assert.deepEqual(bodyOf(tab, { ...blank, from_type: [] }), blank, tab);
    assert.ok(!Object.values(blank).includes(undefined), tab);
  }
});

test("figures say where they come from and what is not known", () => {
  const uav = flat(feature);
  assert.equal(fromType(uav, "max_range_m", rangeText(uav.max_range_m)), "60.0\u00a0km, as its type");
  assert.equal(fromType(uav, "cruise_speed_mps", "9\u00a0m/s"), "9\u00a0m/s");
  assert.equal(rangeText(null), "not stated");
  assert.equal(rangeText(null, true), "unlimited");
  assert.equal(ageText(uav), "age not known");
});

test("each kind counts itself in words", () => {
  assert.deepEqual(
    Object.values(KINDS).map((kind) => [kind.count(1), kind.count(2)]),
    [
      ["1 UAV", "2 UAVs"],
      ["1 type", "2 types"],
      ["1 base", "2 bases"],
    ],
  );
});

test("what a UAV has no figure of its own for is its type's, an Iris's mass with a battery of its type, else not known", () => {
  assert.deepEqual(usualOf({ battery_wh: 400, mass_kg: null, reserve_percent: 25, max_airspeed_mps: 14 }), {
    battery_wh: 400,
    mass_kg: 1.545,
    reserve_percent: 25,
    max_airspeed_mps: 14,
  });
  assert.deepEqual(usualOf(null), { battery_wh: null, mass_kg: null, reserve_percent: 20, max_airspeed_mps: null });
});

test("bounds in miles per hour lie within those in metres a second", () => {
  const { min, max } = boundsIn("max_airspeed_mps", 0.44704);
  assert.ok(min * 0.44704 >= BOUNDS.max_airspeed_mps.min && max * 0.44704 <= BOUNDS.max_airspeed_mps.max);
  assert.deepEqual([min, max], [2.3, 223.6]);
  assert.deepEqual(boundsIn("mass_kg", 1), BOUNDS.mass_kg);
});
