/** What has happened, the newest first: commands, alerts, targets, states of missions. */

import { h } from "../dom.js";
import { commandWords } from "../mission/flying.js";
import { t } from "../text.js";
import { MISSION_STATES, TARGET_STATES } from "./words.js";

const MOST = 120;

/** → [{ key, at, words }] of what the feed shows. */
export function eventsOf({ alerts, commands, missions, names }) {
  const events = [];
  for (const alert of alerts) {
    events.push({ key: `alert ${alert.id}`, at: alert.opened_at, words: t("{name}: {message}", { name: names(alert), message: alert.message }) });
    if (alert.acknowledged_at) events.push({ key: `acknowledged ${alert.id}`, at: alert.acknowledged_at, words: t("{person} acknowledged: {message}", { person: alert.acknowledged_by ?? t("Somebody"), message: alert.message }) });
    if (alert.closed_at) events.push({ key: `over ${alert.id}`, at: alert.closed_at, words: t("Over: {message}", { message: alert.message }) });
  }
  for (const command of commands) {
    const by = command.created_by ?? t("the program");
    events.push({ key: `command ${command.id} ${command.state}`, at: command.finished_at ?? command.acknowledged_at ?? command.sent_at ?? command.created_at, words: `${command.uav.name}: ${commandWords(command).words} (${by})` });
  }
  for (const mission of missions) {
    if (mission.started_at) events.push({ key: `started ${mission.id}`, at: mission.started_at, words: t("{name} has begun", { name: mission.name }) });
    if (mission.ended_at) events.push({ key: `ended ${mission.id}`, at: mission.ended_at, words: t("{name}: {state}", { name: mission.name, state: MISSION_STATES[mission.state] }) });
    for (const target of mission.targets) if (target.state_at) events.push({ key: `target ${mission.id} ${target.place} ${target.state}`, at: target.state_at, words: t("{name}: {state}", { name: target.label, state: TARGET_STATES[target.state].words }) });
  }
  return events.sort((a, b) => Date.parse(b.at) - Date.parse(a.at)).slice(0, MOST);
}

export function mountEventLog(list, timeText) {
  let shown = "";
  return (events) => {
    const key = events.map((event) => event.key).join();
    if (key === shown) return;
    shown = key;
    list.replaceChildren(...events.map(({ at, words }) => h("li", {}, h("time", { datetime: at }, timeText(at)), h("span", {}, words))));
  };
}
