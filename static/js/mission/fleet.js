/** Fleet and mission together, as values. */

import { routeLetter } from "../domain/palette.js";
import { t, tn } from "../text.js";
import { exactEnergyText, lengthText, speedText } from "../units.js";

/** What the fleet knows of a UAV as it is now; a mission keeps its own name, start, figures, sensors and end. */
const factsIn = ({ base, base_name, type_name, battery_percent, state, is_simulated, usual }) => ({
  base,
  base_name,
  type_name,
  battery_percent,
  state,
  is_simulated,
  usual,
});

/** Those of the mission with place and letter, then the rest. A stored mission may carry UAVs that left the fleet. */
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

/** The same in the order of the fleet, so that a row stays where it is when it is ticked. */
export function inFleetOrder(state) {
  const place = (uav) => {
    const index = state.fleet.findIndex((known) => known.id === uav.id);
    return index < 0 ? state.fleet.length : index;
  };
  return standingUavs(state).sort((a, b) => place(a) - place(b));
}

/** Whether it may be taken along: in maintenance or retired it may not. */
export const canFly = ({ state }) => state === undefined || state === "active";

/** What a fleet can be narrowed by: { base, sensor, type }, each a list of the names that occur. */
export function choicesOf(fleet) {
  const names = (list) => [...new Set(list.filter(Boolean))].sort((a, b) => a.localeCompare(b));
  return {
    base: names(fleet.map(({ base_name }) => base_name)),
    sensor: names(fleet.flatMap(({ sensors }) => sensors ?? [])),
    type: names(fleet.map(({ type_name }) => type_name)),
  };
}

/** Whether a UAV is one of those that were asked for; an empty name asks for all. */
export function isAskedFor({ base_name, sensors, type_name }, { base = "", sensor = "", type = "" }) {
  return (
    (!base || base_name === base) && (!sensor || (sensors ?? []).includes(sensor)) && (!type || type_name === type)
  );
}

const END_WORDS = {
  hover: t("hovers at the end"),
  land: t("lands at the end"),
  return: t("returns to start"),
  base: t("lands at the nearest base"),
};

/** Of a full battery [Wh]: the mission's, else the fleet's; null where its energy is not counted. */
const batteryOf = ({ battery_wh, usual }) => (battery_wh === undefined ? (usual?.battery_wh ?? null) : battery_wh);

/** "range 80 km · 56.6 Wh · 12 m/s · hovers at the end · LiDAR": what a UAV can do and how its flight ends. */
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
  if (sorties > 1) facts.push(tn(sorties, "{count} flight", "up to {count} flights"));
  if (cruise_speed_mps) facts.push(speedText(cruise_speed_mps));
  const end = END_WORDS[returnsToStart ? "return" : end_action];
  return [...facts, end, sensors.join(", "), type_name].filter(Boolean).join(" · ");
}
