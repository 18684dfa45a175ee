/** Texts of the panel of simulated UAVs, and the requests of its buttons. */

import { t, tn } from "../../text.js";
import { heightText, numberText, percentText, speedText } from "../../units.js";

/** @import { SimulatedVehicle, Simulation } from "../../api_types.d.ts" */
/** @import { Told } from "../types.d.ts" */

/** @type {[number, string][]} */
export const SPEEDS = [1, 2, 5, 10].map((speed) => [
  speed,
  speed === 1 ? t("Real time") : t("{speed}× real time", { speed }),
]);
/** @type {[string, string][]} */
export const AIRS = [
  ["as-planned", t("As planned")],
  ["calm", t("Calm")],
  ["strong-wind", t("Strong wind")],
];
const WEAK_SHARE = 0.2;
const WIND_AGL_M = 10;
const BEHIND_S = 2; // of lost real time, from which on it is shown

/**
 * A fault by the name of its button.
 *
 * @typedef {object} Fault
 * @property {string} name
 * @property {string} image name of an icon
 * @property {string} words
 * @property {boolean} [lasts] it is over after a time
 * @property {(vehicle: SimulatedVehicle, flown_s: number) => object} of returns the request for a vehicle, for a duration in its own seconds
 */

/** Faults by the name of their button, with the request for a vehicle and a duration in its own seconds. */
export const FAULTS = /** @type {Fault[]} */ ([
  {
    name: "link",
    image: "signal",
    words: t("Lose the link"),
    lasts: true,
    of: (_, flown_s) => ({ link_lost_for_s: flown_s }),
  },
  {
    name: "gps",
    image: "locate-fixed",
    words: t("Lose GPS"),
    lasts: true,
    of: (_, flown_s) => ({ gps_lost_for_s: flown_s }),
  },
  {
    name: "battery",
    image: "gauge",
    words: t("Weak battery"),
    of: ({ battery_wh }) => ({ battery_wh_left: Math.round(battery_wh * WEAK_SHARE * 10) / 10 }),
  },
  { name: "motor", image: "octagon-alert", words: t("Motor failure"), of: () => ({ motor_failed: 0 }) },
]);
/** Repair of all faults that can be repaired; a battery stays as it is. */
export const WELL = /** @type {Fault} */ ({
  name: "well",
  image: "circle-check",
  words: t("Clear faults"),
  of: () => ({ link_lost_for_s: 0, gps_lost_for_s: 0, motor_failed: null }),
});

/** The same wind at all heights. @param {number} speed_mps @param {number} from_deg */
export const windOf = (speed_mps, from_deg, gusts_mps = 0) => ({
  wind: [{ altitude_agl_m: WIND_AGL_M, speed_mps, from_deg: ((from_deg % 360) + 360) % 360 }],
  gusts_mps,
});

/** @template {{ state: string }} Item @param {Item | null | undefined} simulation @returns {simulation is Item} */
export const isPresent = (simulation) => simulation?.state === "wanted" || simulation?.state === "flying";
/** @param {Pick<SimulatedVehicle, "state">} vehicle */
export const isFlown = (vehicle) => vehicle.state === "flying";

/** Wind and faults for all UAVs of the mission. */
export const ALL = "all";

/**
 * The vehicle that wind and faults apply to: the one chosen in the panel, else the UAV selected on the page, else none.
 *
 * @param {string} wished id of a vehicle, ALL, or empty
 * @param {number | null} selected UAV of the page
 * @param {Pick<SimulatedVehicle, "id" | "uav">[]} vehicles that fly
 * @returns {string} id of a vehicle, ALL, or empty
 */
export function meantFor(wished, selected, vehicles) {
  if (wished === ALL || vehicles.some(({ id }) => id === wished)) return wished;
  return vehicles.find(({ uav }) => uav !== null && uav.id === selected)?.id ?? "";
}

/**
 * Duration of `seconds` of the clock in the flight's own time; "" in real time.
 *
 * @param {number} seconds
 * @param {number} speed
 */
export function lastsWords(seconds, speed) {
  if (speed === 1 || !Number.isFinite(seconds)) return "";
  return t("{real} s real time = {flown} s simulated", {
    real: numberText(seconds),
    flown: numberText(Math.round(seconds * speed)),
  });
}

/** @param {SimulatedVehicle["conditions"]} conditions */
function airWords({ wind: [layer], gusts_mps }) {
  if (!layer?.speed_mps) return t("calm");
  const words = t("wind {speed} from {degrees}°", {
    speed: speedText(layer.speed_mps),
    degrees: Math.round(layer.from_deg),
  });
  return gusts_mps > 0 ? `${words}, ${t("gusts {speed}", { speed: speedText(gusts_mps) })}` : words;
}

/** How one of its UAVs does: { words, isBad }. @param {SimulatedVehicle} vehicle @returns {Told} */
export function vehicleWords({ state, message, report, conditions }) {
  if (state === "failed") return { words: message, isBad: true };
  if (state === "ended") return { words: t("Ended"), isBad: false };
  if (state === "wanted" || !report) return { words: t("starting"), isBad: false };
  if (report.is_crashed) return { words: t("crashed"), isBad: true };
  const place = report.is_in_air
    ? t("in the air at {height}", { height: heightText(report.altitude_relative_m) })
    : t("on the ground");
  return {
    words: [
      place,
      t("battery {figure}", { figure: percentText(report.battery_percent) }),
      airWords(conditions),
      report.is_link_lost && t("link lost"),
    ]
      .filter(Boolean)
      .join(" · "),
    isBad: false,
  };
}

/**
 * One sentence about a simulation, and whether it has a fault.
 *
 * @param {Simulation | null} simulation
 * @param {boolean} canFly
 * @returns {Told}
 */
export function stateWords(simulation, canFly) {
  if (!simulation) {
    const words = canFly
      ? t(
          "The UAVs of this mission are simulated: start them here, then upload the mission and fly it with the usual buttons.",
        )
      : t("The UAVs of this mission are simulated. An operator starts them.");
    return { words, isBad: false };
  }
  const flown = simulation.vehicles.filter(isPresent);
  const lost = simulation.vehicles.filter(({ state }) => state === "failed");
  if (simulation.state === "wanted") return { words: t("Waiting for a simulator."), isBad: false };
  if (simulation.state === "failed") return { words: simulation.message, isBad: true };
  if (simulation.state === "ended")
    return { words: t("The simulation is over: {why}", { why: simulation.message }), isBad: false };
  const crashed = flown.filter(({ report }) => report?.is_crashed);
  const summary = [
    simulation.speed === 1
      ? tn(flown.length, "{count} simulated UAV in real time.", "{count} simulated UAVs in real time.")
      : tn(
          flown.length,
          "{count} simulated UAV at {speed}× real time.",
          "{count} simulated UAVs at {speed}× real time.",
          { speed: simulation.speed },
        ),
    crashed.length > 0 && t("Crashed: {names}.", { names: crashed.map(({ name }) => name).join(", ") }),
    lost.length > 0 && t("Lost with their simulator: {names}.", { names: lost.map(({ name }) => name).join(", ") }),
    (simulation.step_timing?.slipped_s ?? 0) > BEHIND_S &&
      t("This machine is too slow for this speed: {seconds} s behind.", {
        seconds: Math.round(simulation.step_timing?.slipped_s ?? 0),
      }),
  ];
  return { words: summary.filter(Boolean).join(" "), isBad: crashed.length + lost.length > 0 };
}
