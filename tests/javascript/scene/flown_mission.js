/** A mission over level land, and how near a figure has to be: what tests of the 3D view share. */

import assert from "node:assert/strict";

import { makeFrame } from "../../../static/js/scene/frame.js";

export const T0 = Date.parse("2026-09-10T09:10:00Z");
export const HOME = [10, 55];
export const FRAME = makeFrame({ position: HOME, altitude_amsl_m: 40 });
export const near = (found, wanted, slack = 1e-6) =>
  assert.ok(Math.abs(found - wanted) <= slack, `${found} is not ${wanted}`);
export const nearAll = (found, wanted, slack) =>
  wanted.forEach((value, axis) => {
    near(found[axis], value, slack);
  });
export const eastOf = (metres, north_m = 0) => FRAME.toGeographic([metres, 0, -north_m]).slice(0, 2);

/** Numbers from 0 to 1, the same for a seed. */
export function numbers(seed) {
  let state = seed;
  return () => {
    state = (state * 48_271) % 2_147_483_647;
    return state / 2_147_483_647;
  };
}

export const WAYPOINTS = [
  ["start", 0, null],
  ["target", 300, 0],
  ["pass", 600, null],
  ["target", 900, 1],
  ["end", 0, null],
].map(([kind, east_m, target], index) => ({
  kind,
  target,
  position: eastOf(east_m),
  altitude_amsl_m: 100,
  altitude_agl_m: 60,
  altitude_relative_m: 60,
  sequence: index,
}));
export const MISSION = {
  id: "m",
  name: "North belt",
  uavs: [{ id: 3, is_simulated: true }],
  departs_at: "2026-09-10T09:10:00Z",
  state: "planned",
  targets: [
    { label: "Tower 1", asset: 7 },
    { label: "Tower 2", asset: 8 },
  ],
  plan: {
    conditions: { wind: [{ altitude_agl_m: 10, speed_mps: 4, from_deg: 270 }] },
    routes: [{ uav: "Wigeon", uav_id: 3, waypoints: WAYPOINTS, arrival_s: [0, 30, 60, 90, 180] }],
  },
};
