import assert from "node:assert/strict";
import test from "node:test";
import { nearestOnLine } from "../../../static/js/domain/geodesy.js";
import { routeLetter, routeNumber } from "../../../static/js/domain/palette.js";
import { hashOf, showsAnything, viewOf } from "../../../static/js/map/address.js";
import { firstInOrder } from "../../../static/js/map/click_router.js";
import { distinct, roundText } from "../../../static/js/map/furniture.js";
import { graticuleLines, graticuleStep } from "../../../static/js/map/layers/graticule.js";
import { mergeDarts, mergedLabel, mergePills, pillWidth } from "../../../static/js/map/pills.js";
import { plainWords } from "../../../static/js/map/tips.js";
import { fitTo } from "../../../static/js/missions/sketch.js";

const feature = (id, sourceLayer, properties = { id: 1 }) => ({
  layer: { id },
  sourceLayer,
  properties,
  geometry: { type: "Point", coordinates: [0, 0] },
});

test("a click takes the tower before the line that it carries, and the zone last", () => {
  const under = [
    feature("zones-fill", "zones"),
    feature("lines", "lines"),
    feature("towers-ring", "towers", { id: 42 }),
    feature("routes", undefined),
  ];
  assert.deepEqual([firstInOrder(under).kind, firstInOrder(under).id], ["tower", 42]);
  assert.equal(firstInOrder(under.slice(0, 2)).kind, "line");
  assert.equal(firstInOrder([feature("routes", undefined)]), null);
});

test("what can be flown to comes before what cannot", () => {
  const under = [
    feature("railways", "railways", { id: 1, flyable: false }),
    feature("lines", "lines", { id: 2, flyable: true }),
  ];
  assert.equal(firstInOrder(under).id, 2);
  assert.equal(firstInOrder(under.slice(0, 1)).id, 1);
});

test("the line tool sees lines and tracks alone", () => {
  const under = [
    feature("towers-ring", "towers"),
    feature("lines", "lines", { id: 9 }),
    feature("zones-fill", "zones"),
  ];
  assert.equal(firstInOrder(under, ["line", "railway"]).id, 9);
  assert.equal(firstInOrder(under.slice(0, 1), ["line", "railway"]), null);
});

test("a point on a track is the nearest one of what is drawn", () => {
  const track = {
    type: "LineString",
    coordinates: [
      [10, 60],
      [12, 60],
    ],
  };
  assert.deepEqual(nearestOnLine(track, [11, 60.4]), [11, 60]);
  assert.deepEqual(nearestOnLine(track, [13, 60.4]), [12, 60]);
});

test("the nearest point is measured on the ground, not in degrees", () => {
  // at 60° north a degree of longitude is half as long as one of latitude
  const corner = {
    type: "MultiLineString",
    coordinates: [
      [
        [10, 60],
        [10, 61],
      ],
      [
        [9, 60.7],
        [12, 60.7],
      ],
    ],
  };
  assert.deepEqual(nearestOnLine(corner, [10.3, 60.5]), [10, 60.5]);
});

test("the graticule keeps its lines some 150 px apart", () => {
  for (const zoom of [2, 5, 8, 11, 14]) {
    const px = graticuleStep(zoom) / (360 / (512 * 2 ** zoom));
    assert.ok(px > 70 && px < 320, `${px} px at zoom ${zoom}`);
  }
  const lines = graticuleLines([9.5, 49.5, 10.5, 50.5], 1);
  assert.ok(lines.coordinates.some((line) => line.every(([longitude]) => longitude === 10)));
});

test("letters and colours go by the place in the mission", () => {
  assert.deepEqual([0, 7, 8, 26].map(routeLetter), ["A", "H", "I", "AA"]);
  assert.deepEqual([0, 7, 8].map(routeNumber), [1, 8, 1]);
});

test("a sketch fits its frame and keeps the shape", () => {
  const route = [
    [10, 0],
    [11, 0],
    [11, 1],
  ];
  const [start, corner, end] = route.map(fitTo(route));
  for (const [x, y] of [start, corner, end]) assert.ok(x >= 8 && x <= 104 && y >= 8 && y <= 48);
  assert.ok(Math.abs(corner[0] - start[0] - (corner[1] - end[1])) < 0.05); // a degree is as long east as north at the equator
});

test("a sketch of nothing has no places and one of a single target stands in the middle", () => {
  assert.equal(fitTo([]), null);
  assert.deepEqual(fitTo([[10, 50]])([10, 50]).map(Math.round), [56, 28]);
});

const pill = (sequence, number, x, y, isMissed = false) => ({
  key: `${sequence} ${number}`,
  sequence,
  letter: "AB"[sequence] ?? "",
  number,
  x,
  y,
  isMissed,
});
const labels = (pills) => mergePills(pills).map(({ label }) => label);

test("pills of one UAV that would overlap are merged, those of two are not", () => {
  assert.deepEqual(labels([pill(0, 1, 0, 0), pill(0, 2, 10, 0), pill(1, 1, 5, 0), pill(0, 3, 100, 0)]), [
    "A1–2",
    "B1",
    "A3",
  ]);
});

test("a pill that has grown by merging takes the next one too", () => {
  assert.deepEqual(labels([pill(0, 1, 0, 0), pill(0, 3, 20, 0), pill(0, 2, 40, 0)]), ["A1–3"]);
  const groups = mergePills(Array.from({ length: 40 }, (_, index) => pill(0, index + 1, index * 9, 0)));
  for (let index = 1; index < groups.length; index += 1) {
    assert.ok(
      groups[index].x - groups[index - 1].x >=
        (pillWidth(groups[index].label) + pillWidth(groups[index - 1].label)) / 2,
    );
  }
});

test("pills under one another stay apart from 22 px", () => {
  assert.deepEqual(labels([pill(0, 1, 0, 0), pill(0, 2, 0, 21)]), ["A1–2"]);
  assert.deepEqual(labels([pill(0, 1, 0, 0), pill(0, 2, 0, 23)]), ["A1", "A2"]);
});

test("a merged pill says runs, and where they are long how many targets", () => {
  assert.equal(mergedLabel("C", [4, 3]), "C3–4");
  assert.equal(mergedLabel("C", [1, 3]), "C1, 3");
  assert.equal(mergedLabel("C", [10, 11, 12, 13, 16, 17]), "C, 6 targets");
  assert.equal(mergedLabel("", [1, 3, 5, 7, 9, 11, 13, 15, 17]), "9 targets");
});

test("targets that are not reached keep their cross and stay apart from the planned ones", () => {
  assert.deepEqual(labels([pill(null, 4, 0, 0, true), pill(0, 1, 5, 0)]), ["×", "A1"]);
  assert.deepEqual(labels([pill(null, 4, 0, 0, true), pill(null, 9, 5, 0, true)]), ["× 2 targets"]);
});

const COLUMBUS = [-83.2, 39.8, -82.7, 40.2];
const SCREEN = [1064, 852];

test("a view goes into the address and comes back", () => {
  const view = { zoom: 12.35, centre: [-82.99879, 39.96118] };
  assert.equal(hashOf(view), "#map=12.35/39.96118/-82.99879");
  assert.deepEqual(viewOf(hashOf(view)), view);
  for (const hash of ["", "#map=", "#map=1/2", "#map=4/95/10", "#map=4/10/190", "#map=99/1/1"])
    assert.equal(viewOf(hash), null, hash);
});

test("a view without anything of the ground is not worth going to", () => {
  assert.equal(showsAnything({ zoom: 11, centre: [-83, 40] }, SCREEN, COLUMBUS), true);
  assert.equal(showsAnything({ zoom: 11, centre: [-84, 40] }, SCREEN, COLUMBUS), false);
  assert.equal(showsAnything({ zoom: 11, centre: [-83, 41] }, SCREEN, COLUMBUS), false);
  assert.equal(showsAnything({ zoom: 11, centre: [-84, 40] }, SCREEN, null), true);
});

test("nor is one in which the whole ground is a dot", () => {
  assert.equal(showsAnything({ zoom: 3.48, centre: [-80, 40] }, SCREEN, COLUMBUS), false);
  assert.equal(showsAnything({ zoom: 7, centre: [-80, 40] }, SCREEN, COLUMBUS), true);
  assert.equal(showsAnything({ zoom: 14, centre: [10, 50] }, SCREEN, [10, 50, 10, 50]), true); // a single tower, near
});

test("codes of a zone file are told in words", () => {
  assert.equal(plainWords("AIR_TRAFFIC"), "Air traffic");
  assert.equal(plainWords("AIR_TRAFFIC, NATURE"), "Air traffic, nature");
  assert.equal(plainWords("Breeding season; keep out"), "Breeding season; keep out");
});

test("a source is named once, with its licence where that is known", () => {
  assert.deepEqual(distinct(["© A, ODbL 1.0", "© A", "© AB", "© AB"]), ["© A, ODbL 1.0", "© AB"]);
});

test("UAVs that would cover each other's names are one mark with their number", () => {
  const dart = (name, x, y) => ({ name, x, y });
  const summary = (darts) => mergeDarts(darts).map(({ label, members }) => [label, members.length]);
  assert.deepEqual(summary([dart("Heron", 0, 0)]), [["Heron", 1]]);
  assert.deepEqual(summary([dart("Heron", 0, 0), dart("Kite", 20, 4), dart("Osprey", 300, 0)]), [
    ["2 UAVs", 2],
    ["Osprey", 1],
  ]);
  assert.deepEqual(summary([dart("Heron", 0, 0), dart("Kite", 0, 40)]), [
    ["Heron", 1],
    ["Kite", 1],
  ]);
});

test("a scale's length loses a decimal zero, and thousands in any language stay", () => {
  assert.deepEqual(["2.0 km", "2,0 km", "1.000 km", "1,000 km", "500 m", "0.05 mi"].map(roundText), [
    "2 km",
    "2 km",
    "1.000 km",
    "1,000 km",
    "500 m",
    "0.05 mi",
  ]);
});
