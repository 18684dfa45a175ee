/** UAVs of a mission: chosen from the fleet, added, moved, with other values for this mission. */

import { post } from "../../api.js";
import { announce, toast } from "../../page/toast.js";
import { t, tn } from "../../text.js";
import { uavOf, withoutUavAt, withUav, withUavAs, withUavAt } from "../uavs/mission_uavs.js";
import { openChanges, withFleetFigures, withPresentFigures } from "../uavs/uav_changes.js";

/** @import { Answer } from "../../api.js" */
/** @import { UavFeature, UavWriteRequest } from "../../api_types.d.ts" */
/** @import { FleetUav, MissionContext, PickedUav } from "../types.d.ts" */

/** context: see actions.js. @param {MissionContext} context */
export function createFleetActions({ store, selection, change }) {
  /**
   * Add UAVs in one step of the history; announces where one has another name in this mission. Returns how many were added.
   *
   * @param {FleetUav[]} uavs
   */
  function takeAlong(uavs) {
    const before = selection().uavs.length;
    change(uavs.reduce(withUav, selection()));
    const added = selection().uavs.slice(before);
    const renamed = uavs
      .map(({ id, name }) => ({ name, other: added.find((uav) => uav.id === id)?.name ?? name }))
      .find(({ name, other }) => other !== name);
    if (renamed) toast(t("{name} is called {other} in this mission: another UAV has its name.", renamed));
    return added.length;
  }

  /** @param {UavWriteRequest} body */
  async function addUav(body) {
    const { data } = /** @type {Answer<UavFeature>} */ (await post("/uavs", body));
    const uav = uavOf(data);
    store.update({ fleet: [...store.state.fleet, uav] });
    takeAlong([uav]);
    announce(t("{name} is added and chosen.", { name: uav.name }));
  }

  /** @param {number} id */
  function addUavOfFleet(id) {
    const uav = store.state.fleet.find((known) => known.id === id);
    if (uav) takeAlong([uav]);
  }

  /** @param {number[]} ids */
  function addUavsOfFleet(ids) {
    const added = takeAlong(ids.flatMap((id) => store.state.fleet.find((known) => known.id === id) ?? []));
    announce(tn(added, "{count} UAV is chosen.", "{count} UAVs are chosen."));
  }

  function takePresentFigures() {
    const before = selection();
    change(withPresentFigures(before, openChanges(before, store.state.mission?.uav_changes)));
    toast(t("The present figures are taken."), { label: t("Undo"), act: () => change(before) });
  }

  function takeFleetFigures() {
    const before = selection();
    change(withFleetFigures(before, openChanges(before, store.state.mission?.uav_changes)));
    toast(t("The fleet's figures are taken."), { label: t("Undo"), act: () => change(before) });
  }

  return {
    takePresentFigures,
    takeFleetFigures,
    addUav,
    addUavOfFleet,
    addUavsOfFleet,
    /** @param {number} sequence */
    removeUav: (sequence) => change(withoutUavAt(selection(), sequence)),
    /** @param {number} sequence @param {number[]} position */
    moveUav: (sequence, position) => change(withUavAt(selection(), sequence, position)),
    /** @param {number} sequence @param {Partial<PickedUav>} values */
    changeUav: (sequence, values) => change(withUavAs(selection(), sequence, values)),
  };
}
