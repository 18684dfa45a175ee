/** The mission's name, state and one line of facts; what has to be said stands below. */

import { openAlertLimits } from "../../alert_limits/dialog.js";
import { ApiError } from "../../api.js";
import { byId, h, icon } from "../../dom.js";
import { menuOf, toggleMenu } from "../../page/chrome.js";
import { toast } from "../../page/toast.js";
import { markSimulated } from "../../simulated.js";
import { t, tn } from "../../text.js";
import { clockText } from "../../units.js";
import { standingUavs } from "../fleet.js";
import { departureText } from "../flight_options.js";
import { isPlanCurrent, isUnsaved, unreachedOf } from "../plan_view.js";
import { inWords } from "../plan_words.js";
import { showHistory } from "./history.js";
import { uavNotice } from "./uavs/changes.js";

const STATE_WORDS = {
  draft: t("Draft"),
  planned: t("Planned"),
  approved: t("Approved"),
  dispatched: t("Dispatched"),
  active: t("Active"),
  completed: t("Completed"),
  aborted: t("Aborted"),
  failed: t("Failed"),
};
const MOST_CAUSES = 3;
const targetsText = (count) => tn(count, "{count} target", "{count} targets");

/** The mission's address with the part of the map that is in sight. */
async function copyAddress(mission) {
  const address = `${location.origin}/missions/${mission.id}${location.hash}`;
  try {
    await navigator.clipboard.writeText(address);
    toast(t("The address with this view of the map is copied."));
  } catch {
    toast(address); // without the clipboard: there to be marked and copied
  }
}

async function changeAlertLimits({ id, name }) {
  const hint = t(
    "For this mission alone, also while it flies. Empty: as the type of each UAV says, else the usual, in grey.",
  );
  try {
    await openAlertLimits({
      address: `/missions/${id}/alert-limits`,
      title: t("Where alerts begin: {name}", { name }),
      hint,
    });
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    toast(error.message);
  }
}

/** canCopy: who plans missions may copy one that nobody can change; showPlace(position): on the map. */
export function mountHeader(store, actions, canPlan, { canCopy, showPlace }) {
  const name = byId("mission-name");
  name.addEventListener("input", () => actions.rename(name.value));
  name.addEventListener("blur", () => {
    if (!name.value.trim() && store.state.mission) actions.rename(store.state.mission.name);
  });
  name.addEventListener("keydown", (event) => {
    if (event.key === "Enter" || event.key === "Escape") name.blur();
  });

  const more = byId("mission-menu");
  more.addEventListener("click", () =>
    toggleMenu(more, () => {
      const { mission } = store.state;
      const items = [];
      if (mission) {
        items.push({ icon: "link", label: t("Copy the address with this view"), act: () => void copyAddress(mission) });
        items.push({ icon: "history", label: t("History"), act: () => void showHistory(mission) });
      }
      if (canCopy && mission)
        items.push({ icon: "bell", label: t("Where alerts begin"), act: () => void changeAlertLimits(mission) });
      if (canCopy && mission)
        items.push({ icon: "copy", label: t("Save a copy"), act: () => actions.save({ asCopy: true }) });
      if (canPlan && mission) items.push({ icon: "trash-2", label: t("Delete"), act: actions.deleteMission });
      else if (canPlan) items.push({ icon: "trash-2", label: t("Clear everything"), act: actions.startEmpty });
      items.push({ icon: "clipboard-list", label: t("All missions"), act: () => void (location.href = "/") });
      return menuOf(t("This mission"), items);
    }),
  );

  store.listen(["name", "mission", "selection", "fleet", "plan", "planIsStored", "savedBasis"], (state) => {
    const shown = state.name || (canPlan ? t("New mission") : t("Map"));
    if (name.value !== state.name) name.value = state.name;
    byId("page-title").textContent = shown;
    byId("bar-title").textContent = shown;
    document.title = `${shown} · Spanwise`;
    const stateName =
      state.mission && !["draft", "planned"].includes(state.mission.state)
        ? state.mission.state
        : isPlanCurrent(state)
          ? "planned"
          : "draft";
    const chip = byId("mission-state");
    chip.className = `chip ${stateName}`;
    chip.textContent = STATE_WORDS[stateName];
    const flown = standingUavs(state).filter(({ sequence }) => sequence !== null);
    markSimulated(chip, flown.length > 0 && flown.every(({ is_simulated }) => is_simulated));
    chip.hidden = !canPlan && !state.mission; // just the map: there is nothing that could be a draft
    byId("mission-facts").textContent = chip.hidden ? t("no mission is open") : factsOf(state).join(" · ");
  });

  store.listen(["problem", "conflict", "plan", "planIsStored", "selection", "mission", "isAway"], (state) => {
    byId("notices").replaceChildren(
      ...noticesOf(state, actions, { canPlan, showPlace, askWhy: (why) => store.update({ why }) }),
    );
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
    facts.push(
      missed
        ? tn(targets, "{reached} of {count} target", "{reached} of {count} targets", { reached: targets - missed })
        : targetsText(targets),
    );
    if (state.planIsStored && state.mission?.planned_at)
      facts.push(t("planned {time}", { time: clockText(state.mission.planned_at) }));
    if (state.plan.result.flat_ground_assumed) facts.push(t("flat ground assumed"));
  } else {
    facts.push(targets ? targetsText(targets) : t("nothing picked yet"));
    if (state.plan) facts.push(t("changed since it was planned"));
  }
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

function noticesOf(state, actions, { canPlan, showPlace, askWhy }) {
  const notices = [];
  if (state.problem) {
    const { level, title, text, actions: ways } = state.problem;
    const image = level === "warning" ? "triangle-alert" : state.isAway ? "cloud-off" : "circle-alert";
    notices.push(notice(level, image, title, text, ways));
  } else if (state.isAway) {
    const words = canPlan
      ? t("You can go on: what you change is kept in this browser and saved when the server is back.")
      : t("What you see may be out of date.");
    notices.push(notice("warning", "cloud-off", t("The server cannot be reached."), words));
  }
  if (state.conflict && isUnsaved(state)) {
    const title = t("Your changes are from before {whose} save at {time}.", {
      whose: state.conflict.whose,
      time: clockText(state.conflict.at),
    });
    notices.push(
      notice("warning", "triangle-alert", title, t("Both are kept."), [
        { label: t("See both"), act: actions.seeBoth },
        { label: t("Keep mine as a copy"), act: actions.keepMineAsCopy },
      ]),
    );
  }
  const changed = uavNotice(state, actions, canPlan);
  if (changed) notices.push(changed);
  const isOtherwiseStale =
    state.mission?.is_stale && !(state.mission.stale_causes ?? []).every(({ what }) => what === "uav");
  if (isOtherwiseStale && state.planIsStored && isPlanCurrent(state))
    notices.push(staleNotice(state.mission, actions, { canPlan, showPlace }));
  if (isPlanCurrent(state)) {
    for (const warning of state.plan.result.warnings ?? [])
      notices.push(notice("warning", "triangle-alert", "", inWords(warning.message)));
    const unreached = unreachedOf(state.plan);
    for (const { target, sentence } of unreached.slice(0, 3)) {
      const why = { label: t("Why?"), act: () => askWhy({ target: target.key }) };
      const acts = canPlan ? [why, { label: t("Remove it"), act: () => actions.removeTargets([target.key]) }] : [why];
      notices.push(
        notice("warning", "triangle-alert", t("{target} is not reached.", { target: target.label }), sentence, acts),
      );
    }
    if (unreached.length > 3) {
      const acts = canPlan
        ? [
            {
              label: t("Remove all that are not reached"),
              act: () => actions.removeTargets(unreached.map(({ target }) => target.key)),
            },
          ]
        : [];
      notices.push(
        notice(
          "warning",
          "triangle-alert",
          tn(unreached.length - 3, "{count} more target is not reached.", "{count} more targets are not reached."),
          t("The list below says which."),
          acts,
        ),
      );
    }
  }
  return notices;
}

/** What of the ground changed since the plan was made, what of the mission that touches, and the way out. UAVs have a notice of their own. */
function staleNotice(mission, actions, { canPlan, showPlace }) {
  const causes = mission.stale_causes.filter(({ what }) => what !== "uav");
  const isOfGround = causes[0] === mission.stale_causes[0];
  const headline = isOfGround
    ? mission.stale_reason.split(/(?<=\.) /)[0]
    : t("The ground has changed since this was planned.");
  const planAgain = canPlan && way({ label: t("Plan again"), act: actions.plan });
  const lines = causes
    .slice(0, MOST_CAUSES)
    .map((cause) =>
      h(
        "li",
        {},
        cause.message,
        " ",
        cause.from &&
          `${t("There from {start} to {end}.", { start: departureText(cause.from), end: clockText(cause.to) })} `,
        cause.position && way({ label: t("See the place"), act: () => showPlace(cause.position) }),
      ),
    );
  const more = causes.length - lines.length;
  return h(
    "div",
    { class: "notice warning" },
    icon("triangle-alert"),
    h(
      "div",
      {},
      h("p", {}, h("strong", {}, headline)),
      h("ul", { class: "causes" }, lines),
      more > 0 && h("p", { class: "caption" }, tn(more, "{count} more place", "{count} more places")),
      planAgain && h("p", {}, planAgain),
    ),
  );
}
