/** The one primary button, saving, and how far a long plan has come. */

import { byId } from "../../dom.js";
import { t } from "../../text.js";
import { percentText } from "../../units.js";
import { bestWordsOf, isUnsaved } from "../plan_view.js";

const isShareKnown = ({ share }) => share !== null && share !== undefined;

/** "51.2 km so far · 40 %"; of a job that no planner has taken yet: "waiting". */
export function howFarWords(planning) {
  if (planning.isQueued) return t("waiting");
  const { best, job, found, what, share } = planning;
  const words = bestWordsOf(best) || (job && found !== what ? found : "");
  return [words, isShareKnown(planning) ? percentText(share * 100) : ""].filter(Boolean).join(" · ");
}

export function mountFoot(store, actions) {
  const [plan, stop, save, cancel] = ["plan", "stop", "save", "cancel-planning"].map((id) =>
    document.getElementById(id),
  );
  if (!plan) return;
  plan.addEventListener("click", actions.plan);
  stop.addEventListener("click", actions.stop);
  cancel.addEventListener("click", actions.cancel);
  save.addEventListener("click", () => actions.save());

  store.listen(
    ["planning", "saving", "plan", "selection", "name", "mission", "planIsStored", "savedBasis"],
    (state) => {
      const isBusy = state.planning !== null;
      plan.querySelector("span").textContent = isBusy ? t("Planning") : state.plan ? t("Plan again") : t("Plan");
      plan.setAttribute("aria-busy", String(isBusy));
      stop.hidden = !isBusy;
      stop.textContent = state.planning?.isStopping
        ? t("Stopping")
        : state.planning?.job
          ? t("Stop, keep the best")
          : t("Stop");
      stop.setAttribute("aria-busy", String(Boolean(state.planning?.isStopping)));
      stop.disabled = Boolean(state.planning?.isStopping);
      cancel.hidden = !state.planning?.job || state.planning.isStopping || state.saving;
      save.hidden = isBusy;
      save.textContent = state.saving ? t("Saving") : t("Save");
      save.setAttribute("aria-busy", String(state.saving));
      const nothing = !isUnsaved(state);
      save.disabled = nothing && !state.mission; // a stored mission answers that it is saved
      save.title = nothing ? (state.mission ? t("Everything is saved") : t("Nothing to save yet")) : t("Save (Ctrl+S)");
    },
  );

  store.listen(["planning"], ({ planning }) => {
    byId("job").hidden = planning === null;
    if (!planning) return;
    const known = isShareKnown(planning);
    byId("job-what").textContent = planning.what;
    byId("job-how-far").textContent = howFarWords(planning);
    const bar = byId("job-progress");
    if (known) bar.setAttribute("aria-valuenow", String(Math.round(planning.share * 100)));
    else bar.removeAttribute("aria-valuenow");
    bar.firstElementChild.style.width = known ? `${planning.share * 100}%` : "12%";
  });
}
