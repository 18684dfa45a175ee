/** A mission's plan as a source of the view: UAVs are at their planned positions. */

import { labelsOf } from "../../record/labels.js";
import { completed, firstOf, lastOf, PLANNED } from "./pieces.js";

/** @import { Mission, Route, WindLayerOutput } from "../../api_types.d.ts" */
/** @import { FlightRoute, FlightSample, FlightSource, Piece, PlannedPlace, SourceTarget, Wind } from "../types.d.ts" */

/** The first moment where a mission has no departure: times are then shown since departure. */
export const NO_DATE_MS = 0;

/**
 * Planned waypoints of a mission's route.
 *
 * @param {Pick<Route, "waypoints" | "arrival_s">} route
 * @returns {PlannedPlace[]}
 */
export const plannedOf = ({ waypoints, arrival_s }) =>
  waypoints.map(({ position, altitude_amsl_m, altitude_relative_m, target, kind }, index) => ({
    sequence: index,
    position,
    altitude_amsl_m,
    altitude_relative_m,
    at_s: arrival_s[index] ?? null,
    target,
    kind,
  }));

/**
 * Targets with the label they have on all stages.
 *
 * @param {readonly Pick<FlightRoute, "place" | "planned">[]} routes
 * @param {readonly { label: string, asset: number | null }[]} targets
 * @returns {SourceTarget[]}
 */
export function targetsOf(routes, targets) {
  const labels = labelsOf(routes.map(({ place, planned }) => ({ place, waypoints: planned })));
  return [...labels].map(([place, { label, place: route, position }]) => ({
    place,
    label,
    name: targets[place]?.label ?? "",
    asset: targets[place]?.asset ?? null,
    position,
    route,
  }));
}

/** @param {Route} route @param {PlannedPlace[]} planned @param {number} departs_ms @returns {FlightSample[]} */
function samplesOf({ battery_left_percent }, planned, departs_ms) {
  const samples = completed(
    planned.flatMap(({ at_s, position, altitude_amsl_m, altitude_relative_m, sequence }) =>
      at_s === null
        ? []
        : [
            {
              at_ms: departs_ms + at_s * 1_000,
              position,
              altitude_amsl_m,
              altitude_relative_m,
              waypoint: sequence,
              battery_percent: battery_left_percent?.[sequence] ?? null,
              isInAir: true,
            },
          ],
    ),
  );
  return samples.map((sample, index) => ({ ...sample, waypoint: samples[index + 1]?.waypoint ?? sample.waypoint }));
}

/** From the first sample to the last one; null where there is none. @param {readonly FlightRoute[]} routes */
export function spanOf(routes) {
  const moments = routes.flatMap(({ pieces }) =>
    pieces.flatMap((piece) => [firstOf(piece).at_ms, lastOf(piece).at_ms]),
  );
  return moments.length ? { from_ms: Math.min(...moments), to_ms: Math.max(...moments) } : null;
}

/** @param {Mission} detail @returns {FlightSource} */
export function planSource(detail) {
  const departs_ms = detail.departs_at ? Date.parse(detail.departs_at) : NO_DATE_MS;
  const routes = (detail.plan?.routes ?? [])
    .map((route, place) => {
      const planned = plannedOf(route);
      const samples = samplesOf(route, planned, departs_ms);
      /** @type {Piece[]} */
      const pieces = samples.length > 1 ? [{ kind: PLANNED, samples }] : [];
      return { place, name: route.uav, uav: route.uav_id, planned, pieces };
    })
    .filter(({ planned }) => planned.length);
  const wind = detail.plan?.conditions?.wind ?? [];
  return {
    kind: "plan",
    isSimulated: false,
    departs_ms,
    hasDate: Boolean(detail.departs_at),
    routes,
    colours: detail.colours,
    span: spanOf(routes),
    targets: targetsOf(routes, detail.targets),
    events: [],
    windAt: (_at_ms, height_m) => windAtHeight(wind, height_m),
  };
}

/**
 * Wind of layers by height: interpolated between two, outside the nearest. null without layers.
 *
 * @param {readonly WindLayerOutput[]} layers
 * @param {number} height_m
 * @returns {Wind | null}
 */
export function windAtHeight(layers, height_m) {
  if (!layers.length) return null;
  const sorted = [...layers].sort((a, b) => a.altitude_agl_m - b.altitude_agl_m);
  const above = sorted.find(({ altitude_agl_m }) => altitude_agl_m >= height_m) ?? sorted[sorted.length - 1];
  const below = sorted.findLast(({ altitude_agl_m }) => altitude_agl_m <= height_m) ?? sorted[0];
  const reach = above.altitude_agl_m - below.altitude_agl_m;
  const share = reach > 0 ? (height_m - below.altitude_agl_m) / reach : 0;
  /** @param {"sin" | "cos"} axis */
  const part = (axis) =>
    [below, above].map(({ speed_mps, from_deg }) => speed_mps * Math[axis]((from_deg * Math.PI) / 180));
  /** @param {"sin" | "cos"} axis */
  const mixed = (axis) => {
    const [low, high] = part(axis);
    return low + (high - low) * share;
  };
  const [east, north] = [mixed("sin"), mixed("cos")];
  return { speed_mps: Math.hypot(east, north), from_deg: ((Math.atan2(east, north) * 180) / Math.PI + 360) % 360 };
}
