/** Fleet and mission together, as values. */

import { routeLetter } from "../map/palette.js";

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
