import assert from "node:assert/strict";
import test from "node:test";

import { factsOf, voidsText } from "../../../static/js/terrain/model_list.js";
import {
  EDGES,
  nearestSample,
  profileSentence,
  rowsOf,
  rulesOf,
  scalesOf,
  stretchesOf,
  towersAlong,
} from "../../../static/js/terrain/profile_chart.js";

const SPACE = "\u00a0";
const profile = {
  length_m: 400,
  distance_m: [0, 100, 200, 300, 400],
  positions: [
    [9, 47],
    [9.001, 47],
    [9.002, 47],
    [9.003, 47],
    [9.004, 47],
  ],
  ground_amsl_m: [500, 520, null, 510, 505],
  lowest_m: 500,
  highest_m: 520,
};
const nowhere = { ...profile, ground_amsl_m: [null, null, null, null, null], lowest_m: null, highest_m: null };
const tower = (position, height_m) => ({
  geometry: { type: "Point", coordinates: position },
  properties: { label: "T1", height_m },
});

test("a stretch without terrain stands between those with it", () => {
  assert.deepEqual(stretchesOf(profile.ground_amsl_m), [
    { isKnown: true, from: 0, to: 1 },
    { isKnown: false, from: 2, to: 2 },
    { isKnown: true, from: 3, to: 4 },
  ]);
});

test("the drawing reaches from the lowest ground to the highest tower", () => {
  const scales = scalesOf(profile, [{ top_amsl_m: 560 }, { top_amsl_m: null }], 600, 150);
  assert.deepEqual([scales.low, scales.high], [500, 560]);
  assert.equal(scales.x(0), EDGES.left);
  assert.equal(scales.x(400), 600 - EDGES.right);
  assert.equal(scales.y(560), EDGES.top);
  assert.equal(scales.y(500), 150 - EDGES.bottom);
  assert.equal(scales.distanceAt(scales.x(120)), 120);
  assert.equal(scales.distanceAt(-50), 0);
});

test("a plain does not look like mountains, and nothing known is not drawn", () => {
  const flat = { ...profile, ground_amsl_m: [500, 500, 501, 500, 500] };
  const scales = scalesOf(flat, [], 600, 150);
  assert.equal(scales.high - scales.low, 20);
  assert.equal(scalesOf(nowhere, [], 600, 150), null);
});

test("at most three rules, at round heights within the drawing", () => {
  for (const [low, high] of [
    [500, 520],
    [0, 8848],
    [-3, 17],
    [1203.4, 1260.9],
    [-430, -380],
  ]) {
    const rules = rulesOf(low, high);
    assert.ok(rules.length >= 1 && rules.length <= 3, `${low} to ${high}: ${rules}`);
    assert.ok(rules.every((rule) => rule >= low && rule <= high));
  }
  assert.deepEqual(rulesOf(500, 520), [500, 510, 520]);
});

test("the cursor stands at the nearest sample", () => {
  assert.equal(nearestSample(profile.distance_m, 149), 1);
  assert.equal(nearestSample(profile.distance_m, 151), 2);
  assert.equal(nearestSample(profile.distance_m, 9_999), 4);
  assert.equal(nearestSample([0], 5), 0);
});

test("towers stand where the line has a vertex, and an unknown height or ground gives no top", () => {
  const found = towersAlong(profile, [
    tower([9.001, 47], 40),
    tower([9.002, 47], 40),
    tower([9.003, 47], null),
    tower([9.5, 47], 40),
  ]);
  assert.deepEqual(
    found.map(({ index, top_amsl_m }) => [index, top_amsl_m]),
    [
      [1, 560],
      [2, null],
      [3, null],
    ],
  );
});

test("the sentence says what is not known", () => {
  assert.equal(
    profileSentence(profile),
    `400${SPACE}m, ground from 500${SPACE}m to 520${SPACE}m above sea level, unknown at 1 place of 5.`,
  );
  assert.equal(profileSentence(nowhere), `400${SPACE}m; no terrain model knows the ground here.`);
});

test("the table has both ends and every tower, however long the line is", () => {
  const many = {
    ...profile,
    distance_m: Array.from({ length: 1_000 }, (_, index) => index),
    ground_amsl_m: Array(1_000).fill(1),
  };
  const rows = rowsOf(many, [{ index: 501 }]);
  assert.ok(rows.length < 60);
  assert.deepEqual([rows[0].index, rows.at(-1).index], [0, 999]);
  assert.ok(rows.some(({ index, tower: at }) => index === 501 && at));
});

test("a few voids are not rounded to none, and what was not counted is said", () => {
  assert.equal(voidsText({ posts: 1_000_000, voids: 3 }), `3 posts, under 0.1${SPACE}%`);
  assert.equal(voidsText({ posts: 1_000, voids: 125 }), `125 posts, 12.5${SPACE}%`);
  assert.equal(voidsText({ posts: 1_000, voids: 0 }), "none");
  assert.equal(voidsText({ posts: null, voids: null }), "not counted");
});

test("a model without a stated source or licence says so", () => {
  const facts = Object.fromEntries(
    factsOf({
      posts: 4,
      voids: 0,
      lowest_m: -2.4,
      highest_m: 804,
      vertical_datum: "EGM96",
      resolution_m: 31,
      attribution: "",
      licence: "",
      is_synthetic: false,
      imported_at: "2025-01-02T00:00:00Z",
    }),
  );
  assert.deepEqual(
    [facts.Source, facts.Licence, facts.Heights, facts["Vertical datum"]],
    ["not stated", "not stated", `−2${SPACE}m to 804${SPACE}m`, "EGM96"],
  );
});
