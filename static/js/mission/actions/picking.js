/** Picking targets: every change is one step of the history. */

import { announce, toast } from "../../page/toast.js";
import { t, tn } from "../../text.js";
import * as picks from "../selection.js";
import { takesViews, withTask, withViews } from "../tasks.js";
import { createNetworkPicking } from "./network_picking.js";

/** @import { AssetFeature } from "../../api_types.d.ts" */
/** @import { MissionContext, MissionSelection, PickedTarget, Task, Views, Wishes } from "../types.d.ts" */

/** The way back of the last step. @param {Pick<MissionContext, "history">} context */
const undoIn = ({ history }) => ({ label: t("Undo"), act: () => history.undo() });

/** @param {MissionContext} context */
export function createPicking(context) {
  const { store, selection, change, problem } = context;
  /** @param {number} count */
  const addedWords = (count) =>
    count ? tn(count, "{count} target added", "{count} targets added") : t("No target added");

  /**
   * Add targets that are not picked yet; announces where a mission's limit is reached. Returns how many were added.
   *
   * @param {PickedTarget[]} targets
   * @param {{ announceWhat?: boolean }} [how]
   */
  function addTargets(targets, { announceWhat = true } = {}) {
    const before = selection().targets.length;
    const next = picks.withTargets(selection(), targets);
    if (next.targets.length > picks.MAX_TARGETS && next.targets.length > before) {
      const words = t("{count} would come to {now} that are picked. Take fewer, or plan several missions.", {
        count: next.targets.length - before,
        now: before,
      });
      problem(t("A mission takes {most} targets.", { most: picks.MAX_TARGETS }), words, [], { untilChanged: true });
      return 0;
    }
    change(next);
    const added = selection().targets.length - before;
    if (announceWhat)
      announce(
        added
          ? t("{added}, {all} in all.", { added: addedWords(added), all: selection().targets.length })
          : t("Already picked."),
      );
    return added;
  }

  /**
   * Add many at once and announce it with an undo.
   *
   * @param {PickedTarget[]} targets
   * @param {(added: string) => string} words
   */
  function addMany(targets, words) {
    const added = addTargets(targets, { announceWhat: false });
    if (added || !store.state.problem) toast(words(addedWords(added)), added ? undoIn(context) : null);
    return added;
  }

  /** Other targets in place of those that are picked. @param {PickedTarget[]} targets @param {string} words */
  function replaceTargets(targets, words) {
    if (
      targets.length > picks.MAX_TARGETS ||
      !change({ ...selection(), targets: picks.withTargets(picks.EMPTY, targets).targets })
    )
      return;
    store.update({ chosenTarget: null, chosenTargets: [], litTarget: null });
    toast(words, undoIn(context));
  }

  /** @param {AssetFeature} feature */
  const targetOfFeature = (feature) =>
    picks.targetOf({
      id: feature.id,
      kind: feature.properties.kind,
      properties: feature.properties,
      centre: feature.properties.centre,
    });

  return {
    /** @param {string} title @param {string} text */
    notify: (title, text) => problem(title, text, [], { untilChanged: true }),
    addTargets,
    addMany,
    replaceTargets,
    ...createNetworkPicking(context, { addMany, addTargets }),
    ...createTargetChanges(context),
    targetOfFeature,
  };
}

/** Removal of targets, and changes of their tasks. @param {MissionContext} context */
function createTargetChanges(context) {
  const { store, history, selection, change } = context;
  const undo = undoIn(context);

  /** @param {string[]} keys */
  function removeTargets(keys) {
    if (!change(picks.withoutTargets(selection(), keys))) return;
    store.update({ chosenTarget: null, chosenTargets: [], litTarget: null });
    toast(tn(keys.length, "{count} target removed.", "{count} targets removed."), undo);
  }

  /** task: { kind, hold_s? } @param {string[]} keys @param {Task} task */
  function setTask(keys, task) {
    if (!change(withTask(selection(), keys, task))) return;
    toast(tn(keys.length, "The task of {count} target is set.", "The task of {count} targets is set."), undo);
  }

  /** Plans photos of targets. @param {string[]} keys @param {Views} views */
  function setViews(keys, views) {
    const set = selection().targets.filter((target) => keys.includes(target.key) && takesViews(target, views)).length;
    if (!change(withViews(selection(), keys, views))) return;
    toast(tn(set, "The task of {count} target is set.", "The task of {count} targets is set."), undo);
  }

  /** wishes: { priority } or { sensor } @param {string[]} keys @param {Partial<Wishes>} wishes */
  function setWish(keys, wishes) {
    if (!change(picks.withWishes(selection(), keys, wishes))) return;
    const words =
      "priority" in wishes
        ? tn(keys.length, "The priority of {count} target is set.", "The priority of {count} targets is set.")
        : tn(keys.length, "The sensor of {count} target is set.", "The sensor of {count} targets is set.");
    toast(words, undo);
  }

  return {
    removeTargets,
    setTask,
    setViews,
    setWish,
    undo: () => history.undo() && announce(t("Undone.")),
    redo: () => history.redo() && announce(t("Done again.")),
    /** @template {keyof MissionSelection} Name @param {Name} name @param {MissionSelection[Name]} value */
    setOption: (name, value) => change({ ...selection(), [name]: value }),
  };
}
