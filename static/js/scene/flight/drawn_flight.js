/** A source's routes and moments as places of the frame: what the drawings and the instruments read. Values in, values out. */

import { lengthOf, minus, plus, towards } from "../cameras/vectors.js";
import { aboveGround, altitudeOf, trustIn, trustInPlan } from "../sources/heights.js";

/** @import { GroundKind, Trust } from "../sources/heights.js" */
/** @import { FlightRoute, FlightSource, Frame, HeightAt, Moment, Piece, PlannedPlace, SampleKind, Vector } from "../types.d.ts" */

/** @typedef {ReturnType<typeof drawFlight>} Flight */
/** @typedef {{ kind: SampleKind, positions: number[], at_ms: number[] }} FlownLine */
/** @typedef {{ place: number, positions: number[] }} PlannedLine */
/** @typedef {{ place: number, pieces: FlownLine[] }} FlownRoute */

const CAMERA_DOWN_DEG = -25; // direction of a camera without a target: ahead and down
const SEES_TARGET_M = 160; // from there on its camera is on its target
const TARGET_SHARE = 0.7; // of a target's height: where the arms of a tower are
const PLAIN_TARGET_M = 6; // height of a target that is no tower

/**
 * Height above sea level of the ground where a route takes off.
 *
 * @param {FlightRoute} route
 * @param {Frame} frame
 * @param {HeightAt} groundAt
 */
function takeOffOf(route, frame, groundAt) {
  const at = route.planned[0]?.position ?? route.pieces[0]?.samples[0]?.position;
  if (!at) return frame.origin.altitude_amsl_m;
  const [x, , z] = frame.toLocal(at[0], at[1], 0);
  return frame.origin.altitude_amsl_m + groundAt(x, z);
}

/**
 * Placing of a source's routes in the frame.
 *
 * @param {FlightSource} source
 * @param {{ frame: Frame, groundAt: HeightAt, groundKind: GroundKind }} world
 */
export function drawFlight(source, { frame, groundAt, groundKind }) {
  const trust = trustIn(source.kind, groundKind);
  const planTrust = trustInPlan(groundKind);
  const takeOffs = new Map(source.routes.map((route) => [route.place, takeOffOf(route, frame, groundAt)]));
  /** @param {number} route its place */
  const takeOffAt = (route) => takeOffs.get(route) ?? frame.origin.altitude_amsl_m;

  /**
   * @param {Moment | Piece["samples"][number] | PlannedPlace} point
   * @param {number} takeOff
   * @param {Trust} by
   * @returns {Vector}
   */
  const place = (point, takeOff, by) => {
    const [x, y, z] = frame.toLocal(point.position[0], point.position[1], altitudeOf(point, takeOff, by));
    return [x, aboveGround(y, groundAt(x, z)), z];
  };

  /**
   * The planned path, with climbs from the ground and descents to it at take-off, battery changes and landing.
   *
   * @param {FlightRoute} route
   */
  function plannedLine({ place: number, planned }) {
    /** @type {number[]} */
    const line = [];
    planned.forEach((point, index) => {
      const [x, y, z] = place(point, takeOffAt(number), planTrust);
      const ground = groundAt(x, z) + 0.3;
      const isFirst = index === 0;
      const isLast = index === planned.length - 1;
      if (isFirst) line.push(x, ground, z);
      line.push(x, y, z);
      if (point.kind === "base") line.push(x, ground, z, x, y, z);
      if (isLast) line.push(x, ground, z);
    });
    return line;
  }

  /** @param {FlightRoute} route @returns {FlownLine[]} */
  const flownLines = ({ place: number, pieces }) =>
    pieces
      .filter(({ samples }) => samples.length > 1)
      .map(({ kind, samples }) => ({
        kind,
        positions: samples.flatMap((sample) => place(sample, takeOffAt(number), trust)),
        at_ms: samples.map(({ at_ms }) => at_ms),
      }));

  return {
    takeOffs,
    /** @returns {PlannedLine[]} */
    plannedLines: () => source.routes.map((route) => ({ place: route.place, positions: plannedLine(route) })),
    /** Planned places only fly: their way is the plan's own. @returns {FlownRoute[]} */
    flownLines: () =>
      source.kind === "plan" ? [] : source.routes.map((route) => ({ place: route.place, pieces: flownLines(route) })),
    /** @param {{ position: number[], height_m?: number | null }} target @returns {Vector} */
    targetPlace: ({ position, height_m = null }) => {
      const [x, , z] = frame.toLocal(position[0], position[1], 0);
      return [x, groundAt(x, z) + (height_m === null ? PLAIN_TARGET_M : height_m * TARGET_SHARE), z];
    },
    /**
     * @param {FlightRoute} route
     * @param {Moment} moment
     * @param {Vector | null} [target] that it is at or flies to
     */
    at(route, moment, target = null) {
      const own = place(moment, takeOffAt(route.place), trust);
      const [x, y, z] = own;
      const ground = groundAt(x, z);
      const away = target && minus(target, own);
      const away_m = away ? lengthOf(away) : 0;
      const seesTarget = moment.isInAir !== false && away_m > 0.5 && away_m < SEES_TARGET_M;
      return {
        route: route.place,
        moment,
        place: own,
        ground,
        heading_deg: moment.heading_deg ?? 0,
        roll_deg: moment.roll_deg ?? 0,
        pitch_deg: moment.pitch_deg ?? 0,
        camera:
          away && seesTarget ? plus([0, 0, 0], away, 1 / away_m) : towards(moment.heading_deg ?? 0, CAMERA_DOWN_DEG),
        seesTarget,
        height_agl_m: Math.max(0, y - ground),
        isInAir: moment.isInAir !== false && !moment.isOver,
      };
    },
  };
}
