/** The mission's name, state and one line of facts; what has to be said stands below. */

import { byId, h, icon } from "../../dom.js";
import { menuOf, toggleMenu } from "../../page/chrome.js";
import { t } from "../../text.js";
import { clockText, countText } from "../../units.js";
import { isPlanCurrent, isUnsaved, unreachedOf } from "../plan_view.js";

const STATE_WORDS = { draft: "Draft", planned: "Planned", approved: "Approved", dispatched: "Dispatched", active: "Active", completed: "Completed", aborted: "Aborted", failed: "Failed" };

export function mountHeader(store, actions, canPlan) {
  const name = byId("mission-name");
  name.addEventListener("input", () => actions.rename(name.value));
  name.addEventListener("keydown", (event) => {
    if (event.key === "Enter" || event.key === "Escape") name.blur();
  });

  const more = byId("mission-menu");
  more.addEventListener("click", () =>
    toggleMenu(more, () => {
      const { mission } = store.state;
      const items = [];
      if (canPlan && mission) {
        items.push({ icon: "copy", label: "Save a copy", act: () => actions.save({ asCopy: true }) });
        items.push({ icon: "trash-2", label: "Delete", act: actions.deleteMission });
      } else if (canPlan) items.push({ icon: "trash-2", label: "Clear everything", act: actions.startEmpty });
      items.push({ icon: "clipboard-list", label: "All missions", act: () => void (location.href = "/") });
      return menuOf("This mission", items);
    }),
  );

  store.listen(["name", "mission", "selection", "plan", "planIsStored", "savedBasis"], (state) => {
    const shown = state.name || (canPlan ? "New mission" : "Map");
    if (name.value !== state.name) name.value = state.name;
    byId("page-title").textContent = shown;
    byId("bar-title").textContent = shown;
    document.title = `${shown} · Spanwise`;
    const stateName = state.mission && !["draft", "planned"].includes(state.mission.state) ? state.mission.state : isPlanCurrent(state) ? "planned" : "draft";
    const chip = byId("mission-state");
    chip.className = `chip ${stateName}`;
    chip.textContent = STATE_WORDS[stateName];
    chip.hidden = !canPlan && !state.mission; // just the map: there is nothing that could be a draft
    byId("mission-facts").textContent = chip.hidden ? "no mission is open" : factsOf(state).join(" · ");
  });

  store.listen(["problem", "conflict", "plan", "selection", "mission"], (state) => {
    byId("notices").replaceChildren(...noticesOf(state, actions, canPlan, store));
  });
  store.listen(["problem", "conflict"], (state) => {
    if (state.problem || state.conflict) byId("notices").parentElement.scrollTo({ top: 0 }); // it stands above a long list
  });
}

function factsOf(state) {
  const targets = state.selection.targets.length;
  const facts = [];
  if (isPlanCurrent(state)) {
    const missed = state.plan.result.unassigned.length;
    facts.push(missed ? `${targets - missed} of ${countText(targets, "target")}` : countText(targets, "target"));
    if (state.planIsStored && state.mission?.planned_at) facts.push(`planned ${clockText(state.mission.planned_at)}`);
    if (state.plan.result.flat_ground_assumed) facts.push("flat ground assumed");
  } else {
    facts.push(targets ? countText(targets, "target") : "nothing picked yet");
    if (state.plan) facts.push("changed since it was planned");
  }
  if (isUnsaved(state)) facts.push("not saved");
  return facts;
}

function notice(level, image, title, text, acts = []) {
  return h(
    "div",
    { class: `notice ${level}`, role: level === "critical" ? "alert" : null },
    icon(image),
    h("p", {}, h("strong", {}, title), ` ${text} `, acts.map(way)),
  );
}

/** A way out of a notice: something to do here, or an address as it is when it is followed. */
function way({ label, act, href }) {
  if (act) return h("button", { type: "button", class: "text-button", onclick: act }, label);
  return h("a", { class: "text-button", href: href(), onclick: (event) => (event.currentTarget.href = href()) }, label);
}

function noticesOf(state, actions, canPlan, store) {
  const notices = [];
  if (state.problem) {
    const isAway = state.problem.title.includes("cannot be reached");
    notices.push(notice("critical", isAway ? "cloud-off" : "circle-alert", state.problem.title, state.problem.text, state.problem.actions));
  }
  if (state.conflict && isUnsaved(state)) {
    const title = `Your changes are from before ${state.conflict.whose} save at ${clockText(state.conflict.at)}.`;
    notices.push(
      notice("warning", "triangle-alert", title, "Both are kept.", [
        { label: "See theirs", act: actions.seeTheirs },
        { label: "Put mine on top", act: actions.putMineOnTop },
        { label: "Keep mine as a copy", act: actions.keepMineAsCopy },
      ]),
    );
  }
  const planAgain = canPlan ? [{ label: "Plan again", act: actions.plan }] : [];
  if (state.mission?.is_stale && state.planIsStored && isPlanCurrent(state)) {
    const [what, ...why] = (state.mission.stale_reason || "The ground has changed since this was planned.").split(/(?<=\.) /);
    notices.push(notice("warning", "triangle-alert", what, why.join(" "), planAgain));
  }
  if (isPlanCurrent(state)) {
    for (const warning of state.plan.result.warnings ?? []) notices.push(notice("warning", "triangle-alert", "", warning.message));
    const unreached = unreachedOf(state.plan);
    for (const { target, sentence } of unreached.slice(0, 3)) {
      const why = { label: t("Why?"), act: () => store.update({ why: { target: target.key } }) };
      const acts = canPlan ? [why, { label: t("Remove it"), act: () => actions.removeTargets([target.key]) }] : [why];
      notices.push(notice("warning", "triangle-alert", `${target.label} is not reached.`, sentence, acts));
    }
    if (unreached.length > 3) {
      const acts = canPlan ? [{ label: "Remove all that are not reached", act: () => actions.removeTargets(unreached.map(({ target }) => target.key)) }] : [];
      notices.push(notice("warning", "triangle-alert", `${countText(unreached.length - 3, "more target is", "more targets are")} not reached.`, "The list below says which.", acts));
    }
  }
  return notices;
}
