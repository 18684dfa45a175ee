/** A UAV as the live feed tells it, and its estimate, for tests. */

export const NOW_MS = Date.parse("2026-09-21T14:15:00Z");
export const ago = (seconds) => new Date(NOW_MS - seconds * 1000).toISOString();
export const plain = (text) => text.replace(/[\u00a0\u2009]/g, " ");

export const EACH_SECOND = { interval_s: 1, late_after_s: 5, silent_after_s: 10 };
export const EACH_TEN_SECONDS = { interval_s: 10, late_after_s: 25, silent_after_s: 30 };

export function uav({ id = 1, age_s = 0.7, estimated = null, place = 0, rhythm = EACH_SECOND, ...measured } = {}) {
  return {
    id,
    name: `UAV ${id}`,
    mission: "m",
    place,
    link: { mode: "Mission", is_in_air: true, waypoint_sequence: null },
    estimated,
    rhythm,
    measured: {
      measured_at: ago(age_s),
      received_at: ago(age_s),
      position: [10, 50],
      altitude_relative_m: 45,
      speed_mps: 9.8,
      heading_deg: 90,
      battery_percent: 71,
      mode: "Mission",
      is_in_air: true,
      ...measured,
    },
  };
}

export const estimate = (change = {}) => ({
  at: ago(0.5),
  report_at: ago(74),
  position: [10.01, 50],
  altitude_relative_m: 46,
  altitude_amsl_m: null,
  speed_mps: 10,
  heading_deg: 80,
  bound: { along_m: 410, across_m: 60, bearing_deg: 90, height_m: 5, speed_mps: 1 },
  is_measured: false,
  is_lost: false,
  waypoint_sequence: 3,
  along_route_m: 2000,
  to_go_m: 12_500,
  arrivals: [{ waypoint_sequence: 4, target: 2, at: ago(-235), earliest: ago(-200), latest: ago(-270) }],
  ends_at: ago(-1260),
  contact_expected_at: ago(-70),
  ...change,
});
