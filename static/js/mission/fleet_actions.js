/** UAVs of a mission: chosen from the fleet, added to it, moved, given other values for this mission. */

import { post } from "../api.js";
import { say } from "../page/toast.js";
import * as picks from "./selection.js";

/** context: see actions.js. */
export function createFleetActions({ store, selection, change }) {
  async function addUav(body) {
    const { data } = await post("/uavs", body);
    const uav = picks.uavOf(data);
    store.update({ fleet: [...store.state.fleet, uav] });
    change(picks.withUav(selection(), uav));
    say(`${uav.name} is added and chosen.`);
  }

  function addUavOfFleet(id) {
    const uav = store.state.fleet.find((known) => known.id === id);
    if (uav) change(picks.withUav(selection(), uav));
  }

  return {
    addUav, addUavOfFleet,
    removeUav: (sequence) => change(picks.withoutUavAt(selection(), sequence)),
    moveUav: (sequence, position) => change(picks.withUavAt(selection(), sequence, position)),
    changeUav: (sequence, values) => change(picks.withUavAs(selection(), sequence, values)),
  };
}
