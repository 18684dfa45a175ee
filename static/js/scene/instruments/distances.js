/** Distances of a UAV to the nearest wire, tower and zone: in space, from the data of the scene. Values in, values out. */

import { countedAir } from "../geometry/counted.js";

/** @import { Scene, SceneLimit } from "../../api_types.d.ts" */
/** @import { Frame, HeightAt, Polylines, Ring, Vector } from "../types.d.ts" */

/** @typedef {ReturnType<typeof surroundingsOf>} Surroundings */
/** @typedef {Surroundings["towers"][number]} NearbyTower */
/** @typedef {Surroundings["zones"][number]} NearbyZone */
/** @typedef {Polylines & { boxes: Float64Array, isCounted: boolean }} HungLines boxes: of boxesOf */
/** @typedef {{ away_m: number, line: number, point: Vector, isCounted: boolean }} NearWire isCounted: where planners count it, above the drawn one */
/** @typedef {{ away_m: number, tower: NearbyTower, point: Vector }} NearTower */
/** @typedef {{ away_m: number, zone: NearbyZone, isInside: boolean }} NearZone */

const FOOT_SHARE = 0.1; // of a tower's height: half its feet's width
const CLEAR_OF_ALL_M = 250; // nothing is taller than this above the ground

/**
 * All obstacles in the frame: prepared once for a scene.
 *
 * @param {Scene} sceneData
 * @param {Frame} frame
 * @param {Polylines} wires as the world draws them
 * @param {HeightAt} groundAt
 */
export function surroundingsOf(sceneData, frame, wires, groundAt) {
  const origin_m = frame.origin.altitude_amsl_m;
  const towers = sceneData.supports
    .filter(({ kind }) => kind !== "vertex")
    .map(({ id, label, position, ground_amsl_m, height_m, arms }) => {
      const [x, y, z] = frame.toLocal(position[0], position[1], ground_amsl_m);
      return {
        id,
        label,
        x,
        z,
        bottom: y,
        top: y + height_m,
        wide_m: Math.max(height_m * FOOT_SHARE, ...arms.flatMap(([, left_m, right_m]) => [-left_m, right_m])),
      };
    });
  const zones = sceneData.zones.map(({ id, name, polygons, lower, upper, schedule, schedule_words }) => ({
    id,
    name,
    lower,
    upper,
    schedule,
    schedule_words,
    polygons: polygons.map((rings) =>
      rings.map((ring) =>
        ring.map(([lon, lat]) => {
          const [x, , z] = frame.toLocal(lon, lat, 0);
          return [x, z];
        }),
      ),
    ),
  }));
  const hung = [wires, countedAir(sceneData, frame)].map((lines, number) => ({
    ...lines,
    boxes: boxesOf(lines),
    isCounted: number === 1,
  }));
  return { towers, hung, zones, groundAt, origin_m };
}

/** The box round each polyline: [least x, y, z, most x, y, z] each. @param {Polylines} lines */
function boxesOf({ points, first }) {
  const boxes = new Float64Array(Math.max(first.length - 1, 0) * 6);
  for (let line = 0; line < first.length - 1; line += 1) {
    for (let axis = 0; axis < 3; axis += 1) {
      let [least, most] = [Infinity, -Infinity];
      for (let at = first[line]; at < first[line + 1]; at += 1) {
        const value = points[at * 3 + axis];
        if (value < least) least = value;
        if (value > most) most = value;
      }
      boxes[line * 6 + axis] = least;
      boxes[line * 6 + 3 + axis] = most;
    }
  }
  return boxes;
}

/** @param {number} value @param {number} least @param {number} most */
const beyond = (value, least, most) => (value < least ? least - value : value > most ? value - most : 0);

/**
 * The nearest point of the wires within reach_m.
 *
 * @param {Pick<Surroundings, "hung">} surroundings
 * @param {Vector} place
 * @param {number} [reach_m]
 */
export function nearestWire({ hung }, place, reach_m = Infinity) {
  return hung.reduce(
    (nearest, lines) => nearestOf(lines, place, nearest?.away_m ?? reach_m) ?? nearest,
    /** @type {NearWire | null} */ (null),
  );
}

/** @param {HungLines} lines @param {Vector} place @param {number} reach_m @returns {NearWire | null} */
function nearestOf({ points, first, boxes, isCounted }, [x, y, z], reach_m) {
  /** @type {NearWire | null} */
  let nearest = null;
  let least = reach_m;
  for (let line = 0; line < first.length - 1; line += 1) {
    const box = line * 6;
    if (
      Math.hypot(
        beyond(x, boxes[box], boxes[box + 3]),
        beyond(y, boxes[box + 1], boxes[box + 4]),
        beyond(z, boxes[box + 2], boxes[box + 5]),
      ) >= least
    )
      continue;
    for (let at = first[line]; at < first[line + 1] - 1; at += 1) {
      const from = at * 3;
      const [dx, dy, dz] = [
        points[from + 3] - points[from],
        points[from + 4] - points[from + 1],
        points[from + 5] - points[from + 2],
      ];
      const length2 = dx * dx + dy * dy + dz * dz;
      const share =
        length2 > 0
          ? Math.min(
              1,
              Math.max(
                0,
                ((x - points[from]) * dx + (y - points[from + 1]) * dy + (z - points[from + 2]) * dz) / length2,
              ),
            )
          : 0;
      /** @type {Vector} */
      const point = [points[from] + share * dx, points[from + 1] + share * dy, points[from + 2] + share * dz];
      const away_m = Math.hypot(x - point[0], y - point[1], z - point[2]);
      if (away_m >= least) continue;
      least = away_m;
      nearest = { away_m, line, point, isCounted };
    }
  }
  return nearest;
}

/**
 * The nearest tower, as a vertical pole.
 *
 * @param {Pick<Surroundings, "towers">} surroundings
 * @param {Vector} place
 * @param {number} [reach_m]
 */
export function nearestTower({ towers }, [x, y, z], reach_m = Infinity) {
  /** @type {NearTower | null} */
  let nearest = null;
  let least = reach_m;
  for (const tower of towers) {
    const beside = Math.hypot(x - tower.x, z - tower.z);
    if (beside >= least) continue;
    const away_m = Math.hypot(beside, beyond(y, tower.bottom, tower.top));
    if (away_m >= least) continue;
    least = away_m;
    nearest = { away_m, tower, point: [tower.x, Math.min(tower.top, Math.max(tower.bottom, y)), tower.z] };
  }
  return nearest;
}

/**
 * The distances from a place to the nearest ground, tower with its arms, wire and point of `others`.
 *
 * @param {Surroundings} surroundings
 * @param {Vector} place
 * @param {readonly Vector[]} [others]
 */
export function roomRound(surroundings, [x, y, z], others = []) {
  const above_m = y - surroundings.groundAt(x, z);
  const apart_m = others.reduce(
    (least, [ox, oy, oz]) => Math.min(least, Math.hypot(ox - x, oy - y, oz - z)),
    Math.max(above_m, 0),
  );
  if (above_m > CLEAR_OF_ALL_M) return Math.min(apart_m, above_m - CLEAR_OF_ALL_M * 0.8);
  const towers_m = surroundings.towers.reduce(
    (least, tower) =>
      Math.min(
        least,
        Math.hypot(
          Math.max(Math.hypot(x - tower.x, z - tower.z) - tower.wide_m, 0),
          beyond(y, tower.bottom, tower.top),
        ),
      ),
    apart_m,
  );
  return nearestWire(surroundings, [x, y, z], towers_m)?.away_m ?? towers_m;
}

/** @param {SceneLimit} limit @param {number} ground @param {number} origin_m @param {number} otherwise */
const limitAt = ({ above, m }, ground, origin_m, otherwise) =>
  above === "open" || m === null ? otherwise : above === "ground" ? ground + m : m - origin_m;

/**
 * The nearest zone, by horizontal and vertical distance together.
 *
 * @param {Pick<Surroundings, "zones" | "groundAt" | "origin_m">} surroundings
 * @param {Vector} place
 * @param {(zone: NearbyZone) => boolean} [keep] which zones to include
 */
export function nearestZone({ zones, groundAt, origin_m }, [x, y, z], keep = () => true) {
  /** @type {NearZone | null} */
  let nearest = null;
  for (const zone of zones) {
    if (!keep(zone)) continue;
    const ground = groundAt(x, z);
    const height_m = beyond(
      y,
      limitAt(zone.lower, ground, origin_m, -Infinity),
      limitAt(zone.upper, ground, origin_m, Infinity),
    );
    for (const rings of zone.polygons) {
      const beside_m = isWithin(rings, x, z) ? 0 : edgeDistance(rings, x, z);
      const away_m = Math.hypot(beside_m, height_m);
      if (!nearest || away_m < nearest.away_m) nearest = { away_m, zone, isInside: away_m === 0 };
    }
  }
  return nearest;
}

/**
 * Even-odd: inside the outline and in none of the holes.
 *
 * @param {readonly Ring[]} rings
 * @param {number} x
 * @param {number} z
 */
function isWithin(rings, x, z) {
  let isIn = false;
  for (const ring of rings) {
    for (let at = 0, before = ring.length - 1; at < ring.length; before = at, at += 1) {
      const [[xa, za], [xb, zb]] = [ring[at], ring[before]];
      if (za > z !== zb > z && x < ((xb - xa) * (z - za)) / (zb - za) + xa) isIn = !isIn;
    }
  }
  return isIn;
}

/** @param {readonly Ring[]} rings @param {number} x @param {number} z */
function edgeDistance(rings, x, z) {
  let least = Infinity;
  for (const ring of rings) {
    for (let at = 0; at < ring.length - 1; at += 1) {
      const [[xa, za], [xb, zb]] = [ring[at], ring[at + 1]];
      const [dx, dz] = [xb - xa, zb - za];
      const length2 = dx * dx + dz * dz;
      const share = length2 > 0 ? Math.min(1, Math.max(0, ((x - xa) * dx + (z - za) * dz) / length2)) : 0;
      least = Math.min(least, Math.hypot(x - xa - share * dx, z - za - share * dz));
    }
  }
  return least;
}
