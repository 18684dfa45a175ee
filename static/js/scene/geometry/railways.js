/** Railways: a bed over the ground, dams up to the bridges that carry it, two rails a track, and the wire of electric ones. Values in, arrays out. */

import { memberList } from "./struts.js";

/** @import { Railway } from "../../api_types.d.ts" */
/** @import { Frame, Ring, Vector } from "../types.d.ts" */
/** @import { Ground } from "./ground.js" */

/** @typedef {{ railway: Railway, points: Ring, onDeck: (number | null)[], heights: number[] }} Way */

const STEP_M = 20;
const GAUGE_M = 1.435;
const TRACK_M = 4.2; // from track to track
const BED_M = 4.4; // of one track, across
const BED_LIFT_M = 0.35;
const RAIL_LIFT_M = 0.25; // above the bed
const STEEPEST = 0.03; // of a ramp
const DAM_SLOPE = 1.5; // across, for each metre of height
const MAST_EVERY_M = 58;
const MAST_OUT_M = 1.2; // beside the bed
const CONTACT_M = 5.6; // above the ground
const CARRIER_SAG_M = 1.1;
const MIN_LIFT_M = 0.05;
const MAX_ROUNDS = 12;

/**
 * All railways of a scene, in their order: [{ bed: { vertices, uv (0 to 1 across, metres along), index }, rails: Float32Array of segments
 * (x, y, z, x, y, z), wires: the same of contact wires and what carries them, masts: members }]. Where two share an end they are equally high there, so ramps go on from one to the next.
 *
 * deckAt(x, z): y of a bridge for rails there, or null. wire_agl_m: what planners count of a railway; nothing of it is drawn higher.
 *
 * @param {readonly Railway[]} railways
 * @param {{ frame: Frame, ground: Pick<Ground, "heightAt">, deckAt?: (x: number, z: number) => number | null, wire_agl_m?: number }} world
 */
export function railwayTracks(railways, { frame, ground, deckAt = () => null, wire_agl_m = 8 }) {
  const ways = railways.map((railway) => {
    const places = railway.line.map(([lon, lat]) => frame.toLocal(lon, lat, 0));
    const points = densified(places.map(([x, , z]) => [x, z]));
    const onDeck = points.map(([x, z]) => deckAt(x, z));
    return {
      railway,
      points,
      onDeck,
      heights: points.map(([x, z], place) => Math.max(ground.heightAt(x, z), onDeck[place] ?? -Infinity)),
    };
  });
  ramps(ways);
  return ways.map((way) => ({ ...track(way, ground), ...overhead(way, wire_agl_m) }));
}

/**
 * Ramps before and behind raised parts, with limited slope; repeated until ends that meet agree.
 *
 * @param {Way[]} ways
 */
function ramps(ways) {
  /** @type {Map<string, number>} */
  const ends = new Map();
  /** @param {number[]} place */
  const key = ([x, z]) => `${Math.round(x)} ${Math.round(z)}`;
  let waiting = ways.filter(({ onDeck }) => onDeck.some((height) => height !== null));
  for (let round = 0; round < MAX_ROUNDS && waiting.length; round += 1) {
    const lifted = new Set();
    for (const way of waiting) {
      slope(way);
      for (const place of [0, way.points.length - 1]) {
        const at = key(way.points[place]);
        if (way.heights[place] > (ends.get(at) ?? -Infinity) + MIN_LIFT_M) lifted.add(at);
        ends.set(at, Math.max(ends.get(at) ?? -Infinity, way.heights[place]));
      }
    }
    waiting = ways.filter(
      (way) =>
        [0, way.points.length - 1].filter((place) => {
          const height = ends.get(key(way.points[place])) ?? -Infinity;
          if (!lifted.has(key(way.points[place])) || height <= way.heights[place] + MIN_LIFT_M) return false;
          way.heights[place] = height;
          return true;
        }).length > 0,
    );
  }
}

/** @param {Way} way */
function slope({ points, heights }) {
  /** @param {number} here @param {number} before */
  const ramp = (here, before) => {
    const far_m = Math.hypot(points[here][0] - points[before][0], points[here][1] - points[before][1]);
    heights[here] = Math.max(heights[here], heights[before] - STEEPEST * far_m);
  };
  for (let at = 1; at < points.length; at += 1) ramp(at, at - 1);
  for (let at = points.length - 2; at >= 0; at -= 1) ramp(at, at + 1);
}

/** @param {Way} way @param {Pick<Ground, "heightAt">} ground */
function track({ railway, points, onDeck, heights }, ground) {
  const width_m = BED_M + (railway.tracks - 1) * TRACK_M;
  /** @type {{ vertices: number[], uv: number[], index: number[] }} */
  const bed = { vertices: [], uv: [], index: [] };
  const sides = sidesOf(points);
  let along_m = 0;
  points.forEach(([x, z], place) => {
    if (place) along_m += Math.hypot(x - points[place - 1][0], z - points[place - 1][1]);
    const [side_x, side_z] = sides[place];
    const y = heights[place] + BED_LIFT_M;
    const dam_m = onDeck[place] === null ? Math.max(y - ground.heightAt(x, z), 0) : 0;
    for (const [corner, sign] of [
      [-1, -1],
      [0, -1],
      [1, 1],
      [2, 1],
    ]) {
      const isFoot = corner === -1 || corner === 2;
      const out_m = width_m / 2 + (isFoot ? dam_m * DAM_SLOPE : 0);
      bed.vertices.push(x + sign * side_x * out_m, isFoot ? y - dam_m : y, z + sign * side_z * out_m);
      bed.uv.push(corner, along_m);
    }
    if (place < points.length - 1) {
      for (const low of [0, 1, 2].map((corner) => place * 4 + corner))
        bed.index.push(low, low + 1, low + 4, low + 1, low + 5, low + 4);
    }
  });
  return {
    bed: {
      vertices: Float32Array.from(bed.vertices),
      uv: Float32Array.from(bed.uv),
      index: Uint32Array.from(bed.index),
    },
    rails: railLines(points, heights, sides, railway.tracks),
  };
}

/**
 * Masts beside the outermost track, an arm over all, and for each track a contact wire below its carrier.
 *
 * @param {Way} way
 * @param {number} wire_agl_m
 */
function overhead({ railway, points, heights }, wire_agl_m) {
  const masts = memberList();
  /** @type {number[]} */
  const wires = [];
  if (!railway.is_electrified) return { masts: masts.take(), wires: new Float32Array(0) };
  const sides = sidesOf(points);
  const out_m = (BED_M + (railway.tracks - 1) * TRACK_M) / 2 + MAST_OUT_M;
  const high_m = wire_agl_m - 0.3; // the bed's lift is below the wire, too
  /** @param {number} place @param {number} across @param {number} up @returns {Vector} */
  const at = (place, across, up) => [
    points[place][0] + across * sides[place][0],
    heights[place] + up,
    points[place][1] + across * sides[place][1],
  ];
  const stands = mastPlaces(points);
  for (const place of stands) {
    masts.add(at(place, out_m, 0), at(place, out_m, wire_agl_m), 0.28);
    masts.add(at(place, out_m, wire_agl_m - 0.4), at(place, -out_m + 2 * MAST_OUT_M, high_m), 0.12);
    masts.add(at(place, out_m, CONTACT_M + 0.3), at(place, -out_m + 2 * MAST_OUT_M, CONTACT_M + 0.3), 0.09);
  }
  for (let track = 0; track < railway.tracks; track += 1) {
    const across = (track - (railway.tracks - 1) / 2) * TRACK_M;
    for (let field = 1; field < stands.length; field += 1) {
      const [from, to] = [stands[field - 1], stands[field]];
      for (let place = from; place < to; place += 1) {
        /** @param {number} own */
        const carried = (own) =>
          high_m - 4 * CARRIER_SAG_M * ((own - from) / (to - from)) * (1 - (own - from) / (to - from));
        wires.push(...at(place, across, CONTACT_M), ...at(place + 1, across, CONTACT_M));
        wires.push(...at(place, across, carried(place)), ...at(place + 1, across, carried(place + 1)));
      }
    }
  }
  return { masts: masts.take(), wires: Float32Array.from(wires) };
}

/** Places of masts at a regular spacing along the way, at its points; the first and the last among them. @param {Ring} points */
function mastPlaces(points) {
  const places = [0];
  let since_m = 0;
  for (let place = 1; place < points.length - 1; place += 1) {
    since_m += Math.hypot(points[place][0] - points[place - 1][0], points[place][1] - points[place - 1][1]);
    if (since_m < MAST_EVERY_M) continue;
    places.push(place);
    since_m = 0;
  }
  return points.length > 1 ? [...places, points.length - 1] : [];
}

/** @param {Ring} points @param {readonly number[]} heights @param {Ring} sides @param {number} tracks */
function railLines(points, heights, sides, tracks) {
  /** @type {number[]} */
  const segments = [];
  for (let track = 0; track < tracks; track += 1) {
    const middle_m = (track - (tracks - 1) / 2) * TRACK_M;
    for (const across of [middle_m - GAUGE_M / 2, middle_m + GAUGE_M / 2]) {
      /** @param {number} at */
      const place = (at) => [
        points[at][0] + across * sides[at][0],
        heights[at] + BED_LIFT_M + RAIL_LIFT_M,
        points[at][1] + across * sides[at][1],
      ];
      for (let at = 0; at < points.length - 1; at += 1) segments.push(...place(at), ...place(at + 1));
    }
  }
  return Float32Array.from(segments);
}

/** @param {Ring} line */
function densified(line) {
  /** @type {Ring} */
  const points = [];
  line.forEach(([x, z], at) => {
    if (at) {
      const [lastX, lastZ] = line[at - 1];
      const pieces = Math.ceil(Math.hypot(x - lastX, z - lastZ) / STEP_M);
      for (let piece = 1; piece < pieces; piece += 1)
        points.push([lastX + ((x - lastX) * piece) / pieces, lastZ + ((z - lastZ) * piece) / pieces]);
    }
    points.push([x, z]);
  });
  return points;
}

/** At each point the direction to the right, of length 1. @param {Ring} points */
function sidesOf(points) {
  return points.map((_, at) => {
    const [before, after] = [points[Math.max(at - 1, 0)], points[Math.min(at + 1, points.length - 1)]];
    const [x, z] = [after[0] - before[0], after[1] - before[1]];
    const length = Math.hypot(x, z) || 1;
    return [-z / length, x / length];
  });
}
