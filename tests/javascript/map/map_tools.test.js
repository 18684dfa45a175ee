import assert from "node:assert/strict";
import test from "node:test";
import { readPalette } from "../../../static/js/domain/palette.js";
import { filterOf } from "../../../static/js/map/look/shown.js";
import { mapStyle } from "../../../static/js/map/look/style.js";
import { BANDS, bandOf, GROUPS, voltageBand } from "../../../static/js/map/look/voltages.js";
import { bearing_deg, measured, measureWords } from "../../../static/js/map/measure_tool.js";

const palette = readPalette((token) => (token === "--font" ? "Inter, sans-serif" : "#808080"));
const style = mapStyle(palette, {
  tilesAddress: "http://here/{z}/{x}/{y}",
  baseMap: { tiles: "" },
  satellite: { tiles: "" },
  under: "",
});

test("every layer that the menu switches is in the style, and no other layer of the tiles is forgotten", () => {
  const switched = GROUPS.flatMap(({ layers }) => layers);
  assert.deepEqual(
    switched.filter((id) => !style.layers.some((layer) => layer.id === id)),
    [],
  );
  assert.deepEqual(
    style.layers.filter((layer) => layer.source === "ground-tiles" && !switched.includes(layer.id)).map(({ id }) => id),
    [],
  );
});

test("bearings are counted from north, clockwise", () => {
  assert.deepEqual(
    [
      [0, 1],
      [1, 0],
      [0, -1],
      [-1, 0],
    ].map((to) => bearing_deg([0, 0], to)),
    [0, 90, 180, 270],
  );
  assert.equal(bearing_deg([179.5, 0], [-179.5, 0]), 90);
});

test("what is measured is told as far as it goes", () => {
  const east = [0.009, 0];
  assert.match(measureWords([]), /Click where/);
  assert.match(measureWords([[0, 0]]), /next point/);
  assert.match(measureWords([[0, 0], east]), /^1\.0\skm · 090°$/);
  assert.match(measureWords([[0, 0]], east), /^1\.0\skm · 090°$/);
  assert.match(measureWords([[0, 0], east], [0.009, 0.009]), /^2\.0\skm · last leg 1\.0\skm · 000° · area 0\.50\skm²$/);
  assert.deepEqual(
    measured([[0, 0], east], [1, 1]).features.map(({ properties }) => properties.role),
    ["point", "point", "path", "next"],
  );
});

test("a voltage falls into the band of its colour", () => {
  assert.deepEqual([765, 380, 379, 138, 99, 50, 0.4, undefined].map(voltageBand), [
    "380",
    "380",
    "200",
    "100",
    "50",
    "50",
    "0",
    "none",
  ]);
  assert.deepEqual(BANDS, ["380", "200", "100", "50", "0", "none"]);
});

test("a filter leaves out hidden voltages of lines and towers, and zones at rest, and nothing more", () => {
  const own = ["has", "voltage"];
  const bands = new Set(["0"]);
  assert.deepEqual(filterOf(own, { group: "lines", bands, resting: [] }), [
    "all",
    own,
    ["!", ["in", bandOf, ["literal", ["0"]]]],
  ]);
  assert.deepEqual(filterOf(null, { group: "zones", bands, resting: [7] }), [
    "all",
    ["!", ["in", ["id"], ["literal", [7]]]],
  ]);
  assert.equal(filterOf(own, { group: "railways", bands, resting: [7] }), own);
  assert.equal(filterOf(null, { group: "towers", bands: new Set(), resting: [] }), null);
});
