import assert from "node:assert/strict";
import { test } from "node:test";

import { placeLabels } from "../../../static/js/scene/label_places.js";
import { linkText, readLink, readSource, sourceText } from "../../../static/js/scene/link.js";
import { planSource } from "../../../static/js/scene/sources/plan_source.js";
import { nextOf, sunTime, targetToSee } from "../../../static/js/scene/state.js";
import { fileName } from "../../../static/js/scene/still.js";
import { MISSION, numbers, T0 } from "./flown_mission.js";

test("a link says the same moment and camera when it is read", () => {
  const camera = { mode: "orbit", bearing_deg: 215.25, elevation_deg: 18, distance_m: 85, offset: [1, 0, -2.55] };
  const source = { kind: "rehearsal", rehearsal: "65828de3-3b8d-4a38-92e0-bc7b176f74f2", run: 1 };
  const read = readLink(linkText({ source, at_ms: T0, uav: 1, target: 4, camera }));
  assert.deepEqual(read.source, source);
  assert.deepEqual([read.at_ms, read.since_s, read.uav, read.target], [T0, null, 1, 4]);
  assert.deepEqual(read.camera, { mode: "orbit", view: [215.3, 18, 85], place: null, offset: [1, 0, -2.5] });
  const free = readLink(
    linkText({
      source: { kind: "live" },
      camera: {
        mode: "free",
        bearing_deg: 1,
        elevation_deg: 2,
        distance_m: 0,
        place: [10.1234567, 55, 81.26],
        offset: [0, 0, 0],
      },
    }),
  );
  assert.deepEqual(free.camera.place, [10.123457, 55, 81.3]);
  assert.equal(readLink(linkText({ source: { kind: "plan" }, since_s: 61.25 })).since_s, 61.3);
});

test("an address of nonsense says nothing", () => {
  assert.deepEqual(readLink("?source=elsewhere&t=soon&uav=-1&camera=side&view=a,b"), {
    source: null,
    at_ms: null,
    since_s: null,
    uav: null,
    target: null,
    camera: null,
  });
  assert.deepEqual(readSource("rehearsal:../x:9999"), { kind: "rehearsal", rehearsal: null, run: null });
  assert.equal(sourceText({ kind: "record" }), "record");
});

test("labels never cover each other, the heavier one stands, and where there is no room there is none", () => {
  const next = numbers(3);
  const items = Array.from({ length: 120 }, (_, key) => ({
    key,
    x: next() * 800,
    y: next() * 500,
    width: 40 + next() * 80,
    height: 16 + next() * 20,
    weight: key,
  }));
  const placed = placeLabels(items, { width: 800, height: 500 });
  const boxes = items
    .filter(({ key }) => placed.has(key))
    .map(({ key, width, height }) => ({ ...placed.get(key), width, height }));
  for (const [index, a] of boxes.entries())
    for (const b of boxes.slice(index + 1))
      assert.ok(
        a.left + a.width <= b.left ||
          b.left + b.width <= a.left ||
          a.top + a.height <= b.top ||
          b.top + b.height <= a.top,
      );
  assert.ok(placed.has(119) && placed.size < 120 && placed.size > 20);
  const under = { left: 0, top: 0, right: 800, bottom: 250 };
  for (const [key, { top }] of placeLabels(items, { width: 800, height: 500 }, new Map(), [under]))
    assert.ok(top >= 250, `${key} is not below what covers it`);
  const again = placeLabels(items, { width: 800, height: 500 }, placed);
  assert.deepEqual(again.get(119), placed.get(119));
});

test("the next one goes round, a target is chosen by task, and the sun stands at the flight's time", () => {
  assert.deepEqual(
    [nextOf([0, 2, 5], 5, 1), nextOf([0, 2, 5], 0, -1), nextOf([0, 2], 9, 1), nextOf([], 0, 1)],
    [0, 5, 0, null],
  );
  const source = planSource(MISSION);
  assert.equal(targetToSee(source, null, { target: 1 }, 0).label, "A2");
  assert.equal(targetToSee(source, 0, { target: 1 }, 0).label, "A1");
  assert.equal(targetToSee({ targets: [] }, null, null, 0), null);
  assert.equal(sunTime(source, T0, 10).getTime(), T0);
  const undated = sunTime({ hasDate: false, departs_ms: 0 }, 60_000, 90, T0);
  assert.equal(undated.toISOString(), "2026-09-10T04:01:00.000Z");
});

test("the file of a picture is named by letters of any language", () => {
  assert.equal(fileName("Südring, Trasse 3/4", "20260910", "chase"), "südring-trasse-3-4-20260910-chase.png");
  assert.equal(fileName("…", "", "top"), "mission-top.png");
});
