/** Picking targets: every change is one step of the history. */

import { get } from "../api.js";
import { say, toast } from "../page/toast.js";
import { countText } from "../units.js";
import * as picks from "./selection.js";

const MOST_IN_A_BOX = 300;

/** context: see actions.js. */
export function createPicking({ store, history, selection, change, problem, failed }) {
  function addTargets(targets, { sayWhat = true } = {}) {
    const before = selection().targets.length;
    change(picks.withTargets(selection(), targets));
    const added = selection().targets.length - before;
    if (sayWhat) say(added ? `${countText(added, "target")} added, ${selection().targets.length} in all.` : "Already picked.");
    return added;
  }

  function removeTargets(keys) {
    if (!change(picks.withoutTargets(selection(), keys))) return;
    store.update({ chosenTarget: null, litTarget: null });
    toast(`${countText(keys.length, "target")} removed.`, { label: "Undo", act: () => history.undo() });
  }

  async function addBox(box) {
    try {
      const found = [];
      let next = `/assets?bbox=${box.map((degrees) => degrees.toFixed(6)).join(",")}&kind=tower,bridge&limit=100`;
      while (next && found.length <= MOST_IN_A_BOX) {
        const { data } = await get(next);
        found.push(...data.features);
        next = data.next;
      }
      if (found.length > MOST_IN_A_BOX) {
        problem(`More than ${MOST_IN_A_BOX} assets stand in the box.`, "Take a smaller one, or pick whole lines.", [], { untilChanged: true });
        return;
      }
      const added = addTargets(found.filter((feature) => feature.properties.is_flyable !== false).map(targetOfFeature));
      toast(
        found.length ? `${countText(added, "target")} added from the box.` : "No tower and no bridge stands in the box.",
        added ? { label: "Undo", act: () => history.undo() } : null,
      );
    } catch (error) {
      failed("The box could not be read.", error);
    }
  }

  const targetOfFeature = (feature) => picks.targetOf({ id: feature.id, kind: feature.properties.kind, properties: feature.properties, centre: feature.properties.centre });

  return {
    addTargets, addBox, removeTargets, targetOfFeature,
    undo: () => history.undo() && say("Undone."),
    redo: () => history.redo() && say("Done again."),
    setOption: (name, value) => change({ ...selection(), [name]: value }),
  };
}
