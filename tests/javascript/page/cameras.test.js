import assert from "node:assert/strict";
import { test } from "node:test";
import { cameraOf, groupsOf, matching } from "../../../static/js/cameras/catalogue.js";
import { cameraText, focalText, gsdAt_mm, readTitle, sourcesOf, standoff_m } from "../../../static/js/cameras/words.js";
import { firstThatReaches } from "../../../static/js/view_plan/cameras.js";
import { bridgeText, byKind, modelText, nothingText, restText, shareText } from "../../../static/js/view_plan/words.js";

const camera = {
  name: "Zoom",
  sensor_width_mm: 6.4,
  sensor_height_mm: 4.8,
  pixels_wide: 8000,
  pixels_high: 6000,
  focal_lengths_mm: [21, 75],
};
const known = {
  ...camera,
  key: "maker-zoom",
  maker: "Maker",
  payload: "Maker M1",
  sources: [
    { title: "Data sheet", url: "https://example.com", date: "2026", figures: ["pixels_wide", "focal_lengths_mm"] },
    { title: "vendor's specification, not verified", url: "", date: "2026", figures: ["sensor_width_mm"] },
  ],
  derived: {},
};

test("a pixel's size follows from distance and the longest focal length, and the other way round", () => {
  assert.ok(Math.abs(standoff_m(camera, 2) - 187.5) < 1e-9);
  assert.ok(Math.abs(gsdAt_mm(camera, 187.5) - 2) < 1e-9);
});

test("a camera is told in one line", () => {
  assert.equal(cameraText(camera), "8,000\u00a0×\u00a06,000 · 21–75\u00a0mm · 2\u00a0mm at 187.5\u00a0m");
  assert.equal(focalText([12.29]), "12.3\u00a0mm");
});

test("sources are those of figures that were not changed, and say what is not verified", () => {
  assert.deepEqual(
    sourcesOf({ ...camera, pixels_wide: 4000 }, known).map(({ figures }) => figures),
    [["focal_lengths_mm"], ["sensor_width_mm"]],
  );
  assert.deepEqual(readTitle(known.sources[1]), { title: "vendor's specification", isVerified: false });
});

test("the catalogue is grouped by payload and found by all words of a text", () => {
  const other = { ...known, key: "sony-a7", maker: "Sony", payload: "a7", name: "a7, 35 mm" };
  assert.deepEqual([...groupsOf([known, other]).keys()], ["Maker M1", "Sony a7"]);
  assert.deepEqual(matching([known, other], " m1 ZOOM"), [known]);
  assert.deepEqual(cameraOf(known), camera);
});

const part = { component: "string", number: 0, area_m2: 3, shown: 0.6, reachable: 0.8, gsd_mm: 1.9, limit: "hidden" };
const other = { ...part, number: 1, area_m2: 1, shown: 0, reachable: 0, gsd_mm: null, limit: "distance" };

test("components of a kind count together by their area", () => {
  const [row] = byKind([part, other]);
  assert.ok(Math.abs(row.ofReachable - 0.75) < 1e-9);
  assert.ok(Math.abs(row.unreachable - 0.4) < 1e-9);
  assert.equal(row.gsd_mm, 1.9);
  assert.equal(restText(row), "40\u00a0% too far from outside the clearance"); // 1 m² of it, 0.6 m² are hidden
  assert.equal(byKind([other])[0].ofReachable, null);
  assert.equal(restText({ ...row, unreachable: 0 }), "");
  assert.equal(shareText(0.999), "99\u00a0%");
});

test("a bridge tells the estimated height of its deck and that places of piers are assumed", () => {
  const bridge = { deck_height_m: 6.5, deck_source: "layer", top_m: 34, length_m: 60, width_m: 12, piers: 1 };
  assert.equal(
    bridgeText({ ...bridge, bearing_deg: 90 }),
    "Model: deck 6.5\u00a0m above ground (estimated), 60\u00a0m × 12\u00a0m, counted as 34\u00a0m high, 1 pier (position assumed).",
  );
  assert.match(
    bridgeText({ ...bridge, deck_source: "tag", piers: 0 }),
    /deck 6.5.m above ground, 60.m × 12.m, counted as 34.m high\.$/,
  );
});

test("the model's assumptions are one sentence", () => {
  const model = { form: "lattice", height_m: 50, height_source: "assumed", voltage_v: 380_000, is_anchor: false };
  assert.equal(modelText(model), "Model: lattice tower, 50\u00a0m (assumed), 380\u00a0kV, suspension.");
  assert.match(
    modelText({ ...model, height_source: "tag", voltage_v: null, is_anchor: true }),
    /50.m, voltage unknown, tension/,
  );
});

test("a plan that shows nothing says what the camera gives, and what to change", () => {
  const plan = { camera, gsd_mm: 0.05, clearance_m: 7.5, coverage: { components: [other] } };
  assert.match(nothingText(plan), /^This camera shows 0.1.mm at the clearance of 7.5.m at best/);
  const blurred = { ...plan, camera: { ...camera, nearest_focus_m: 5 }, coverage: { components: [part] } };
  assert.match(nothingText(blurred), /at the clearance of 7.5.m at best/); // nearer it is sharp, but may not be
  const near = { ...plan, gsd_mm: 0.1, camera: { ...camera, nearest_focus_m: 20 } };
  assert.match(nothingText(near), /^This camera focuses from 20.m on and shows 0.2.mm there/);
  assert.equal(
    nothingText({ ...plan, gsd_mm: 2, coverage: { components: [{ ...part, limit: "height" }] } }),
    "Most of the surface: only from below the least height.",
  );
});

test("a plan begins with the first camera whose longest lens reaches the ground sample distance from the clearance", () => {
  const wide = { camera: { ...camera, focal_lengths_mm: [2] } }; // 2 mm at 5 m
  const far = { camera: { ...camera, nearest_focus_m: 200 } };
  const choices = new Map([
    ["wide", wide],
    ["far", far],
    ["zoom", { camera }], // 2 mm at 187.5 m
    ["other", { camera }],
  ]);
  assert.equal(firstThatReaches(choices, { gsd_mm: 2, clearance_m: 7.5 }), "zoom");
  assert.equal(firstThatReaches(choices, { gsd_mm: 2, clearance_m: 4 }), "wide");
  assert.equal(firstThatReaches(choices, { gsd_mm: 3, clearance_m: 50 }), "far");
  assert.equal(firstThatReaches(choices, { gsd_mm: 2, clearance_m: 190 }), null);
});
