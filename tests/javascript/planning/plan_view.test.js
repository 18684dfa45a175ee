import assert from "node:assert/strict";
import test from "node:test";

import { firstDetail } from "../../../static/js/api.js";
import {
  endingOf,
  endingsOf,
  inPlanOrder,
  isPlanCurrent,
  isUnsaved,
  photosOf,
  placesOf,
  pointAlong,
  sentenceOf,
  shownRoute,
  unassignedOf,
} from "../../../static/js/mission/plan/plan_view.js";
import { basisOf, EMPTY, targetOf, withTargets } from "../../../static/js/mission/selection.js";

const target = (id) => targetOf({ id, kind: "tower", properties: { label: `Tower ${id}` }, centre: [id, 50] });
const selection = withTargets(EMPTY, [1, 2, 3].map(target));
const geometry = {
  type: "LineString",
  coordinates: [
    [0, 0],
    [1, 1],
  ],
};
const plan = {
  basis: basisOf(selection),
  targets: selection.targets,
  result: {
    return_to_start: true,
    total_length_m: 42_500,
    routes: [
      { uav: "Heron", targets: [2], length_m: 19_100, duration_s: 1_620, geometry, end_action: "hover" },
      { uav: "Kite", targets: [0], length_m: 23_400, duration_s: 1_980, geometry, end_action: "hover" },
    ],
    unassigned: [{ target: 1, reason: "inside_zone", message: "It stands inside Alum Creek reserve." }],
  },
};
const plain = (text) => text.replaceAll("\u00a0", " ");

test("each target knows its UAV and its number there", () => {
  const places = placesOf(plan);
  assert.deepEqual([places.get("3").letter, places.get("3").number], ["A", 1]);
  assert.equal(places.get("1").letter, "B");
  assert.equal(places.has("2"), false);
});

test("the list follows the plan, those without a route last", () => {
  assert.deepEqual(
    inPlanOrder(selection.targets, placesOf(plan)).map(({ asset }) => asset),
    [3, 1, 2],
  );
});

test("the sentence says what happens, then the figures", () => {
  const { sentence, facts } = sentenceOf(plan);
  assert.equal(plain(sentence), "All back in 33 min");
  assert.equal(plain(facts), "2 of 3 targets · 2 UAVs · 42.5 km");
});

test("UAVs that stay out are not said to be back", () => {
  const open = { ...plan, result: { ...plan.result, return_to_start: false } };
  assert.equal(plain(sentenceOf(open).sentence), "Done in 33 min");
});

test("a route says how its flight ends", () => {
  const route = { letter: "A", targets: [4, 2] };
  assert.equal(endingOf({ ...route, end_action: "hover" }), "ends hovering at A2");
  assert.equal(endingOf({ ...route, end_action: "land" }), "lands at A2");
  assert.equal(endingOf({ ...route, end_action: "return" }), "returns to start");
});

test("the switch says what happens without it", () => {
  const [hovers, lands] = [{ end_action: "hover" }, { end_action: "land" }];
  assert.match(endingsOf({ return_to_start: true, uavs: [hovers] }), /flies back/);
  assert.match(endingsOf({ return_to_start: false, uavs: [hovers, hovers] }), /ends hovering at its last target/);
  assert.match(endingsOf({ return_to_start: false, uavs: [lands] }), /lands at its last target/);
  assert.match(endingsOf({ return_to_start: false, uavs: [hovers, lands] }), /as set for it/);
  assert.match(endingsOf({ return_to_start: false, uavs: [] }), /ends at its last target/);
});

test("what is not reached is told with the server's reason", () => {
  const [{ target: missed, sentence }] = unassignedOf(plan);
  assert.equal(missed.label, "Tower 2");
  assert.equal(sentence, "It stands inside Alum Creek reserve.");
});

test("a plan is current only for the selection it was made for", () => {
  assert.equal(isPlanCurrent({ plan, selection }), true);
  assert.equal(isPlanCurrent({ plan, selection: { ...selection, objective: "total" } }), false);
  assert.equal(isPlanCurrent({ plan: null, selection }), false);
});

test("a stored mission is unsaved once its name, selection or plan differs", () => {
  const stored = {
    mission: { name: "North" },
    name: "North",
    selection,
    plan,
    planIsStored: true,
    savedBasis: basisOf(selection),
  };
  assert.equal(isUnsaved(stored), false);
  assert.equal(isUnsaved({ ...stored, name: "South" }), true);
  assert.equal(isUnsaved({ ...stored, planIsStored: false }), true);
  assert.equal(isUnsaved({ ...stored, selection: { ...selection, return_to_start: false } }), true);
  assert.equal(isUnsaved({ ...stored, mission: null, name: "", selection: EMPTY, plan: null }), false);
});

test("the first fault is found in nested details", () => {
  assert.equal(
    firstDetail({ targets: { 1: { asset: ["There is no asset 99."] } } }),
    "targets 1 asset: There is no asset 99.",
  );
  assert.equal(firstDetail({ non_field_errors: ["Too many."] }), "Too many.");
  assert.equal(firstDetail(null), "");
});

test("the route that is changed by hand is shown as it would be flown, whichever is the longest or chosen", () => {
  const original = [{ position: [0, 0], altitude_agl_m: 60, speed_mps: null, was: 0, kind: "start" }];
  const moved = [{ ...original[0], altitude_agl_m: 80 }];
  const flown = { waypoints: [{ position: [0, 0], altitude_amsl_m: 280 }], arrival_s: [0] };
  const look = { length_m: 20_000, duration_s: 1_700, flown };
  const shown = (hand) => shownRoute({ plan, lookedAt: null, chosenRoute: 1, hand });
  assert.equal(shown(null).name, "Kite");
  assert.deepEqual(
    [
      shown({ sequence: 0, original, points: original, look }).name,
      shown({ sequence: 0, original, points: original, look }).length_m,
    ],
    ["Heron", 19_100],
  );
  const wished = shown({ sequence: 0, original, points: moved, look });
  assert.deepEqual([wished.name, wished.length_m, wished.isWished], ["Heron", 20_000, true]);
  assert.equal(wished.waypoints, flown.waypoints); // the same while the server has said nothing new
  assert.equal(shown({ sequence: 0, original, points: moved, look: { ...look, flown: null } }).length_m, 19_100);
});

test("the pointer's place is on the stored route, and on the changed one where it is on that one's profile", () => {
  const at = (lon, lat, kind = "pass") => ({
    position: [lon, lat],
    altitude_agl_m: 60,
    kind,
    asset: null,
    target: null,
  });
  const stored = {
    uav: "Heron",
    targets: [],
    length_m: 2000,
    duration_s: 100,
    geometry,
    end_action: "hover",
    waypoints: [at(10, 50, "start"), at(10.02, 50, "end")],
  };
  const now = {
    plan: { ...plan, result: { ...plan.result, routes: [stored] } },
    lookedAt: null,
    chosenRoute: null,
    hand: null,
  };
  const near = (place, expected) => {
    for (const [index, degrees] of place.entries())
      assert.ok(Math.abs(degrees - expected[index]) < 1e-6, `${place} is not ${expected}`);
  };
  near(pointAlong({ ...now, along: { sequence: 0, at_m: 1000, isWished: false } }), [10.01, 50]);
  const original = [{ position: [10, 50], altitude_agl_m: 60, speed_mps: null, was: 0, kind: "start" }];
  const look = {
    length_m: 4000,
    duration_s: 200,
    flown: { waypoints: [at(10, 50, "start"), at(10, 50.02), at(10.02, 50, "end")], arrival_s: [0] },
  };
  const hand = { sequence: 0, original, points: [{ ...original[0], altitude_agl_m: 80 }], look };
  const [lon, lat] = pointAlong({ ...now, hand, along: { sequence: 0, at_m: 500, isWished: true } });
  assert.equal(lon, 10);
  assert.ok(lat > 50.002);
  near(pointAlong({ ...now, hand, along: { sequence: 0, at_m: 1000, isWished: false } }), [10.01, 50]);
  assert.equal(pointAlong({ ...now, along: { sequence: 0, at_m: 500, isWished: true } }), null); // it is not changed any more
  assert.equal(pointAlong({ ...now, along: null }), null);
});

test("photos of every part are where their waypoints have a view", () => {
  const view = { yaw_deg: 120, pitch_deg: -10, distance_m: 20, focal_length_mm: 55, clearance_m: 9, heading_deg: null };
  const waypoints = [
    { position: [1, 2], task: null },
    { position: [3, 4], task: { kind: "photo", hold_s: 3, view } },
    { position: [5, 6], task: { kind: "photo", hold_s: 10 } },
  ];
  assert.deepEqual(photosOf([{ waypoints }, { waypoints: [] }]), [{ position: [3, 4], yaw_deg: 120 }]);
});
