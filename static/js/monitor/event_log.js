/** What has happened: commands, alerts and states of targets and missions, the newest first. Values in, values out. */

import { KINDS } from "../domain/flying.js";
import { t } from "../text.js";
import { reasonWords, STATES } from "./board.js";

const STEPS = [
  ["created_at", () => t("given"), "send"],
  ["sent_at", () => t("sent"), "send"],
  ["acknowledged_at", () => t("acknowledged"), "check"],
];
const ENDS = { applied: t("done"), failed: t("failed"), expired: t("expired") };

function ofCommand({ id, uav, kind, created_by, state, outcome, finished_at, ...times }) {
  const said = (at, words, image) => ({
    key: `command ${id} ${words}`,
    at,
    image,
    isSimulated: uav.is_simulated,
    words: t("{name}: {act}, {state}", { name: uav.name, act: KINDS[kind], state: words }),
  });
  const steps = STEPS.filter(([name]) => times[name]).map(([name, words, image]) => said(times[name], words(), image));
  if (steps[0] && created_by)
    steps[0].words = t("{name}: {act}, given by {who}", { name: uav.name, act: KINDS[kind], who: created_by });
  if (finished_at && ENDS[state])
    steps.push({
      ...said(
        finished_at,
        outcome && state !== "applied" ? `${ENDS[state]} – ${outcome}` : ENDS[state],
        state === "applied" ? "circle-check" : "circle-x",
      ),
    });
  return steps;
}

function ofAlert({ id, level, message, is_simulated, opened_at, closed_at, acknowledged_at, acknowledged_by }) {
  const image = { critical: "octagon-alert", warning: "triangle-alert", advisory: "info" }[level];
  const rows = [{ key: `alert ${id} opened`, at: opened_at, image, level, words: message }];
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
      words: t("Over: {message}", { message }),
    });
  return rows.map((row) => ({ ...row, isSimulated: is_simulated }));
}

function ofMission({ id, name, started_at, ended_at, targets }) {
  const rows = targets
    .filter(({ state, state_at }) => state_at && state !== "pending")
    .map(({ place, label, state, state_at, state_reason }) => ({
      key: `target ${id} ${place} ${state}`,
      at: state_at,
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

/** [{ key, at, image, level?, isSimulated?, words }] */
export function eventsOf({ commands, alerts, missions }) {
  const events = [...commands.flatMap(ofCommand), ...alerts.flatMap(ofAlert), ...missions.flatMap(ofMission)];
  return events.sort((a, b) => Date.parse(b.at) - Date.parse(a.at));
}
