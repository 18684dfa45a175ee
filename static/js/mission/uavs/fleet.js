/** Fleet and mission together, as values. */

import { routeLetter } from "../../domain/palette.js";
import { t, tn } from "../../text.js";
import { exactEnergyText, lengthText, speedText } from "../../units.js";

/** @import { FleetUav, MissionPageState, PickedUav, StandingUav } from "../types.d.ts" */

/**
 * The fleet's present facts on a UAV; a mission keeps its own name, start, figures, sensors and end.
 *
 * @param {FleetUav} uav
 */
const factsIn = ({ base, base_name, type_name, battery_percent, state, missing, is_simulated, usual }) => ({
  base,
  base_name,
  type_name,
  battery_percent,
  state,
  missing,
  is_simulated,
  usual,
});

/**
 * Those of the mission with place and letter, then the rest. A stored mission may carry UAVs that left the fleet.
 *
 * @param {Pick<MissionPageState, "selection" | "fleet">} state
 * @returns {StandingUav[]}
 */
export function standingUavs({ selection, fleet }) {
  const chosen = selection.uavs.map((uav, sequence) => {
    const known = fleet.find((other) => other.id === uav.id);
    return {
      ...uav,
      ...(known ? factsIn(known) : {}),
      isGone: uav.id !== null && uav.id !== undefined && fleet.length > 0 && !known,
      sequence,
      letter: routeLetter(sequence),
    };
  });
  const ids = new Set(chosen.map((uav) => uav.id));
  return [...chosen, ...fleet.filter((uav) => !ids.has(uav.id)).map((uav) => ({ ...uav, sequence: null, letter: "" }))];
}

/**
 * The same in the order of the fleet, so that a row stays where it is when it is ticked.
 *
 * @param {Pick<MissionPageState, "selection" | "fleet">} state
 */
export function inFleetOrder(state) {
  /** @param {StandingUav} uav */
  const place = (uav) => {
    const index = state.fleet.findIndex((known) => known.id === uav.id);
    return index < 0 ? state.fleet.length : index;
  };
  return standingUavs(state).sort((a, b) => place(a) - place(b));
}

/** Whether it may be added: complete, and not in maintenance or retired. @param {Pick<PickedUav, "state" | "missing">} uav */
export const canFly = ({ state, missing }) => (state === undefined || state === "active") && !missing?.length;

/**
 * What a fleet can be narrowed by: { base, sensor, type }, each a list of the names that occur.
 *
 * @param {FleetUav[]} fleet
 */
export function choicesOf(fleet) {
  /** @param {(string | undefined)[]} list */
  const names = (list) => [...new Set(list.flatMap((name) => name || []))].sort((a, b) => a.localeCompare(b));
  return {
    base: names(fleet.map(({ base_name }) => base_name)),
    sensor: names(fleet.flatMap(({ sensors }) => sensors ?? [])),
    type: names(fleet.map(({ type_name }) => type_name)),
  };
}

/**
 * Whether a UAV matches the filters; an empty name matches all.
 *
 * @param {Pick<PickedUav, "base_name" | "sensors" | "type_name">} uav
 * @param {{ base?: string, sensor?: string, type?: string }} asked
 */
export function isAskedFor({ base_name, sensors, type_name }, { base = "", sensor = "", type = "" }) {
  return (
    (!base || base_name === base) && (!sensor || (sensors ?? []).includes(sensor)) && (!type || type_name === type)
  );
}

/** @type {Record<NonNullable<PickedUav["end_action"]>, string>} */
const END_WORDS = {
  hover: t("hovers at the end"),
  land: t("lands at the end"),
  return: t("returns to start"),
  base: t("lands at the nearest base"),
};

/**
 * Capacity of the battery [Wh]: the mission's, else the fleet's; null where its energy is not counted.
 *
 * @param {Pick<PickedUav, "battery_wh" | "usual">} uav
 */
const batteryOf = ({ battery_wh, usual }) => (battery_wh === undefined ? (usual?.battery_wh ?? null) : battery_wh);

/**
 * "range 80 km · 56.6 Wh · 12 m/s · hovers at the end · LiDAR": what a UAV can do and how its flight ends.
 *
 * @param {PickedUav} uav
 * @param {boolean} [returnsToStart]
 */
export function factsOfUav(
  { max_range_m, cruise_speed_mps, end_action, most_targets = null, sorties = 1, type_name, sensors = [], ...figures },
  returnsToStart,
) {
  const most = most_targets === null ? [] : [tn(most_targets, "at most {count} target", "at most {count} targets")];
  const facts = [
    ...most,
    max_range_m ? t("range {length}", { length: lengthText(max_range_m) }) : t("range not stated"),
  ];
  const battery_wh = batteryOf(figures);
  if (battery_wh !== null) facts.push(exactEnergyText(battery_wh));
  if (sorties > 1) facts.push(t("up to {count} flights", { count: sorties }));
  if (cruise_speed_mps) facts.push(speedText(cruise_speed_mps));
  const ending = returnsToStart ? "return" : end_action;
  const end = ending && END_WORDS[ending];
  return [...facts, end, sensors.join(", "), type_name].filter(Boolean).join(" · ");
}
