/** Fleet and mission together, as values. */

import { routeLetter } from "../map/palette.js";
import { lengthText, speedText } from "../units.js";

/** Those of the mission with place and letter, then the rest. A stored mission may carry UAVs that left the fleet. */
export function standingUavs({ selection, fleet }) {
  const chosen = selection.uavs.map((uav, sequence) => ({ ...uav, sequence, letter: routeLetter(sequence) }));
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

const END_WORDS = { hover: "hovers at the end", land: "lands at the end", return: "returns to start" };

/** "range 80 km · 12 m/s · hovers at the end": what a UAV can do and how its flight ends. */
export function factsOfUav({ max_range_m, cruise_speed_mps, end_action }, returnsToStart) {
  const facts = [max_range_m ? `range ${lengthText(max_range_m)}` : "range not stated"];
  if (cruise_speed_mps) facts.push(speedText(cruise_speed_mps));
  const end = END_WORDS[returnsToStart ? "return" : end_action];
  return end ? [...facts, end].join(" · ") : facts.join(" · ");
}
