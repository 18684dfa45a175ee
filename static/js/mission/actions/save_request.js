/** What a save sends: a whole new mission, or the parts of a stored one that differ. Values in, values out. */

import { freshKey } from "../../api.js";
import { t } from "../../text.js";
import { clockText, dayText } from "../../units.js";
import { UNSAID } from "../options/flight_options.js";
import { basisOf, requestOf } from "../selection.js";
import { proposedName } from "../targets/proposed_name.js";

/** @import { MissionInputRequest, PlanInputRequest } from "../../api_types.d.ts" */
/** @import { MissionPageState, MissionSelection, Version } from "../types.d.ts" */

/**
 * @typedef {object} Attempt to save
 * @property {Version} asked the version on the page
 * @property {Partial<MissionInputRequest>} body
 * @property {string} key idempotency key of the attempt
 * @property {boolean} isNew
 * @property {boolean} asCopy
 */

const UNASKED = { locks: [], ...UNSAID };
const PARTS = /** @type {(keyof PlanInputRequest)[]} */ ([
  "uavs",
  "targets",
  "objective",
  "return_to_start",
  ...Object.keys(UNASKED),
]);

/**
 * The parts of a selection that differ from the stored one, in the form of the API.
 *
 * @param {MissionSelection} selection
 * @param {MissionSelection | null | undefined} stored
 * @returns {Partial<PlanInputRequest>}
 */
export function changedParts(selection, stored) {
  /** @type {Partial<PlanInputRequest>[]} */
  const [now, before] = [requestOf(selection), stored ? requestOf(stored) : {}].map((body) => ({
    ...UNASKED,
    ...body,
  }));
  const changed = PARTS.filter((part) => JSON.stringify(now[part]) !== JSON.stringify(before[part]));
  const movesPlaces = changed.includes("targets") || changed.includes("uavs"); // locks name UAVs and places in the list of targets
  if (movesPlaces && now.locks?.length && !changed.includes("locks")) changed.push("locks");
  return Object.fromEntries(changed.map((part) => [part, now[part]]));
}

/** @param {Pick<MissionPageState, "name" | "mission" | "selection">} state */
const nameOf = ({ name, mission, selection }) =>
  name.trim() ||
  mission?.name ||
  proposedName(selection.targets) ||
  t("Mission of {day}, {time}", { day: dayText(new Date().toISOString()), time: clockText(Date.now()) });

/**
 * @param {Pick<MissionPageState, "mission" | "plan" | "planIsStored" | "stored" | "selection" | "name">} state
 * @param {boolean} asCopy
 * @returns {Attempt}
 */
export function attemptOf({ mission, plan, planIsStored, stored, selection, name: typed }, asCopy) {
  const isNew = !mission || asCopy;
  const basis = basisOf(selection);
  /** @type {Attempt["body"]} */
  const body = isNew ? requestOf(selection) : changedParts(selection, stored?.selection);
  const name = nameOf({ name: typed, mission, selection });
  if (asCopy) body.name = t("{name} (copy)", { name });
  else if (name !== mission?.name) body.name = name;
  const isPlanNew = isNew || !planIsStored || !stored || basis !== basisOf(stored.selection);
  if (plan?.basis === basis && isPlanNew) {
    body.plan = true;
    if (plan.result.job) body.plan_of = plan.result.job;
  }
  return { asked: { selection, name: typed }, body, key: freshKey(), isNew, asCopy };
}
