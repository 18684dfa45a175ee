/** The act that comes next for a mission, from plan to start, and why it would be refused. Values in, values out. */

import { nextStep } from "../../domain/preflight_step.js";
import { t } from "../../text.js";
import { isPlanCurrent, isUnsaved, routesOf } from "../plan/plan_view.js";
import { rehearsalOfPlan } from "./briefing.js";

/** @import { Mission, Preflight } from "../../api_types.d.ts" */
/** @import { NextStep } from "../../domain/preflight_step.js" */
/** @import { MissionPageState, MissionSelection } from "../types.d.ts" */

/** @typedef {"plan" | "rehearse" | "approve"} NextAct */

/**
 * Plan until there is a plan of what is picked, rehearse until a rehearsal of it has not failed, then approve.
 *
 * @param {Pick<MissionPageState, "plan" | "selection" | "planning" | "rehearsal">} state
 * @returns {NextAct}
 */
export function nextAct(state) {
  const isPlanned = state.plan !== null && state.planning === null && isPlanCurrent(state);
  if (!isPlanned || !fliesAny(state)) return "plan";
  const level = rehearsalOfPlan(state.rehearsal.list ?? [])?.level;
  return level === "pass" || level === "warnings" ? "approve" : "rehearse";
}

/** @param {Pick<MissionPageState, "plan">} state */
const fliesAny = ({ plan }) => routesOf(plan).some(({ geometry }) => geometry);

/**
 * What a plan still needs, and what helps; null where it needs nothing.
 *
 * @param {Pick<MissionSelection, "targets" | "uavs">} selection
 * @returns {[string, string] | null}
 */
export function lackingOf({ targets, uavs }) {
  if (!targets.length) return [t("Nothing picked yet."), t("Click a tower, bridge or track on the map, then plan.")];
  if (!uavs.length) return [t("No UAV is chosen."), t("Tick one in the list, or add the first one.")];
  return null;
}

/** Why the plan on the page cannot be approved; empty where it can. @param {MissionPageState} state */
export function whyNotApproved(state) {
  if (!isPlanCurrent(state)) return t("It has changed since it was planned. Plan again first.");
  if (!fliesAny(state)) return t("The plan reaches no target: there is nothing to approve.");
  if (!state.mission || isUnsaved(state) || !state.planIsStored || state.saving) return t("It is not saved yet.");
  return "";
}

/** Why the plan on the page cannot be rehearsed; empty where it can. @param {MissionPageState} state */
export function whyNotRehearsed(state) {
  if (!state.mission) return t("Save the mission first: what is stored is rehearsed.");
  if (!state.plan) return t("Plan the mission first.");
  if (!state.mission.plan || !isPlanCurrent(state)) return t("It has changed since it was planned. Plan again first.");
  if (isUnsaved(state) || !state.planIsStored || state.saving) return t("It is not saved yet.");
  return "";
}

/** Whether a new mission is stored only on request: a stored one saves itself, a new one with its first plan. @param {MissionPageState} state */
export const isSavedOnRequest = (state) => !state.mission && isUnsaved(state) && (!state.plan || !isPlanCurrent(state));

/**
 * What comes after the approval; null where nothing is left, or before the checks are read.
 *
 * @param {Pick<Mission, "uavs">} mission
 * @param {Preflight | null} preflight
 */
export const approvedStep = ({ uavs }, preflight) =>
  preflight && nextStep(preflight, true, uavs.every(({ is_simulated }) => is_simulated) ? "off" : null);

/** Upload and start are done on the mission's page; to connect and to simulate are of the page Fly. @param {NextStep | null} step */
export const isDoneHere = (step) => ["upload", "wait", "start"].includes(step?.act ?? "");

/** The link to the page Fly. @param {NextStep | null} step */
export function flyWords(step) {
  if (step?.act === "simulate") return step.words;
  return step ? t("Fly: {act}", { act: step.words }) : t("Fly");
}
