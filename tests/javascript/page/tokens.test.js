import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import test from "node:test";

import { contrast, readPalette } from "../../../static/js/domain/palette.js";
import { mapStyle } from "../../../static/js/map/look/style.js";
import { PICKABLE, voltageColour } from "../../../static/js/map/look/voltages.js";

const css = readFileSync(new URL("../../../static/css/tokens.css", import.meta.url), "utf8").replace(
  /\/\*[\s\S]*?\*\//g,
  "",
);

function tokensOf(selector) {
  const start = css.indexOf(`${selector} {`);
  assert.ok(start >= 0, selector);
  const block = css.slice(css.indexOf("{", start) + 1, css.indexOf("}", start));
  return Object.fromEntries(
    [...block.matchAll(/(--[\w-]+):\s*([^;]+);/g)].map(([, name, value]) => [name, value.trim()]),
  );
}

const light = tokensOf(":root");
const dark = { ...light, ...tokensOf(':root[data-theme="dark"]') };
const systemDark = { ...light, ...tokensOf(":root:not([data-theme])") };
const themes = { light, dark };

const TEXT = [
  ["--ink", "--panel"],
  ["--ink", "--ground"],
  ["--ink", "--raised"],
  ["--ink-2", "--panel"],
  ["--ink-2", "--ground"],
  ["--ink-2", "--sunken"],
  ["--ink-2", "--raised"],
  ["--ink-3", "--panel"],
  ["--ink-3", "--sunken"],
  ["--on-ink", "--ink"],
  ["--accent", "--panel"],
  ["--accent", "--accent-soft"],
  ["--on-accent", "--accent"],
  ["--critical", "--panel"],
  ["--critical", "--critical-soft"],
  ["--ink", "--critical-soft"],
  ["--warning", "--warning-soft"],
  ["--ink", "--warning-soft"],
  ["--advisory", "--advisory-soft"],
  ["--on-alert", "--critical"],
  ["--zone", "--raised"],
  ["--map-label", "--ground"],
];
const SHAPES = [
  ["--outline", "--panel"],
  ["--outline", "--ground"],
  ["--focus", "--panel"],
  ["--focus", "--ground"],
  ["--warning-mark", "--panel"],
  ...[
    "--volt-400",
    "--volt-220",
    "--volt-132",
    "--volt-66",
    "--volt-20",
    "--volt-unknown",
    "--tower",
    "--railway",
    "--bridge",
    "--zone",
    "--select",
  ].map((token) => [token, "--ground"]),
  ...Array.from({ length: 8 }, (_, index) => [`--route-${index + 1}`, "--ground"]),
];

for (const [theme, tokens] of Object.entries(themes)) {
  test(`text has 4.5:1 in ${theme}`, () => {
    for (const [ink, paper] of TEXT)
      assert.ok(
        contrast(tokens[ink], tokens[paper]) >= 4.5,
        `${ink} on ${paper}: ${contrast(tokens[ink], tokens[paper]).toFixed(2)}`,
      );
  });

  test(`controls and what is drawn on the map have 3:1 in ${theme}`, () => {
    for (const [shape, paper] of SHAPES)
      assert.ok(
        contrast(tokens[shape], tokens[paper]) >= 3,
        `${shape} on ${paper}: ${contrast(tokens[shape], tokens[paper]).toFixed(2)}`,
      );
  });

  test(`a UAV's letter has 4.5:1 on its colour in ${theme}`, () => {
    for (let route = 1; route <= 8; route += 1)
      assert.ok(contrast(tokens["--on-route"], tokens[`--route-${route}`]) >= 4.5, `route ${route}`);
  });

  test(`the map's style in ${theme} knows every colour and asks for nothing outside`, () => {
    const palette = readPalette((token) => tokens[token]);
    const style = mapStyle(palette, {
      tilesAddress: "/api/v1/tiles/{z}/{x}/{y}",
      baseMap: { tiles: "" },
      satellite: { tiles: "" },
      under: "",
    });
    const text = JSON.stringify(style);
    assert.ok(!text.includes("undefined") && !text.includes("null"), "a token is missing");
    assert.ok(!/https?:/.test(text));
    assert.equal(style.glyphs, undefined);
    const ids = style.layers.map((layer) => layer.id);
    assert.equal(new Set(ids).size, ids.length);
    for (const id of PICKABLE) assert.ok(ids.includes(id), id);
    for (const layer of style.layers) assert.ok(layer.type === "background" || style.sources[layer.source], layer.id);
  });
}

test("the two dark blocks are equal", () => {
  assert.deepEqual(systemDark, dark);
});

test("a line's colour goes by its highest voltage", () => {
  const palette = readPalette((token) => light[token]);
  assert.equal(voltageColour(palette, 400), palette.volt400);
  assert.equal(voltageColour(palette, 380), palette.volt400);
  assert.equal(voltageColour(palette, 379), palette.volt220);
  assert.equal(voltageColour(palette, 138), palette.volt132);
  assert.equal(voltageColour(palette, 50), palette.volt66);
  assert.equal(voltageColour(palette, 20), palette.volt20);
  assert.equal(voltageColour(palette, undefined), palette.voltUnknown);
});

test("towers of 200 kV and over are drawn from zoom 10, the others from 10.6", () => {
  const palette = readPalette((token) => light[token]);
  const { layers } = mapStyle(palette, { tilesAddress: "", baseMap: null, satellite: null, under: "" });
  const [high, all] = ["towers-high", "towers"].map((id) => layers.find((layer) => layer.id === id));
  assert.deepEqual([high.minzoom, high.maxzoom, all.minzoom], [10, 10.6, 10.6]);
  const isNoPole = ["!", ["==", ["get", "subtype"], "pole"]];
  assert.deepEqual(high.filter, ["all", isNoPole, [">=", ["coalesce", ["get", "voltage"], -1], 200]]);
  assert.deepEqual(all.filter, isNoPole);
  assert.equal(layers.find((layer) => layer.id === "towers-ring").filter, undefined); // from here on poles too
});

test("routes lie over lines and zone hatching under them", () => {
  const palette = readPalette((token) => light[token]);
  const ids = mapStyle(palette, { tilesAddress: "", baseMap: null, satellite: null, under: "" }).layers.map(
    (layer) => layer.id,
  );
  const order = [
    "ground",
    "graticule",
    "zones-fill",
    "zones-hatch",
    "railways",
    "bridges",
    "lines-casing",
    "lines",
    "towers",
    "zones-outline",
    "routes-casing",
    "routes",
    "routes-arrows",
    "line-labels",
  ];
  const places = order.map((id) => ids.indexOf(id));
  assert.ok(
    places.every((place) => place >= 0),
    `missing: ${order.filter((id) => !ids.includes(id))}`,
  );
  assert.deepEqual(
    places,
    [...places].sort((a, b) => a - b),
  );
});
