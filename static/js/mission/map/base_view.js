/** Where a new mission opens: round the places where UAVs stand. Values in, values out. */

import { distance_m } from "../../domain/geodesy.js";

/** @import { FleetUav } from "../types.d.ts" */
/** @import { Box } from "../../map/types.d.ts" */

const TOGETHER_M = 100_000; // bases of one region
const MARGIN_DEG = 0.06;

/** The box round the UAVs of the region where most of them stand; null without any. @param {Pick<FleetUav, "position">[]} fleet @returns {Box | null} */
export function baseView(fleet) {
  const groups = fleet.map(({ position }) =>
    fleet.filter((other) => distance_m(position, other.position) <= TOGETHER_M),
  );
  const most = groups.reduce((best, group) => (group.length > best.length ? group : best), groups[0] ?? []);
  if (!most.length) return null;
  const [longitudes, latitudes] = [0, 1].map((axis) => most.map(({ position }) => position[axis]));
  return [
    Math.min(...longitudes) - MARGIN_DEG,
    Math.min(...latitudes) - MARGIN_DEG,
    Math.max(...longitudes) + MARGIN_DEG,
    Math.max(...latitudes) + MARGIN_DEG,
  ];
}
