/** The one primary button, saving, and how far a long plan has come. */

import { byId } from "../../dom.js";
import { percentText } from "../../units.js";
import { isUnsaved } from "../plan_view.js";

export function mountFoot(store, actions) {
  const [plan, stop, save] = ["plan", "stop", "save"].map((id) => document.getElementById(id));
  if (!plan) return;
  plan.addEventListener("click", actions.plan);
  stop.addEventListener("click", actions.stop);
  save.addEventListener("click", () => actions.save());

  store.listen(["planning", "saving", "plan", "selection", "name", "mission", "planIsStored", "savedBasis"], (state) => {
    const isBusy = state.planning !== null;
    plan.querySelector("span").textContent = isBusy ? "Planning" : state.plan ? "Plan again" : "Plan";
    plan.setAttribute("aria-busy", String(isBusy));
    stop.hidden = !isBusy;
    save.hidden = isBusy;
    save.textContent = state.saving ? "Saving" : "Save";
    save.setAttribute("aria-busy", String(state.saving));
    const nothing = !isUnsaved(state);
    save.disabled = nothing;
    save.title = nothing ? (state.mission ? "Everything is saved" : "Nothing to save yet") : "Save (Ctrl+S)";
  });

  store.listen(["planning"], ({ planning }) => {
    byId("job").hidden = planning === null;
    if (!planning) return;
    const known = planning.share !== null && planning.share !== undefined;
    byId("job-what").textContent = planning.what;
    byId("job-how-far").textContent = known ? percentText(planning.share * 100) : "";
    const bar = byId("job-progress");
    if (known) bar.setAttribute("aria-valuenow", String(Math.round(planning.share * 100)));
    else bar.removeAttribute("aria-valuenow");
    bar.firstElementChild.style.width = known ? `${planning.share * 100}%` : "12%";
  });
}
