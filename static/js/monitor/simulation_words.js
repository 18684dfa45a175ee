/** What the panel of simulated UAVs says, and what its buttons send. */

import { t, tn } from "../text.js";

export const SPEEDS = [1, 2, 5, 10].map((speed) => [speed, speed === 1 ? t("Real time") : t("{speed} times real time", { speed })]);
export const AIRS = [["as-planned", t("Wind as planned")], ["calm", t("Calm")], ["strong-wind", t("Strong wind")]];
const WEAK_SHARE = 0.2;
const WIND_AGL_M = 10;
const BEHIND_S = 2; // of real time that was lost, from which on it is told

/** Faults by the name of their button: what is sent for a vehicle, for so many seconds. */
export const FAULTS = [
  { name: "link", image: "signal", words: t("Lose the link"), lasts: true, of: (_, seconds) => ({ link_lost_for_s: seconds }) },
  { name: "gps", image: "locate-fixed", words: t("Lose GPS"), lasts: true, of: (_, seconds) => ({ gps_lost_for_s: seconds }) },
  { name: "battery", image: "gauge", words: t("Weak battery"), of: ({ battery_wh }) => ({ battery_wh_left: Math.round(battery_wh * WEAK_SHARE * 10) / 10 }) },
  { name: "motor", image: "octagon-alert", words: t("Motor failure"), of: () => ({ motor_failed: 0 }) },
];

/** The same wind at all heights. */
export const windOf = (speed_mps, from_deg) => ({ wind: [{ altitude_agl_m: WIND_AGL_M, speed_mps, from_deg: ((from_deg % 360) + 360) % 360 }] });

export const isPresent = (simulation) => simulation?.state === "wanted" || simulation?.state === "flying";

/** One sentence about a simulation, and whether something is wrong with it. */
export function stateWords(simulation) {
  if (!simulation) return { words: t("Simulated UAVs can stand in for this mission's: they connect to the gateway as the UAVs would."), isBad: false };
  const flown = simulation.vehicles.filter(isPresent);
  const lost = simulation.vehicles.filter(({ state }) => state === "failed");
  if (simulation.state === "wanted") return { words: t("Waiting for a simulator."), isBad: false };
  if (simulation.state === "failed") return { words: simulation.message, isBad: true };
  if (simulation.state === "ended") return { words: simulation.message, isBad: false };
  const crashed = flown.filter(({ told }) => told?.is_crashed);
  const said = [
    simulation.speed === 1 ? tn(flown.length, "{count} simulated UAV in real time.", "{count} simulated UAVs in real time.") : tn(flown.length, "{count} simulated UAV at {speed} times real time.", "{count} simulated UAVs at {speed} times real time.", { speed: simulation.speed }),
    crashed.length > 0 && t("Crashed: {names}.", { names: crashed.map(({ name }) => name).join(", ") }),
    lost.length > 0 && t("Lost with their simulator: {names}.", { names: lost.map(({ name }) => name).join(", ") }),
    (simulation.pace?.slipped_s ?? 0) > BEHIND_S && t("This machine is too slow for that speed: {seconds} s behind.", { seconds: Math.round(simulation.pace.slipped_s) }),
  ];
  return { words: said.filter(Boolean).join(" "), isBad: crashed.length + lost.length > 0 };
}
