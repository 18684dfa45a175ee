import assert from "node:assert/strict";
import test from "node:test";

import { makeFrame } from "../../../static/js/scene/frame.js";
import { bridgeSolid } from "../../../static/js/scene/geometry/bridges.js";
import { catenaryConstant, sagAt } from "../../../static/js/scene/geometry/catenary.js";
import { countedAir } from "../../../static/js/scene/geometry/counted.js";
import { foldsOf } from "../../../static/js/scene/geometry/folds.js";
import { groundMesh, makeGround } from "../../../static/js/scene/geometry/ground.js";
import { labelsOf } from "../../../static/js/scene/geometry/labels.js";
import { railwayTracks } from "../../../static/js/scene/geometry/railways.js";
import { heightPoles, ribbon } from "../../../static/js/scene/geometry/ribbon.js";
import { memberMatrices } from "../../../static/js/scene/geometry/struts.js";
import { sunAt } from "../../../static/js/scene/geometry/sun.js";
import { supportMembers } from "../../../static/js/scene/geometry/towers.js";
import { deckUnder } from "../../../static/js/scene/geometry/under_decks.js";
import { slotPoint, standing, wiresOf } from "../../../static/js/scene/geometry/wires.js";
import { zoneVolume } from "../../../static/js/scene/geometry/zones.js";
import { drawer, heightsThrough, hill_m, RULES, randomScene } from "./random_scene.js";

const POINTS = 100; // random ones, of each kind
const WITHIN_M = 0.5;
const scene = randomScene(7);
const frame = makeFrame(scene.origin);
const ground = makeGround(scene.ground, frame);
const folds = foldsOf(ground);
const close = (actual, expected, within, message) =>
  assert.ok(Math.abs(actual - expected) <= within, `${message ?? ""} ${actual} is not ${expected}`);

/** The sag of a catenary by another way than the code's: its constant by halving, its lowest point in the middle. */
function sagByHalving(share, length_m, sag_m) {
  let [low, high] = [length_m / 20, 1e9];
  for (let round = 0; round < 200; round += 1) {
    const middle = Math.sqrt(low * high);
    if (middle * (Math.cosh(length_m / 2 / middle) - 1) > sag_m) low = middle;
    else high = middle;
  }
  return high * (Math.cosh(length_m / 2 / high) - Math.cosh((share * length_m - length_m / 2) / high));
}

test("the frame is the local frame of the planners within a centimetre over ten kilometres, and goes back", () => {
  // inspection.geodesy.local_frame.LocalFrame.around(85.3, 27.7).to_metres([[85.4, 27.79]])
  const nepal = makeFrame({ position: [85.3, 27.7], altitude_amsl_m: 1300 });
  const [x, y, z] = nepal.toLocal(85.4, 27.79, 1450.5);
  close(x, 9863.293, 0.001);
  close(y, 150.5, 1e-9);
  close(z, -9973.3167, 0.001);
  const back = nepal.toGeographic([x, y, z]);
  [85.4, 27.79, 1450.5].forEach((value, axis) => {
    close(back[axis], value, 1e-9);
  });
});

test("the ground is that of the data, between posts too, and its mesh is where heightAt says", () => {
  const mesh = groundMesh(ground);
  const next = drawer(1);
  for (let point = 0; point < POINTS; point += 1) {
    const [lon, lat] = [10 + 0.04 * next(), 56.05 - 0.04 * next()];
    const [x, y, z] = frame.toLocal(lon, lat, hill_m(lon, lat));
    close(ground.heightAt(x, z), y, WITHIN_M);
  }
  for (const [west, wide, within] of [
    [10, 0.04, 0.01],
    [9.9, 0.09, 10],
  ]) {
    // the skirt around the data leads smoothly away from them
    for (let point = 0; point < 10; point += 1) {
      const [x, , z] = frame.toLocal(west + wide * next(), 56.05 - 0.04 * next(), 0);
      const [height] = heightsThrough(mesh.vertices, mesh.index, x, z);
      close(ground.heightAt(x, z), height, within);
    }
  }
  const inside = mesh.normals.filter((_, at) => at % 3 === 1);
  assert.ok(
    inside.every((up) => up > 0),
    "every face looks up",
  );
});

test("tower tops are where ground and height say, and no member is above", () => {
  const next = drawer(2);
  for (let point = 0; point < POINTS; point += 1) {
    const support = randomScene(Math.floor(next() * 1e6), { towers: 8 }).supports[point % 8];
    const { outline, fine } = supportMembers(support, frame);
    const [x, top, z] = frame.toLocal(...support.position, support.ground_amsl_m + support.height_m);
    const heights = (members) => members.ends.filter((_, at) => at % 3 === 1);
    close(Math.max(...heights(outline)), top, WITHIN_M, support.form);
    assert.ok(Math.max(-Infinity, ...heights(fine)) <= top + 0.02, support.form);
    const foot = frame.toLocal(...support.position, support.ground_amsl_m)[1];
    close(Math.min(...heights(outline)), foot, WITHIN_M);
    for (let at = 0; at < outline.ends.length; at += 3)
      assert.ok(Math.hypot(outline.ends[at] - x, outline.ends[at + 2] - z) < support.height_m);
  }
});

test("what is drawn lower than planners count has a mark up to there, and wires from top to top", () => {
  const low = {
    ...scene,
    supports: scene.supports.map((support, number) =>
      number % 2
        ? { ...support, likely_m: support.height_m - 8, arms: [[support.height_m - 9, -2, 2]], slots: [], earth: [] }
        : support,
    ),
  };
  const { points, first, marks } = countedAir(low, frame);
  assert.equal(first.length - 1, scene.spans.length, "each span has an end that is counted higher");
  const next = drawer(12);
  for (let point = 0; point < POINTS; point += 1) {
    const number = Math.floor(next() * scene.spans.length);
    const share = next();
    const tops = [scene.spans[number].from, scene.spans[number].to].map((place) =>
      frame.toLocal(
        ...scene.supports[place].position,
        scene.supports[place].ground_amsl_m + scene.supports[place].height_m,
      ),
    );
    [0, 1, 2].forEach((axis) => {
      close(
        points[number * 6 + axis] * (1 - share) + points[number * 6 + 3 + axis] * share,
        tops[0][axis] * (1 - share) + tops[1][axis] * share,
        1e-6,
      );
    });
  }
  for (let place = 1; place < 8; place += 2) {
    const { outline } = supportMembers(low.supports[place], frame);
    const top = Math.max(...outline.ends.filter((_, at) => at % 3 === 1));
    const mark = marks.subarray(((place - 1) / 2) * 18, ((place - 1) / 2) * 18 + 6);
    close(mark[1], top, WITHIN_M, "it begins where the drawing ends");
    close(mark[4] - mark[1], 8, 0.01);
  }
  assert.equal(countedAir(scene, frame).marks.length, 0);
});

test("a member's matrix brings a prism from one end to the other, as wide as it is", () => {
  const ends = Float32Array.from([1, 2, 3, 4, 7, -2, 0, 0, 0, 0, 9, 0, 5, 5, 5, 9, 5, 5]);
  const matrices = memberMatrices({ ends, width_m: Float32Array.from([0.5, 2, 1]) });
  for (let member = 0; member < 3; member += 1) {
    const m = matrices.subarray(member * 16, member * 16 + 16);
    const at = (y) => [0, 1, 2].map((axis) => m[4 + axis] * y + m[12 + axis]);
    [at(-0.5), at(0.5)].flat().forEach((value, place) => {
      close(value, ends[member * 6 + place], 1e-5);
    });
    const [s, u, t] = [0, 4, 8].map((from) => [...m.subarray(from, from + 3)]);
    for (const side of [s, t]) close(Math.hypot(...side), [0.5, 2, 1][member], 1e-6);
    for (const [one, other] of [
      [s, u],
      [u, t],
      [s, t],
    ])
      close(
        one.reduce((sum, value, axis) => sum + value * other[axis], 0),
        0,
        1e-4,
      );
    const cross = [s[1] * u[2] - s[2] * u[1], s[2] * u[0] - s[0] * u[2], s[0] * u[1] - s[1] * u[0]];
    assert.ok(
      cross.reduce((sum, value, axis) => sum + value * t[axis], 0) > 0,
      "right-handed, or faces would look inwards",
    );
  }
});

test("a catenary with a given sag hangs as one by another calculation", () => {
  for (const [length, sag] of [
    [300, 7.5],
    [80, 0.3],
    [1_200, 120],
    [40, 18],
  ]) {
    const constant = catenaryConstant(length, sag);
    for (const share of [0, 0.1, 0.37, 0.5, 0.9, 1])
      close(sagAt(share, length, sag, constant), sagByHalving(share, length, sag), 0.001 * sag + 1e-6);
  }
  assert.equal(sagAt(0.5, 300, 0), 0);
});

test("wires hang from slot to slot with the sag of the data, below the line that planners keep clear of", () => {
  const wires = wiresOf(scene, frame);
  const next = drawer(3);
  assert.equal(
    wires.span.length,
    scene.spans.reduce((sum, { phases, earth }) => sum + phases + earth, 0),
  );
  for (let point = 0; point < POINTS; point += 1) {
    const wire = Math.floor(next() * wires.span.length);
    const span = scene.spans[wires.span[wire]];
    const at = (place) => [...wires.points.subarray(place * 3, place * 3 + 3)];
    const [start, end] = [at(wires.first[wire]), at(wires.first[wire + 1] - 1)];
    const ends = [span.from, span.to].map((place) => scene.supports[place]);
    [start, end].forEach((tip, side) => {
      const slots = (wires.isEarth[wire] ? ends[side].earth : ends[side].slots).map((slot) =>
        slotPoint(standing(ends[side], frame), slot),
      );
      close(
        Math.min(...slots.map((slot) => Math.hypot(...slot.map((value, axis) => value - tip[axis])))),
        0,
        1e-6,
        "starts and ends at a slot",
      );
    });
    const pieces = wires.first[wire + 1] - 1 - wires.first[wire];
    const along = next() * pieces;
    const piece = Math.min(Math.floor(along), pieces - 1);
    const [here, there] = [at(wires.first[wire] + piece), at(wires.first[wire] + piece + 1)];
    const drawn = here[1] + (there[1] - here[1]) * (along - piece);
    const share = along / pieces;
    const length = Math.hypot(end[0] - start[0], end[2] - start[2]);
    const sag = span.sag_m * (wires.isEarth[wire] ? RULES.earth_sag_share : 1);
    close(drawn, start[1] + share * (end[1] - start[1]) - sagByHalving(share, length, sag), WITHIN_M);
    const [low, high] = ends.map(
      (support) => frame.toLocal(...support.position, support.ground_amsl_m + support.height_m)[1],
    );
    assert.ok(drawn <= low + share * (high - low) + 1e-6, "no wire is above what planners count");
  }
});

test("wires of a circuit do not cross from tower to tower, whichever way round towers stand", () => {
  const wires = wiresOf(scene, frame);
  for (let wire = 0; wire < wires.span.length; wire += 1) {
    const { from, to } = scene.spans[wires.span[wire]];
    const [a, b] = [from, to].map((place) => standing(scene.supports[place], frame).foot);
    const right = [-(b[2] - a[2]), b[0] - a[0]];
    const side = (place, foot) =>
      (wires.points[place * 3] - foot[0]) * right[0] + (wires.points[place * 3 + 2] - foot[2]) * right[1];
    const [start, end] = [side(wires.first[wire], a), side(wires.first[wire + 1] - 1, b)];
    if (scene.spans[wires.span[wire]].phases === 6 && !wires.isEarth[wire]) assert.ok(start * end > 0);
  }
});

test("a ribbon passes through every point of the way, level across and as wide as told; poles stand from it to the ground", () => {
  const next = drawer(5);
  const positions = Float32Array.from(
    { length: 120 * 3 },
    (_, at) => [at * 7 + next() * 10, 40 + next() * 60, next() * 200][at % 3],
  );
  const { vertices, index, along_m } = ribbon(positions, { width_m: 3 });
  assert.equal(index.length, 119 * 6);
  for (let point = 0; point < POINTS; point += 1) {
    const leg = Math.floor(next() * 119);
    const share = next();
    const at = (place, axis) => (vertices[place * 6 + axis] + vertices[place * 6 + 3 + axis]) / 2;
    [0, 1, 2].forEach((axis) => {
      const expected = positions[leg * 3 + axis] + share * (positions[leg * 3 + 3 + axis] - positions[leg * 3 + axis]);
      close(at(leg, axis) + share * (at(leg + 1, axis) - at(leg, axis)), expected, 0.01);
    });
    assert.equal(vertices[leg * 6 + 1], vertices[leg * 6 + 4]);
    const across = Math.hypot(vertices[leg * 6 + 3] - vertices[leg * 6], vertices[leg * 6 + 5] - vertices[leg * 6 + 2]);
    assert.ok(across >= 3 - 1e-3 && across <= 6 + 1e-3);
  }
  assert.ok(along_m.every((way, at) => at < 2 || way >= along_m[at - 2]));
  const poles = heightPoles([0, 50, 0, 100, 80, 0, 100, 30, 0, 100, 30, 60], (x) => x / 10, { spacing_m: 40 });
  assert.deepEqual(
    [...poles.segments].filter((_, at) => at % 6 === 0),
    [0, 40, 80, 100, 100],
  );
  assert.deepEqual([...poles.heights_m], [50, 58, 66, 20, 20]);
});

test("upright and standing ways have a ribbon without gaps in its numbers", () => {
  for (const positions of [[], [1, 2, 3], [0, 0, 0, 0, 50, 0], [0, 50, 0, 0, 50, 0, 9, 50, 0, 0, 50, 0]]) {
    const { vertices } = ribbon(positions);
    assert.equal(vertices.length, positions.length * 2);
    assert.ok(vertices.every(Number.isFinite));
    assert.ok(heightPoles(positions, () => 0).segments.every(Number.isFinite));
  }
});

test("rails lie on the ground, rise to the bridge that carries them, and no steeper than a ramp, also from one way to the next", () => {
  const deckAt = deckUnder(scene.bridges, frame);
  const [from, middle, to] = scene.railways[0].line;
  const near = [middle[0] - 0.0025, middle[1] - 0.00025]; // a way of its own up to just before the bridge
  const railways = [
    [from, near],
    [near, middle, to],
  ].map((line) => ({ ...scene.railways[0], line }));
  const ways = railwayTracks(railways, { frame, ground, deckAt }).map(({ bed, rails }) => {
    const heights = [];
    for (let at = 0; at < bed.vertices.length; at += 12)
      heights.push([0, 1, 2].map((axis) => (bed.vertices[at + 3 + axis] + bed.vertices[at + 6 + axis]) / 2));
    assert.equal(rails.length / 6, (heights.length - 1) * 4);
    return heights;
  });
  const onDeck = ways[1].filter(([x, , z]) => deckAt(x, z) !== null);
  assert.ok(onDeck.length > 5);
  for (const [, y] of onDeck) close(y, 330 - 200 + 0.35, 0.01);
  for (const [x, y, z] of ways.flat()) assert.ok(y >= ground.heightAt(x, z) + 0.3);
  close(ways[0].at(-1)[1], ways[1][0][1], 0.06);
  const [x, y, z] = ways[0].at(-1);
  assert.ok(y > ground.heightAt(x, z) + 5, "the dam begins before the bridge's own way");
});

test("wires over rails hang below what planners count, on masts that stand on the ground", () => {
  const plain = { ...ground, heightAt: () => 0 };
  const [electric, other] = railwayTracks([scene.railways[0], { ...scene.railways[0], is_electrified: false }], {
    frame,
    ground: plain,
    wire_agl_m: RULES.rail_wire_agl_m,
  });
  const heights = (points) => [...points].filter((_, at) => at % 3 === 1);
  assert.equal(Math.max(...heights(electric.masts.ends)), RULES.rail_wire_agl_m);
  assert.equal(Math.min(...heights(electric.masts.ends)), 0);
  assert.ok(Math.max(...heights(electric.wires)) < RULES.rail_wire_agl_m && Math.min(...heights(electric.wires)) > 5);
  assert.equal(other.wires.length + other.masts.tone.length, 0);
});

test("a bridge is a slab at its deck's height with piers down to the ground", () => {
  const { vertices } = bridgeSolid(scene.bridges[0], { frame, ground });
  const heights = vertices.filter((_, at) => at % 3 === 1);
  close(Math.max(...heights), 330 - 200 + 0.15, 0.01);
  assert.ok(Math.min(...heights) < 130 - 20, "a pier");
  assert.ok(vertices.every(Number.isFinite));
});

test("the sun stands as high at noon as latitude and season say, and due south", () => {
  // At solar noon it is 90 degrees less latitude plus declination high: Columbus and Kathmandu on the longest and the shortest day.
  const noon = sunAt(new Date("2026-06-21T17:34:00Z"), [-83.0, 39.96]);
  close(noon.altitude_deg, 73.48, 0.15);
  close(noon.azimuth_deg, 180, 1.5);
  assert.ok(sunAt(new Date("2026-06-22T05:34:00Z"), [-83.0, 39.96]).altitude_deg < -20);
  close(sunAt(new Date("2026-12-21T06:17:00Z"), [85.3, 27.7]).altitude_deg, 38.86, 0.2);
});

test("names stand over what they name, the heaviest first", () => {
  const volumes = scene.zones.map((zone) => ({
    ...zoneVolume(zone, { frame, ground, folds, clip: scene.clip, rules: RULES }),
    isInForce: true,
  }));
  const labels = labelsOf(scene, frame, volumes);
  assert.equal(labels[0].kind, "zone");
  assert.ok(labels.every(({ weight }, at) => at === 0 || weight <= labels[at - 1].weight));
  const tower = labels.find(({ kind, id }) => kind === "tower" && id === 3);
  const support = scene.supports[3];
  close(tower.position[1], support.ground_amsl_m + support.height_m - 200, 5);
});
