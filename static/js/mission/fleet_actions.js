/** UAVs of a mission: chosen from the fleet, added to it, moved, given other values for this mission. */

import { post } from "../api.js";
import { say } from "../page/toast.js";
import { t, tn } from "../text.js";
import * as picks from "./selection.js";

/** context: see actions.js. */
export function createFleetActions({ store, selection, change }) {
  async function addUav(body) {
    const { data } = await post("/uavs", body);
    const uav = picks.uavOf(data);
    store.update({ fleet: [...store.state.fleet, uav] });
    change(picks.withUav(selection(), uav));
    say(t("{name} is added and chosen.", { name: uav.name }));
  }

  function addUavOfFleet(id) {
    const uav = store.state.fleet.find((known) => known.id === id);
    if (uav) change(picks.withUav(selection(), uav));
  }

  /** Several at once are one step of the history. */
  function addUavsOfFleet(ids) {
    const before = selection().uavs.length;
    change(ids.reduce((chosen, id) => picks.withUav(chosen, store.state.fleet.find((known) => known.id === id)), selection()));
    const added = selection().uavs.length - before;
    say(tn(added, "{count} UAV is chosen.", "{count} UAVs are chosen."));
  }

  return {
    addUav, addUavOfFleet, addUavsOfFleet,
    removeUav: (sequence) => change(picks.withoutUavAt(selection(), sequence)),
    moveUav: (sequence, position) => change(picks.withUavAt(selection(), sequence, position)),
    changeUav: (sequence, values) => change(picks.withUavAs(selection(), sequence, values)),
  };
}
