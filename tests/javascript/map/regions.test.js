import assert from "node:assert/strict";
import test from "node:test";
import { regionAt, sourcesInView, zoomOfRegion } from "../../../static/js/domain/regions.js";
import { featuresOf } from "../../../static/js/map/layers/regions.js";
import { positionsOf } from "../../../static/js/map/look/outline.js";
import { countsText } from "../../../static/js/map/look/region_words.js";

const region = (id, extent, facts = {}) => ({
  id,
  name: `Region ${id}`,
  extent,
  counts: { tower: 488, line: 1 },
  is_synthetic: false,
  attribution: [],
  ...facts,
});
const JURA = region(1, [7.1, 47, 7.5, 47.4], { attribution: ["OpenStreetMap"] });
const DEMO = region(2, [-83.2, 39.8, -82.8, 40.2], {
  is_synthetic: true,
  attribution: ["OpenStreetMap", "made by Spanwise"],
});
const GROUND = { attribution: ["OpenStreetMap", "made by Spanwise", "Zones of all"], is_synthetic: true };

test("the region at a place is the smallest one", () => {
  const inner = region(3, [7.2, 47.1, 7.3, 47.2]);
  assert.equal(regionAt([JURA, inner, DEMO], [7.25, 47.15]), inner);
  assert.equal(regionAt([JURA, inner, DEMO], [7.4, 47.3]), JURA);
  assert.equal(regionAt([JURA, DEMO], [0, 0]), null);
});

test("demo data have their badge and credit only where they are in view", () => {
  const there = sourcesInView(GROUND, [JURA, DEMO], [-84, 39, -83, 40]);
  assert.deepEqual(there, { attribution: GROUND.attribution, isDemo: true });
  const away = sourcesInView(GROUND, [JURA, DEMO], [7, 47, 7.2, 47.2]);
  assert.deepEqual(away, { attribution: ["OpenStreetMap", "Zones of all"], isDemo: false });
});

test("without regions the badge follows the whole of the map data", () => {
  assert.equal(sourcesInView(GROUND, [], [0, 0, 1, 1]).isDemo, true);
  assert.deepEqual(sourcesInView(null, [], [0, 0, 1, 1]), { attribution: [], isDemo: false });
});

test("a region is a dot with its name and counts until it is large enough to be seen", () => {
  const [feature] = featuresOf([JURA]);
  assert.deepEqual(feature.geometry.coordinates, [7.3, 47.2]);
  assert.deepEqual([feature.properties.name, feature.properties.counts], ["Region 1", "488 towers, 1 line"]);
  assert.ok(Math.abs(feature.properties.until - Math.log2((120 * 360) / (512 * 0.4))) < 1e-6);
  assert.ok(zoomOfRegion([0, 0, 90, 40]) < 1);
  assert.ok(Number.isFinite(zoomOfRegion([5, 5, 5, 5])));
});

test("a region without assets says so", () => {
  assert.equal(countsText({}), "no assets");
  assert.equal(countsText({ zone: 2, terrain: 1, tower: 0 }), "2 zones, 1 terrain model");
});

test("a line of the outline is its first position and steps of a hundredth of a degree", () => {
  assert.deepEqual(positionsOf([-18000, 9000, 150, -25, 1, 0]), [
    [-180, 90],
    [-178.5, 89.75],
    [-178.49, 89.75],
  ]);
});
