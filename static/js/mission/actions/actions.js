/** What an operator does with a mission: pick, plan, stop, save, open. Each changes the store; the panels listen. */

import { ApiError, signInAddress } from "../../api.js";
import { t } from "../../text.js";
import { createHandEditing } from "../hand/hand_editing.js";
import { settled } from "../locks.js";
import { showBoth } from "../panels/both.js";
import { basisOf } from "../selection.js";
import { createConflicts } from "./conflicts.js";
import { createFleetActions } from "./fleet_actions.js";
import { createLocking } from "./locking.js";
import { createPicking } from "./picking.js";
import { createPlanning } from "./planning.js";
import { createRallyPoints } from "./rally_points.js";
import { refusalOf } from "./refusals.js";
import { createRunningJob } from "./running_job.js";
import { createSaving } from "./saving.js";

/** page: { mission, canPlan, userName }; drafts: see draft.js. */
export function createActions(store, history, page, drafts) {
  const selection = () => store.state.selection;
  const change = (next) => history.changeTo(settled(next));

  /** Stays until the next try; with `untilChanged` until something else is picked, whatever is saved meanwhile. */
  function problem(title, text, actions = [], { untilChanged = false, level = "critical", isOfSaving = false } = {}) {
    store.update({
      problem: { title, text, actions, level, isOfSaving, about: untilChanged ? basisOf(selection()) : null },
    });
  }
  store.listen(["selection"], (state) => {
    if (state.problem?.about && state.problem.about !== basisOf(state.selection)) store.update({ problem: null });
  });

  /** What an error says, and what helps: { words, ways }. `asked`: the selection that was refused. */
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
      ways: ways.map(({ changed, ...way }) => (changed ? { ...way, act: () => change(changed(selection())) } : way)),
    };
  }

  /** `actions` try it again: what the server refuses as it stands has other ways out. */
  function failed(title, error, actions = [], how = {}) {
    if (error.isSignedOut) {
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

  const context = {
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
  const { waitForJob, makeRoom, ...planning } = createPlanning(context);
  let saving = null;
  const conflicts = createConflicts(context, () => saving, showBoth);
  saving = createSaving(context, { waitForJob, makeRoom }, conflicts);
  return {
    failed,
    ...createPicking(context),
    ...createLocking(context),
    ...planning,
    ...saving,
    ...conflicts,
    ...createFleetActions(context),
    ...createRallyPoints(context),
    ...createHandEditing(context, saving),
  };
}
