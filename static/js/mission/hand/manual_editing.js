/** Manual editing of one route: its points with undo and redo, their check by the server after each change, and saving. */

import { ApiError, request } from "../../api.js";
import { announce, toast } from "../../page/toast.js";
import { t } from "../../text.js";
import { isPlanCurrent } from "../plan/plan_view.js";
import * as hand from "./hand_route.js";
import { createManualEditChecks, NO_FAULTS } from "./manual_edit_checks.js";

/** @import { Answer } from "../../api.js" */
/** @import { Mission } from "../../api_types.d.ts" */
/** @import { HandEdit, HandPoint, MissionContext, MissionPageState, MissionStore, Version } from "../types.d.ts" */

/** @typedef {{ save: (how: { byItself: boolean }) => Promise<void>, keepOpen: (mission: Mission, asked: Version) => void }} Saving */
/** @typedef {(change: Partial<HandEdit>) => void} Put */

/** @param {HandPoint[]} original @param {number} sequence @returns {HandEdit} */
const beginningOf = (original, sequence) => ({
  sequence,
  original,
  points: original,
  chosen: null,
  dragged: null,
  look: null,
  isCheckOld: true,
  unknown: "",
  faults: NO_FAULTS,
  legs: new Map(),
  canUndo: false,
  canRedo: false,
  isSaving: false,
});

/**
 * Whether the edit is still open: planning again, choosing something else or closing the panel ends it.
 *
 * @param {Readonly<MissionPageState>} state
 */
function isStillOpen({ hand: edit, why, plan }) {
  if (!edit) return true;
  const route = plan?.result.routes[edit.sequence];
  const isShown = why?.manualEdit === edit.sequence && Boolean(route?.geometry);
  return isShown && route !== undefined && hand.pointsOf(route).length === edit.original.length;
}

/**
 * The points of the route with undo and redo.
 *
 * @param {MissionStore} store
 * @param {ReturnType<typeof createManualEditChecks>} looks
 */
function createSteps(store, { ask, knownOf, put }) {
  /** @type {HandPoint[][]} */
  let past = [];
  /** @type {HandPoint[][]} */
  let future = [];

  /** @param {HandEdit} edit @param {HandPoint[]} points @param {number | null} chosen */
  const show = (edit, points, chosen) => {
    put({
      points,
      chosen: chosen !== null && points[chosen] ? chosen : null,
      canUndo: past.length > 0,
      canRedo: future.length > 0,
      ...knownOf(edit, points),
    });
    void ask();
  };

  /**
   * One step of the history.
   *
   * @param {(points: HandPoint[]) => HandPoint[]} change
   * @param {number | null} chosen
   */
  function take(change, chosen) {
    const edit = store.state.hand;
    if (!edit) return false;
    const points = change(edit.points);
    if (points === edit.points) return false;
    past.push(edit.points);
    future = [];
    show(edit, points, chosen);
    return true;
  }

  /** @param {HandPoint[][]} from @param {HandPoint[][]} to */
  function step(from, to) {
    const [edit, points] = [store.state.hand, from.at(-1)];
    if (!edit || !points) return false;
    from.pop();
    to.push(edit.points);
    show(edit, points, edit.chosen);
    return true;
  }

  return {
    take,
    undo: () => step(past, future),
    redo: () => step(future, past),
    beginAnew() {
      past = [];
      future = [];
    },
  };
}

/**
 * Create the manual editing of a route. store.state.hand holds its whole state while a route is edited, else null.
 *
 * @param {MissionContext} context
 * @param {Saving} saving
 */
export function createManualEditing(context, saving) {
  const { store } = context;
  const looks = createManualEditChecks(context);
  const { ask, knownOf, put, forget } = looks;
  const { take, undo, redo, beginAnew } = createSteps(store, looks);
  const state = () => store.state.hand;

  /** Opens a route; the plan has to be the stored one, and is stored first where it is not. @param {number} sequence */
  async function begin(sequence) {
    if (!store.state.planIsStored || !isPlanCurrent(store.state)) await saving.save({ byItself: true });
    const { plan, planIsStored, mission } = store.state;
    const route = plan?.result.routes[sequence];
    if (!mission || !planIsStored || !isPlanCurrent(store.state) || !route?.geometry) {
      toast(t("A route is changed by hand once its plan is saved."));
      return;
    }
    beginAnew();
    forget();
    const edit = beginningOf(hand.pointsOf(route), sequence);
    store.update({ hand: edit, why: { manualEdit: sequence }, tool: "point" });
    void ask();
  }

  function end() {
    if (state()) store.update({ hand: null, why: store.state.why?.manualEdit === undefined ? store.state.why : null });
  }

  store.listen(["plan", "why"], (now) => {
    if (!isStillOpen(now)) end();
  });

  return {
    beginManually: begin,
    endManually: end,
    ...createKeeping(context, saving, { put, end }),
    /** @param {number | null} chosen */
    chooseManually: (chosen) => put({ chosen }),
    /**
     * Show and check a point while it is dragged; adds no step to the history.
     *
     * @param {HandPoint[]} points
     * @param {number} chosen
     */
    dragManually(points, chosen) {
      put({ dragged: points, chosen });
      const edit = state();
      if (edit) put(knownOf(edit, points));
      void ask();
    },
    /**
     * points: after the drop; null: unchanged.
     *
     * @param {HandPoint[] | null} points
     * @param {number | null} [chosen]
     */
    dropManually(points, chosen = null) {
      put({ dragged: null });
      if (points && take(() => points, chosen)) return;
      const edit = state();
      if (edit) put(knownOf(edit, edit.points));
    },
    /** @param {number} index @param {number[]} position */
    moveManually: (index, position) => take((points) => hand.moved(points, index, position), index),
    /** @param {number} index @param {number} height_m */
    raiseManually: (index, height_m) => take((points) => hand.raised(points, index, height_m), index),
    /** @param {number} index @param {number | null} speed_mps */
    setSpeedManually: (index, speed_mps) => take((points) => hand.paced(points, index, speed_mps), index),
    /** @param {number} index */
    insertManually: (index) => take((points) => hand.inserted(points, index), index + 1),
    /** @param {number} index */
    removeManually: (index) => take((points) => hand.dropped(points, index), null),
    undoManualEdit: undo,
    redoManualEdit: redo,
  };
}

/**
 * Storing the route as it is changed, and taking the last change back.
 *
 * @param {MissionContext} context
 * @param {Saving} saving
 * @param {{ put: Put, end: () => void }} editing
 */
function createKeeping({ store, history, selection, problem, wordsOf }, { keepOpen }, { put, end }) {
  /** @param {Mission} mission @param {string} name that the page had when the request was sent */
  function taken(mission, name) {
    end();
    keepOpen(mission, { selection: selection(), name });
    history.startFrom(selection()); // undo from here would plan again, and the manual edit would be lost
  }

  /**
   * Restore the route as it was before its last manual edit. If another user has changed the mission since, the user is notified.
   *
   * @param {number} sequence
   */
  async function takeBack(sequence) {
    const { mission, name } = store.state;
    if (!mission) return;
    put({ isSaving: true });
    try {
      const address = `/missions/${mission.id}/routes/${sequence}/waypoints/undo`;
      const { data } = /** @type {Answer<Mission>} */ (
        await request("POST", address, { headers: { "If-Match": `"${mission.revision}"` } })
      );
      taken(data, name);
      store.update({ problem: null }); // a redo could hold points that no longer exist
      toast(t("The last change by hand is taken back."));
    } catch (error) {
      put({ isSaving: false });
      toast(t("Not undone: {reason}", { reason: wordsOf(error) }));
    }
  }

  /** Show the server's faults at the points and legs concerned. @param {unknown} error */
  function showRefused(error) {
    const edit = store.state.hand;
    if (!edit) return;
    const faults = hand.faultsOf(error instanceof ApiError ? error.details : null);
    const places = faults.points.size + faults.legs.size;
    const reported = places || faults.other.length ? faults : { ...faults, other: [wordsOf(error)] };
    const [reason] = [...reported.other, ...reported.points.values(), ...reported.legs.values()];
    toast(t("Not kept: {reason}", { reason }));
    const [place = edit.chosen] = [...faults.points.keys(), ...faults.legs.keys()];
    put({ isSaving: false, faults: reported, chosen: place });
    if (error instanceof ApiError && error.isSignedOut) problem(t("You are signed out."), wordsOf(error));
  }

  return {
    async keepManually() {
      const { hand: edit, mission, name } = store.state;
      if (!edit || !mission) return;
      const { sequence, points, original } = edit;
      if (!hand.changesOf(points, original)) {
        end();
        return;
      }
      put({ isSaving: true });
      try {
        const { data } = /** @type {Answer<Mission>} */ (
          await request("PUT", `/missions/${mission.id}/routes/${sequence}/waypoints`, {
            body: hand.bodyOf(points),
            headers: { "If-Match": `"${mission.revision}"` },
          })
        );
        taken(data, name);
        announce(t("The route is kept as changed by hand."));
        toast(t("The route is kept as changed by hand."), { label: t("Undo"), act: () => takeBack(sequence) });
      } catch (error) {
        showRefused(error);
      }
    },
    takeBackManually: () => {
      const edit = store.state.hand;
      if (edit) void takeBack(edit.sequence);
    },
  };
}
