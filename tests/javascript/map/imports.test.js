import assert from "node:assert/strict";
import test from "node:test";

import { countedText } from "../../../static/js/domain/counted.js";
import { tableOf } from "../../../static/js/imports/changes.js";
import { placeOfSign } from "../../../static/js/imports/changes_layer.js";
import { mappingOf, meaningsOf, withMeaning } from "../../../static/js/imports/column_mapping.js";
import { guessKind, setNameOf, whyNotSent } from "../../../static/js/imports/kinds.js";
import { areaKm2 } from "../../../static/js/imports/overpass_box.js";
import { createRememberedUploads, markOf } from "../../../static/js/imports/remembered_uploads.js";
import { viewOfExtent } from "../../../static/js/imports/where_next.js";
import {
  differenceSentence,
  factLines,
  factName,
  sizeText,
  summaryLines,
  terrainSentence,
  touched,
} from "../../../static/js/imports/words.js";

const plain = (text) => text.replaceAll("\u00a0", " ");
const bytes = (text) => new TextEncoder().encode(text);

test("a difference is one sentence, and what does not occur is not in it", () => {
  assert.equal(
    plain(differenceSentence({ new: 412, changed: 3, vanished: 1, kept: 2, unchanged: 18_000 })),
    "412 new, 3 changed, 1 removed from source, 2 kept as edited by hand.",
  );
  assert.equal(plain(differenceSentence({ new: 1_200, changed: 0, vanished: 0, kept: 0 })), "1,200 new.");
  assert.equal(differenceSentence({ new: 0, unchanged: 9 }), "Nothing would change.");
});

test("terrain is said by its heights and what they count from", () => {
  const summary = { lowest_m: -3.6, highest_m: 2_599.2, vertical_datum: "EGM96" };
  assert.equal(plain(terrainSentence(summary, { new: 1, changed: 0 })), "Heights from −4 m to 2,599 m above EGM96.");
  assert.match(terrainSentence(summary, { changed: 1 }), /in place of the earlier model of this name\.$/);
});

test("what was edited by hand counts only where it is overwritten", () => {
  assert.equal(touched({ new: 1, changed: 2, vanished: 3, kept: 4, unchanged: 5 }), 6);
  assert.equal(touched({ new: 1, changed: 2, vanished: 3, kept: 4 }, { overwrites: true }), 10);
});

test("the kind of a file is known by its name", () => {
  const kinds = {
    "columbus.osm.pbf": "osm",
    "a.osm.gz": "osm",
    "N46E008.hgt": "terrain",
    "n46e008.hgt.zip": "terrain",
    "dem.TIF": "terrain",
    "towers.csv": "assets",
    "lines.kmz": "assets",
    "grid.gpkg": "assets",
    "grid.gml": "assets",
    "grid.fgb": "assets",
    "grid.dxf": "assets",
    "grid.gdb.zip": "assets",
    "shapes.zip": "assets",
    "czechia.txt": "zones",
  };
  for (const [name, kind] of Object.entries(kinds)) assert.equal(guessKind(name), kind, name);
});

test("the kind of a file without a telling name is known by its first bytes", () => {
  assert.equal(guessKind("data", bytes("\0\0\0\x0d\x0a\x09OSMHeader\x18")), "osm");
  assert.equal(guessKind("data.xml", bytes('<?xml version="1.0"?><osm version="0.6">')), "osm");
  assert.equal(guessKind("data", bytes("II*\0")), "terrain");
  assert.equal(guessKind("data", bytes("SQLite format 3\0")), "assets");
  assert.equal(
    guessKind("a.json", bytes('{"UASZoneList": [{"identifier": "X", "restriction": "PROHIBITED"}]}')),
    "zones",
  );
  assert.equal(
    guessKind("a.geojson", bytes('{"type": "FeatureCollection", "features": [{"geometry": {"type": "LineString"')),
    "assets",
  );
  assert.equal(guessKind("a.json", bytes('{"version": 0.6, "elements": [')), "osm");
});

test("a set is called like its file", () => {
  assert.equal(setNameOf("works_2026.geojson"), "works 2026");
  assert.equal(setNameOf("columbus.osm.pbf"), "columbus");
  assert.equal(setNameOf("noending"), "noending");
});

test("facts say what was and what would be, with their unit", () => {
  const lines = factLines({
    before: { height_m: 30, operator: "", is_flyable: true },
    after: { height_m: 32.5, operator: "AEP", is_flyable: false },
  });
  assert.deepEqual(
    lines.map(({ words, before, after }) => [words, plain(before), plain(after)]),
    [
      ["height", "30 m", "32.5 m"],
      ["operator", "nothing", "AEP"],
      ["flyable", "yes", "no"],
    ],
  );
});

test("facts that are empty on both sides are not said, and shapes are on the map", () => {
  const point = { type: "Point", coordinates: [9, 47] };
  assert.deepEqual(factLines({ before: null, after: { tags: {}, schedule: null, geometry: point } }), [
    { words: "geometry", before: null, after: "changed" },
  ]);
  assert.deepEqual(factLines({ before: { geometry: point }, after: { geometry: point } }), [
    { words: "geometry", before: "dashed on the map", after: "drawn on the map" },
  ]);
});

test("names of facts are words, and their unit is apart", () => {
  assert.deepEqual(factName("lower_limit_m"), { words: "lower limit", unit: "m" });
  assert.deepEqual(factName("is_flyable"), { words: "flyable", unit: "" });
});

test("a summary says figures and short texts alone", () => {
  const lines = summaryLines({ zones: 1_288, set: "Works", columns: [1], notes: ["x"], kept: {} });
  assert.deepEqual(
    lines.map(({ words, value }) => `${words} ${value}`),
    ["zones 1,288", "set Works"],
  );
});

test("sizes are kB below 1 MiB", () => {
  assert.equal(plain(sizeText(20)), "1 kB");
  assert.equal(plain(sizeText(18_874_368)), "18 MiB");
});

test("one degree square at the equator is some 12,364 km²", () => {
  assert.ok(Math.abs(areaKm2([0, 0, 1, 1]) - 12_363.7) < 1);
  assert.ok(areaKm2([0, 60, 1, 61]) < areaKm2([0, 0, 1, 1]) / 1.9);
});

test("the sign stands on a line's middle vertex and on an area's northernmost", () => {
  assert.deepEqual(
    placeOfSign({
      type: "LineString",
      coordinates: [
        [0, 0],
        [1, 1],
        [2, 0],
      ],
    }),
    [1, 1],
  );
  assert.deepEqual(
    placeOfSign({
      type: "Polygon",
      coordinates: [
        [
          [0, 0],
          [4, 0],
          [3, 5],
          [0, 0],
        ],
      ],
    }),
    [3, 5],
  );
  assert.deepEqual(placeOfSign({ type: "Point", coordinates: [7, 8] }), [7, 8]);
});

function memory(kept = {}) {
  return { getItem: (key) => kept[key] ?? null, setItem: (key, value) => (kept[key] = value) };
}

test("a file on its way is known again by name, size and time, for a day", () => {
  let now = 0;
  const storage = memory();
  const file = { name: "a.pbf", size: 5, lastModified: 7 };
  const uploads = createRememberedUploads(1, storage, () => now);
  uploads.keep(markOf(file), { name: "a.pbf", uploadId: "u1" });
  uploads.keep(markOf(file), { received: 3 });
  assert.deepEqual(
    { ...uploads.find(markOf(file)) },
    { name: "a.pbf", uploadId: "u1", received: 3, mark: markOf(file), at: 0 },
  );
  assert.equal(uploads.find(markOf({ ...file, lastModified: 8 })), null);
  assert.equal(createRememberedUploads(2, storage, () => now).all().length, 0);
  now = 25 * 3_600_000;
  assert.equal(uploads.all().length, 0);
});

test("a browser that keeps nothing, or garbles it, is no fault", () => {
  const broken = {
    getItem: () => "{",
    setItem: () => {
      throw new Error("full");
    },
  };
  const uploads = createRememberedUploads(1, broken);
  uploads.keep("m", {});
  assert.deepEqual(uploads.all(), []);
});

test("a mapping of columns is the same after being shown as meanings", () => {
  const mapping = {
    kind: { column: "art", values: { Mast: "tower", Zaun: "" } },
    columns: { ref: "Nr", voltage: "U" },
    units: { voltage: "kV" },
    geometry: { lon: "x", lat: "y" },
  };
  const meanings = meaningsOf(mapping);
  assert.deepEqual(meanings, { Nr: "ref", U: "voltage:kV", x: "lon", y: "lat", art: "kind" });
  assert.deepEqual(mappingOf(meanings, "column", mapping.kind.values), mapping);
});

test("a kind that is chosen wins over a column, and none is none", () => {
  assert.equal(mappingOf({ art: "kind" }, "line", {}).kind, "line");
  assert.equal(mappingOf({}, "", {}).kind, null);
  assert.equal(mappingOf({}, "column", {}).kind, null);
});

test("a role belongs to one column alone", () => {
  assert.deepEqual(withMeaning({ a: "voltage:V", b: "ref" }, "c", "voltage:kV"), { b: "ref", c: "voltage:kV" });
  assert.deepEqual(withMeaning({ a: "name" }, "a", ""), {});
});

test("an empty file, a picture and an empty collection get one sentence each before they are sent", () => {
  assert.equal(whyNotSent("a.osm", 0, bytes("")), "“a.osm” is empty: it has no bytes.");
  const png = new Uint8Array([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0, 0]);
  assert.match(whyNotSent("a.geojson", 10, png), /^“a.geojson” is a PNG file, which holds none/);
  const empty = '{"type": "FeatureCollection", "features": [ ]}';
  assert.equal(
    whyNotSent("a.json", empty.length, bytes(empty)),
    "“a.json” is an empty collection: it has no features.",
  );
  for (const text of ['{"type": "FeatureCollection", "features": [{"type"', "<osm>", "AC A", "PK\u0003\u0004"])
    assert.equal(whyNotSent("a", text.length, bytes(text)), null);
});

test("the table of a difference has a row for each kind and one for all", () => {
  const counts = { new: 1, changed: 0, vanished: 2, kept: 0, unchanged: 5 };
  const difference = { new: 3, changed: 0, vanished: 2, kept: 0, unchanged: 6 };
  const { columns, rows } = tableOf({ difference, summary: { by_kind: { line: counts, tower: counts } } });
  assert.deepEqual(columns, ["new", "changed", "vanished", "unchanged"]);
  assert.deepEqual(
    rows.map(({ words }) => words),
    ["Towers", "Lines", "All"],
  );
  assert.equal(rows[2].counts, difference);
  assert.deepEqual(
    tableOf({ difference: { ...difference, kept: 1 }, summary: {} }).rows.map(({ words }) => words),
    ["Rows"],
  );
});

test("what a replaced region removes is named by kind", () => {
  assert.equal(countedText({ tower: 12, line: 1 }), "12 towers, 1 line");
  assert.equal(countedText({}), "");
});

test("an applied import is shown in the middle of the map", () => {
  assert.match(viewOfExtent([9, 47, 10, 48]), /^#map=[\d.]+\/47\.5\d*\/9\.5\d*$/);
});
