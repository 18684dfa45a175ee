/** What an operator does with a mission: pick, plan, stop, save, open. Each changes the store; the panels listen. */

import { ApiError, signInAddress } from "../../api.js";
import { t } from "../../text.js";
import { createManualEditing } from "../hand/manual_editing.js";
import { showBoth } from "../panels/both.js";
import { basisOf } from "../selection.js";
import { settled } from "../targets/locks.js";
import { createConflicts } from "./conflicts.js";
import { createFleetActions } from "./fleet_actions.js";
import { createLocking } from "./locking.js";
import { createOpening } from "./opening.js";
import { createPicking } from "./picking.js";
import { createPlanning } from "./planning.js";
import { createRallyPoints } from "./rally_points.js";
import { refusalOf } from "./refusals.js";
import { createRunningJob } from "./running_job.js";
import { createSaving } from "./saving.js";
import { createStoredMission } from "./stored_mission.js";

/** @import { MissionContext, MissionPageData, MissionSelection, MissionStore, ProblemOptions, WayOut } from "../types.d.ts" */

/**
 * @param {MissionStore} store
 * @param {MissionContext["history"]} history
 * @param {MissionPageData} page
 * @param {MissionContext["drafts"]} drafts
 */
export function createActions(store, history, page, drafts) {
  const context = createContext(store, history, page, drafts);
  const { waitForJob, makeRoom, ...planning } = createPlanning(context);
  const conflicts = createConflicts(
    context,
    { save: () => saving.save(), keepMineAsCopy: () => saving.keepMineAsCopy() },
    showBoth,
  );
  const saving = createSaving(context, { waitForJob, makeRoom }, conflicts);
  return {
    failed: context.failed,
    ...createPicking(context),
    ...createLocking(context),
    ...planning,
    ...saving,
    ...conflicts,
    ...createOpening(context, conflicts),
    ...createFleetActions(context),
    ...createRallyPoints(context),
    ...createManualEditing(context, { save: saving.save, keepOpen: createStoredMission(context).keepOpen }),
  };
}

/**
 * Create what the actions share: the selection and its history, and the report of problems.
 *
 * @param {MissionStore} store
 * @param {MissionContext["history"]} history
 * @param {MissionPageData} page
 * @param {MissionContext["drafts"]} drafts
 * @returns {MissionContext}
 */
function createContext(store, history, page, drafts) {
  const selection = () => store.state.selection;
  /** @param {MissionSelection} next */
  const change = (next) => history.changeTo(settled(next));

  /**
   * Show a problem until the next try; with `untilChanged` until the selection changes, across saves.
   *
   * @param {string} title
   * @param {string} text
   * @param {WayOut[]} [actions]
   * @param {ProblemOptions} [how]
   */
  function problem(title, text, actions = [], { untilChanged = false, level = "critical", isOfSaving = false } = {}) {
    store.update({
      problem: { title, text, actions, level, isOfSaving, about: untilChanged ? basisOf(selection()) : null },
    });
  }
  store.listen(["selection"], (state) => {
    if (state.problem?.about && state.problem.about !== basisOf(state.selection)) store.update({ problem: null });
  });

  /**
   * The text of an error, and what helps. `asked`: the selection that was refused.
   *
   * @param {unknown} error
   * @param {MissionSelection} [asked]
   * @returns {{ words: string, ways: WayOut[] | null }}
   */
  function read(error, asked = selection()) {
    if (!(error instanceof ApiError))
      return {
        words: t("Something failed on this page. Reload it; your selection is kept in this browser."),
        ways: null,
      };
    if (error.status !== 400) return { words: error.message, ways: null };
    const { words, ways } = refusalOf(error, asked) ?? { words: error.message, ways: [] };
    return {
      words,
      ways: ways.map(({ label, href, changed }) =>
        changed ? { label, act: () => change(changed(selection())) } : { label, href },
      ),
    };
  }

  /**
   * `actions` retry it: a refusal offers other actions.
   *
   * @param {string} title
   * @param {unknown} error
   * @param {WayOut[]} [actions]
   * @param {ProblemOptions} [how]
   */
  function failed(title, error, actions = [], how = {}) {
    if (error instanceof ApiError && error.isSignedOut) {
      const words = page.canPlan ? t("Your selection is kept in this browser.") : t("Sign in to go on.");
      problem(t("You are signed out."), words, [{ label: t("Sign in"), href: signInAddress }], {
        ...how,
        untilChanged: false,
      });
    } else {
      const { words, ways } = read(error, how.asked);
      problem(title, words, ways ?? actions, how);
    }
  }

  return {
    store,
    history,
    selection,
    change,
    problem,
    failed,
    wordsOf: (error) => read(error).words,
    page,
    drafts,
    running: { stopping: null },
    runningJob: createRunningJob({ user: page.userId }),
  };
}
