/** The mission's name, state and one line of facts, with notices below. */

import { openAlertLimits } from "../../alert_limits/dialog.js";
import { ApiError } from "../../api.js";
import { byId, h, icon, refill } from "../../dom.js";
import { groundCauses } from "../../domain/flying.js";
import { MISSION_STATES, plannedChip, REHEARSAL_FAILED } from "../../domain/planned_state.js";
import { menuOf, toggleMenu } from "../../page/chrome.js";
import { toast } from "../../page/toast.js";
import { markSimulated } from "../../simulated.js";
import { t, tn } from "../../text.js";
import { clockText } from "../../units.js";
import { rehearsalOfPlan } from "../flying/briefing.js";
import { departureText } from "../options/flight_options.js";
import { planFromLaunchSites, whyNoCampaign } from "../options/launch_sites.js";
import { factsOf } from "../plan/head_facts.js";
import { isPlanCurrent, isUnsaved, unassignedOf } from "../plan/plan_view.js";
import { proposedName } from "../targets/proposed_name.js";
import { standingUavs } from "../uavs/fleet.js";
import { unassignedCards } from "../unassigned/cards.js";
import { causesOf } from "../unassigned/causes.js";
import { showHistory } from "./history.js";
import { showLegalTimes } from "./options/legal_times.js";
import { shownChanges, uavNotice } from "./uavs/changes.js";

/** @import { Mission } from "../../api_types.d.ts" */
/** @import { Child } from "../../dom.js" */
/** @import { MenuItem } from "../../page/chrome.js" */
/** @import { CardContext } from "../unassigned/cards.js" */
/** @import { Conflict, MissionActions, MissionPageState, MissionStore, WayOut } from "../types.d.ts" */

/** @typedef {(position: number[]) => void} ShowPlace on the map */
/**
 * @typedef {object} OfNotices
 * @property {ShowPlace} showPlace
 */
/** @typedef {CardContext & OfNotices} NoticeContext */

const phone = matchMedia("(max-width: 720px)");
const MAX_CAUSES = 3;

/** The mission's address with the part of the map that is in sight. @param {Mission} mission */
async function copyAddress(mission) {
  const address = `${location.origin}/missions/${mission.id}${location.hash}`;
  try {
    await navigator.clipboard.writeText(address);
    toast(t("Link copied."));
  } catch {
    toast(address); // without the clipboard: there to be marked and copied
  }
}

/** @param {Mission} mission */
async function changeAlertLimits({ id, name }) {
  const hint = t("For this mission only, also in flight. Blank: value of each UAV's type, else default (grey).");
  try {
    await openAlertLimits({
      address: `/missions/${id}/alert-limits`,
      title: t("Alert thresholds: {name}", { name }),
      hint,
    });
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    toast(error.message);
  }
}

/**
 * @param {MissionStore} store
 * @param {MissionActions} actions
 * @param {boolean} canPlan
 * @param {{ canCopy: boolean, canCurate: boolean, showPlace: ShowPlace, addUavAt: (position: number[]) => void,
 *   showPlaces: (positions: number[][]) => void }} how `canCopy`: users who plan missions may copy a read-only one
 */
export function mountHeader(store, actions, canPlan, { canCopy, canCurate, showPlace, showPlaces, addUavAt }) {
  const name = byId("mission-name", HTMLInputElement);
  name.addEventListener("input", () => actions.rename(name.value));
  name.addEventListener("blur", () => {
    if (!name.value.trim() && store.state.mission) actions.rename(store.state.mission.name);
  });
  name.addEventListener("keydown", (event) => {
    if (event.key === "Enter" || event.key === "Escape") name.blur();
  });

  const more = byId("mission-menu");
  more.addEventListener("click", () =>
    toggleMenu(more, () =>
      menuOf(t("This mission"), [
        ...(canPlan ? [campaignItem(store.state)] : []),
        ...itemsFor(store.state.mission, actions, { canPlan, canCopy }),
        ...(canCurate
          ? [{ icon: "zone", label: t("Temporary no-fly zone"), act: () => store.update({ tool: "zone" }) }]
          : []),
      ]),
    ),
  );

  store.listen(
    ["name", "mission", "selection", "fleet", "plan", "planIsStored", "savedBasis", "arrival", "rehearsal"],
    (state) => {
      if (name.value !== state.name) name.value = state.name;
      drawHead(state, canPlan);
    },
  );

  /** @type {NoticeContext} */
  const context = {
    actions,
    canPlan,
    canCurate,
    showPlace,
    askWhy: (why) => store.update({ why }),
    showTogether(positions, zones) {
      store.update({ litZones: zones });
      showPlaces(positions);
    },
    addUavAt,
    lookForDeparture: () => showLegalTimes(store, actions),
    planFromLaunchSites: () => void planFromLaunchSites(store.state),
  };
  const keyOfNotices = createNoticesKey(canPlan);
  store.listen(["problem", "conflict", "plan", "planIsStored", "selection", "mission", "isAway"], (state) =>
    refill(byId("notices"), keyOfNotices(state), () => noticesOf(state, context)),
  );
  store.listen(["problem", "conflict"], (state) => {
    if (state.problem || state.conflict) byId("notices").parentElement?.scrollTo({ top: 0 }); // shown above a long list
  });
}

/** @param {MissionPageState} state @returns {MenuItem} */
const campaignItem = (state) => ({
  icon: "calendar-clock",
  label: t("Plan from launch sites …"),
  act: () => {
    const why = whyNoCampaign(state);
    if (why) toast(why);
    else void planFromLaunchSites(state);
  },
});

/**
 * @param {Mission | null} mission
 * @param {MissionActions} actions
 * @param {{ canPlan: boolean, canCopy: boolean }} rights
 * @returns {MenuItem[]}
 */
function itemsFor(mission, actions, { canPlan, canCopy }) {
  const allMissions = { icon: "clipboard-list", label: t("All missions"), act: () => location.assign("/") };
  if (!mission)
    return [
      ...(canPlan ? [{ icon: "trash-2", label: t("Clear everything"), act: actions.startEmpty }] : []),
      allMissions,
    ];
  return [
    ...(mission.campaign
      ? [
          {
            icon: "calendar-clock",
            label: t("Its campaign"),
            act: () => location.assign(`/campaigns/${mission.campaign}`),
          },
        ]
      : []),
    { icon: "link", label: t("Copy link"), act: () => void copyAddress(mission) },
    { icon: "history", label: t("History"), act: () => void showHistory(mission) },
    ...(canCopy
      ? [
          { icon: "bell", label: t("Alert thresholds"), act: () => void changeAlertLimits(mission) },
          { icon: "copy", label: t("Save a copy"), act: () => actions.save({ asCopy: true }) },
        ]
      : []),
    ...(canPlan ? [{ icon: "trash-2", label: t("Delete"), act: actions.deleteMission }] : []),
    allMissions,
  ];
}

/** Title, state and facts. @param {MissionPageState} state @param {boolean} canPlan */
function drawHead(state, canPlan) {
  const { mission } = state;
  const proposed = mission ? "" : proposedName(state.selection.targets);
  const shown = state.name || proposed || (canPlan ? t("New mission") : t("Map"));
  if (!mission) byId("mission-name", HTMLInputElement).placeholder = shown;
  byId("page-title").textContent = shown;
  byId("bar-title").textContent = shown;
  document.title = `${shown} · Spanwise`;
  const ownState = isPlanCurrent(state) ? "planned" : "draft";
  const name = mission && !["draft", "planned"].includes(mission.state) ? mission.state : ownState;
  const chip = byId("mission-state");
  const missed = name === "planned" && state.plan ? unassignedOf(state.plan).length : 0;
  const planned = plannedChip(state.selection.targets.length, missed);
  chip.className = name === "planned" ? planned.className : `chip ${name}`;
  chip.textContent = name === "planned" ? planned.words : MISSION_STATES[name];
  const flown = standingUavs(state).filter(({ sequence }) => sequence !== null);
  markSimulated(chip, flown.length > 0 && flown.every(({ is_simulated }) => is_simulated));
  drawRehearsalChip(state);
  chip.hidden = !canPlan && !mission; // only the map: there is no content for a draft
  byId("mission-facts").textContent = factsOf(state, canPlan).join(" · ");
}

/** Beside the state: the present plan failed its newest rehearsal. @param {MissionPageState} state */
function drawRehearsalChip(state) {
  const chip = byId("mission-rehearsal");
  const isOfPlan = state.planIsStored && isPlanCurrent(state);
  chip.hidden = !isOfPlan || rehearsalOfPlan(state.rehearsal.list ?? [])?.level !== "fail";
  chip.textContent = chip.hidden ? "" : REHEARSAL_FAILED;
}

/** @param {string} level @param {string} image @param {string} title @param {string} text @param {WayOut[]} [acts] */
function notice(level, image, title, text, acts = []) {
  return h(
    "div",
    { class: `notice ${level}`, role: level === "critical" ? "alert" : null },
    icon(image),
    h("p", {}, h("strong", {}, title), ` ${text} `, acts.map(wayOut)),
  );
}

/** An act, or an address evaluated when it is followed. @param {WayOut} way */
function wayOut({ label, act, href }) {
  if (act || !href) return h("button", { type: "button", class: "text-button", onclick: act }, label);
  const link = h("a", { class: "text-button", href: href() }, label);
  link.addEventListener("click", () => {
    link.href = href();
  });
  return link;
}

/** @param {MissionPageState} state @param {NoticeContext} context @returns {Child[]} */
function noticesOf(state, context) {
  const { actions, canPlan, showPlace } = context;
  const stale = staleOf(state);
  return [
    problemNotice(state, canPlan),
    state.conflict && isUnsaved(state) && conflictNotice(state.conflict, actions),
    uavNotice(state, actions, canPlan),
    stale && staleNotice(stale, actions, { canPlan, showPlace }),
    isPlanCurrent(state) && planNotices(state, context),
  ];
}

/** The mission, where the map data have changed since its plan was made. @param {MissionPageState} state */
const staleOf = (state) =>
  state.mission && groundCauses(state.mission).length > 0 && state.planIsStored && isPlanCurrent(state)
    ? state.mission
    : null;

/** Is equal as long as the notices are: each autosave makes another mission of the same content. @param {boolean} canPlan */
function createNoticesKey(canPlan) {
  /** @type {MissionPageState["problem"]} */
  let problem = null;
  let problems = 0;
  /** @param {MissionPageState} state */
  return (state) => {
    if (state.problem !== problem) problems += 1;
    problem = state.problem;
    const { conflict, isAway, mission, plan } = state;
    const changes = shownChanges(state);
    return JSON.stringify([
      [problems, isAway, canPlan],
      isUnsaved(state) && conflict,
      changes.length > 0 && [changes, mission?.state, isPlanCurrent(state)],
      staleOf(state) && [mission?.stale_reason, mission?.stale_causes],
      isPlanCurrent(state) && [plan?.result.warnings, causesOf(plan)],
    ]);
  };
}

/** The present problem, or that the server is unavailable. @param {MissionPageState} state @param {boolean} canPlan */
function problemNotice({ problem, isAway }, canPlan) {
  if (problem) {
    const image = problem.level === "warning" ? "triangle-alert" : isAway ? "cloud-off" : "circle-alert";
    return notice(problem.level, image, problem.title, problem.text, problem.actions);
  }
  if (!isAway) return null;
  const words = canPlan
    ? t("You can go on: what you change is kept in this browser and saved when the server is back.")
    : t("What you see may be out of date.");
  return notice("warning", "cloud-off", t("The server cannot be reached."), words);
}

/** @param {Conflict} conflict @param {MissionActions} actions */
const conflictNotice = ({ whose, at }, actions) =>
  notice(
    "warning",
    "triangle-alert",
    t("Your changes are from before {whose} save at {time}.", { whose, time: clockText(at) }),
    t("Both are kept."),
    [
      { label: t("See both"), act: actions.seeBoth },
      { label: t("Keep mine as a copy"), act: actions.keepMineAsCopy },
    ],
  );

/**
 * What the plan warns of, and which targets it does not reach.
 *
 * @param {MissionPageState} state
 * @param {NoticeContext} context
 */
function planNotices({ plan }, context) {
  return folded([
    ...(plan?.result.warnings ?? []).map(({ message }) => notice("warning", "triangle-alert", "", message)),
    ...unassignedCards(plan, context),
  ]);
}

let isUnfolded = false; // on a phone, where several warnings are collapsed to one line until they are opened

/** @param {(HTMLElement | false)[]} notices @returns {Child[]} */
function folded(notices) {
  const shown = notices.filter((entry) => entry !== false);
  if (!phone.matches || shown.length < 2) return shown;
  return [
    h(
      "details",
      {
        class: "notice-fold",
        open: isUnfolded,
        /** @param {ToggleEvent} event */
        ontoggle: (event) => {
          isUnfolded = /** @type {HTMLDetailsElement} */ (event.currentTarget).open;
        },
      },
      h(
        "summary",
        { class: "notice warning" },
        icon("triangle-alert"),
        h("p", {}, tn(shown.length, "{count} warning", "{count} warnings")),
        icon("chevron-down", "small"),
      ),
      shown,
    ),
  ];
}

/**
 * The notice on changes of the map data since the plan was made, their effect on the mission, and the way to resolve them. UAVs have a
 * notice of their own.
 *
 * @param {Mission} mission
 * @param {MissionActions} actions
 * @param {{ canPlan: boolean, showPlace: ShowPlace }} how
 */
function staleNotice(mission, actions, { canPlan, showPlace }) {
  const causes = groundCauses(mission);
  const isOfGround = causes[0] === mission.stale_causes[0];
  const headline = isOfGround
    ? mission.stale_reason.split(/(?<=\.) /)[0]
    : t("The ground has changed since this was planned.");
  const lines = causes.slice(0, MAX_CAUSES).map(({ message, from, to, position }) => {
    const times = from && to && t("There from {start} to {end}.", { start: departureText(from), end: clockText(to) });
    return h(
      "li",
      {},
      message,
      " ",
      times && `${times} `,
      position && wayOut({ label: t("See the place"), act: () => showPlace(position) }),
    );
  });
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
      canPlan && h("p", {}, wayOut({ label: t("Plan again"), act: actions.plan })),
    ),
  );
}
