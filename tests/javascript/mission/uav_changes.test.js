import assert from "node:assert/strict";
import { test } from "node:test";
import { basisOf, EMPTY, requestOf, storedBasisOf } from "../../../static/js/mission/selection.js";
import { factsOfUav } from "../../../static/js/mission/uavs/fleet.js";
import {
  changeWords,
  figuresInMission,
  openChanges,
  withFleetFigures,
  withPresentFigures,
} from "../../../static/js/mission/uavs/uav_changes.js";

const kite = {
  id: 7,
  name: "Kite",
  position: [9, 49],
  max_range_m: null,
  cruise_speed_mps: 10,
  battery_wh: 56.6,
  mass_kg: 1.545,
  reserve_percent: 20,
  max_airspeed_mps: null,
  sensors: ["RGB"],
  own_figures: [],
};
const picked = { ...EMPTY, uavs: [kite] };
const shrunk = { uav: 0, id: 7, name: "Kite", state: null, figures: [{ name: "battery_wh", kept: 56.6, now: 40 }] };

test("a change is open until the selection has taken it over, and again after that is undone", () => {
  assert.deepEqual(
    openChanges(picked, [shrunk]).map(({ figures }) => figures),
    [shrunk.figures],
  );
  const taken = withPresentFigures(picked, [shrunk]);
  assert.equal(taken.uavs[0].battery_wh, 40);
  assert.deepEqual(openChanges(taken, [shrunk]), []);
  assert.deepEqual(openChanges({ ...picked, uavs: [] }, [shrunk]), []);
});

test("a change is told in figures that differ", () => {
  assert.equal(changeWords(shrunk), "Kite: battery 56.6 → 40\u00a0Wh.");
  const many = {
    ...shrunk,
    state: "maintenance",
    figures: [
      { name: "max_range_m", kept: null, now: 12_000 },
      { name: "mass_kg", kept: 1.54501, now: 1.54502 },
      { name: "sensors", kept: ["Thermal"], now: [] },
    ],
  };
  assert.equal(
    changeWords(many),
    "Kite: range not stated → 12\u00a0km, mass 1.54501 → 1.54502\u00a0kg, sensors Thermal → none, is in maintenance.",
  );
});

test("what a mission has none of is said so: the fleet's own is not meant", () => {
  const { uavs } = requestOf({ ...picked, uavs: [{ ...kite, battery_wh: null }] });
  assert.deepEqual(
    [uavs[0].battery_wh, uavs[0].max_airspeed_mps, uavs[0].sensors, uavs[0].own_figures],
    [null, null, ["RGB"], []],
  );
  assert.ok(!("battery_wh" in requestOf({ ...picked, uavs: [{ ...kite, battery_wh: undefined }] }).uavs[0]));
});

test("what is typed for a mission is its own, unless it is left to the fleet or says the same", () => {
  const known = {
    max_range_m: null,
    cruise_speed_mps: 12,
    usual: { battery_wh: 40, mass_kg: 1.545, reserve_percent: 20, max_airspeed_mps: null },
  };
  const values = {
    max_range_m: null,
    cruise_speed_mps: 8,
    battery_wh: null,
    mass_kg: 1.545,
    reserve_percent: 30,
    max_airspeed_mps: null,
  };
  const said = figuresInMission({ ...kite, own_figures: ["battery_wh"] }, values, known);
  assert.deepEqual(said.own_figures, ["cruise_speed_mps", "reserve_percent"]);
  assert.equal(said.battery_wh, undefined);
  assert.deepEqual(
    figuresInMission(
      { ...kite, own_figures: ["cruise_speed_mps"] },
      { ...values, cruise_speed_mps: 12, reserve_percent: 20 },
      known,
    ).own_figures,
    [],
  );
});

test("whose a figure is makes no other plan, and another mission to store", () => {
  const own = { ...picked, uavs: [{ ...kite, own_figures: ["battery_wh"] }] };
  assert.equal(basisOf(own), basisOf(picked));
  assert.notEqual(storedBasisOf(own), storedBasisOf(picked));
});

test("a row says the battery that counts in the mission, else the fleet's", () => {
  assert.match(factsOfUav(kite, true), /56\.6\u00a0Wh/);
  assert.match(factsOfUav({ ...kite, battery_wh: undefined, usual: { battery_wh: 40 } }, true), /40\u00a0Wh/);
  assert.doesNotMatch(factsOfUav({ ...kite, battery_wh: null, usual: { battery_wh: 40 } }, true), /Wh/);
});

test("what the mission says itself is told when the fleet's changes, until the fleet's is taken or another is said", () => {
  const own = { ...picked, uavs: [{ ...kite, cruise_speed_mps: 7, own_figures: ["cruise_speed_mps"] }] };
  const reported = {
    uav: 0,
    id: 7,
    name: "Kite",
    state: null,
    figures: [],
    said: [{ name: "cruise_speed_mps", said: 7, then: 10, now: 9 }],
  };
  assert.equal(
    changeWords(openChanges(own, [reported])[0]),
    "Kite: speed 10 → 9\u00a0m/s in the fleet, but not in this mission.",
  );
  const taken = withFleetFigures(own, openChanges(own, [reported]));
  assert.deepEqual([taken.uavs[0].cruise_speed_mps, taken.uavs[0].own_figures], [9, []]);
  assert.deepEqual(openChanges(taken, [reported]), []);
  assert.deepEqual(openChanges({ ...own, uavs: [{ ...own.uavs[0], cruise_speed_mps: 6 }] }, [reported]), []);
});
