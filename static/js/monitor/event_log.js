/** What has happened: commands, alerts and states of targets and missions, the newest first. Values in, values out. */

import { KINDS } from "../domain/flying.js";
import { t } from "../text.js";
import { reasonWords, STATES } from "./board.js";

/** @import { Alert, AlertLevel, Command, LiveMission } from "../api_types.d.ts" */

/**
 * A line of the log.
 *
 * @typedef {object} LoggedEvent
 * @property {string} key
 * @property {string} at
 * @property {string} image name of an icon
 * @property {AlertLevel} [level]
 * @property {boolean} [isSimulated]
 * @property {string} words
 */

/** @type {["created_at" | "sent_at" | "acknowledged_at", () => string, string][]} */
const STEPS = [
  ["created_at", () => t("given"), "send"],
  ["sent_at", () => t("sent"), "send"],
  ["acknowledged_at", () => t("acknowledged"), "check"],
];
/** @type {Partial<Record<Command["state"], string>>} */
const ENDS = { applied: t("done"), failed: t("failed"), expired: t("expired") };

/** @type {Record<AlertLevel, string>} */
const IMAGES = { critical: "octagon-alert", warning: "triangle-alert", advisory: "info" };

/** @param {Command} command @returns {LoggedEvent[]} */
function ofCommand({ id, uav, kind, created_by, state, outcome, finished_at, ...times }) {
  /** @param {string} at @param {string} words @param {string} image @returns {LoggedEvent} */
  const said = (at, words, image) => ({
    key: `command ${id} ${words}`,
    at,
    image,
    isSimulated: uav.is_simulated,
    words: t("{name}: {act}, {state}", { name: uav.name, act: KINDS[kind], state: words }),
  });
  const steps = STEPS.flatMap(([name, words, image]) => {
    const at = times[name];
    return at ? [said(at, words(), image)] : [];
  });
  if (steps[0] && created_by)
    steps[0].words = t("{name}: {act}, given by {who}", { name: uav.name, act: KINDS[kind], who: created_by });
  const end = ENDS[state];
  if (finished_at && end) {
    const isDone = state === "applied";
    steps.push(
      said(finished_at, outcome && !isDone ? `${end} – ${outcome}` : end, isDone ? "circle-check" : "circle-x"),
    );
  }
  return steps;
}

/** @param {Alert} alert @returns {LoggedEvent[]} */
function ofAlert({ id, level, message, is_simulated, opened_at, closed_at, acknowledged_at, acknowledged_by }) {
  /** @type {LoggedEvent[]} */
  const rows = [{ key: `alert ${id} opened`, at: opened_at, image: IMAGES[level], level, words: message }];
  if (acknowledged_at)
    rows.push({
      key: `alert ${id} known`,
      at: acknowledged_at,
      image: "check",
      words: t("Acknowledged by {who}: {message}", { who: acknowledged_by ?? t("somebody who has left"), message }),
    });
  if (closed_at)
    rows.push({
      key: `alert ${id} closed`,
      at: closed_at,
      image: "circle-check",
      words: t("Resolved: {message}", { message }),
    });
  return rows.map((row) => ({ ...row, isSimulated: is_simulated }));
}

/** @param {LiveMission} mission @returns {LoggedEvent[]} */
function ofMission({ id, name, started_at, ended_at, targets }) {
  const rows = targets
    .filter(({ state, state_at }) => state_at && state !== "pending")
    .map(({ place, label, state, state_at, state_reason }) => ({
      key: `target ${id} ${place} ${state}`,
      at: state_at ?? "",
      image: STATES[state].image,
      words: `${label}: ${STATES[state].words}${state_reason ? `, ${reasonWords(state_reason)}` : ""}`,
    }));
  if (started_at)
    rows.push({
      key: `mission ${id} started`,
      at: started_at,
      image: "plane-takeoff",
      words: t("“{name}” has begun", { name }),
    });
  if (ended_at)
    rows.push({
      key: `mission ${id} ended`,
      at: ended_at,
      image: "plane-landing",
      words: t("“{name}” has ended", { name }),
    });
  return rows;
}

/**
 * [{ key, at, image, level?, isSimulated?, words }]
 *
 * @param {{ commands: Command[], alerts: Alert[], missions: LiveMission[] }} shown
 * @returns {LoggedEvent[]}
 */
export function eventsOf({ commands, alerts, missions }) {
  const events = [...commands.flatMap(ofCommand), ...alerts.flatMap(ofAlert), ...missions.flatMap(ofMission)];
  return events.sort((a, b) => Date.parse(b.at) - Date.parse(a.at));
}
