/** The result of a mission in a sentence and some figures. Values in, values out. */

import { t, tn } from "../text.js";
import { clockText, durationText, energyText, exactHeightText, lengthText, numberText, percentText } from "../units.js";

/** @import { Incident, MissionRecord, MissionState, RecordTarget, Totals } from "../api_types.d.ts" */

/** @typedef {{ mission: { state: MissionState } }} InState */

const UNDER_WAY = ["dispatched", "active"];
const ENOUGH_TO_SHARE = 20; // estimates beside a measurement: with fewer no share is shown
const OTHER_CLOCK = 0.05; // deviation of a rate from 1, from which on a simulation's clock is distinguished from real time
/** Incidents that are shown even where they are no target's reason. @type {readonly Incident["kind"][]} */
const TOLD = ["crashed", "down", "failsafe-return", "failsafe-land", "aborted", "battery"];
const NOT_BEGUN = ["draft", "planned", "approved", "dispatched"];

/** @param {InState} record */
export const isUnderWay = ({ mission }) => UNDER_WAY.includes(mission.state);
/** @param {InState} record */
export const isOver = ({ mission }) => !isUnderWay({ mission }) && !NOT_BEGUN.includes(mission.state);
/** @param {{ routes: readonly { flown: { reports: number } }[] }} record */
export const wasFlown = ({ routes }) => routes.some(({ flown }) => flown.reports > 0);

/** Whether its UAVs flew faster or slower than real time. @param {{ summary: { clock_rate: number } }} record */
export const hasOwnClock = ({ summary }) => Math.abs(summary.clock_rate - 1) > OTHER_CLOCK;

/** "11 of 12 targets inspected", "Not flown yet." @param {Pick<MissionRecord, "mission" | "summary" | "routes">} record */
export function sentenceOf(record) {
  const { results } = record.summary;
  const unsure = results["not-confirmed"];
  const counts = { done: results.inspected, all: results.all, unsure };
  if (!wasFlown(record) && NOT_BEGUN.includes(record.mission.state)) return t("Not flown yet.");
  if (isUnderWay(record)) return t("{done} of {all} targets inspected so far", counts);
  return unsure
    ? t("{done} of {all} targets inspected, {unsure} not confirmed", counts)
    : t("{done} of {all} targets inspected", counts);
}

/**
 * Why the others were not inspected, those with one reason together, and what else happened to UAVs:
 * [{ targets, words }], words with "{targets}" where there are any.
 *
 * @param {Pick<MissionRecord, "targets" | "incidents">} record
 */
export function reasonsOf({ targets, incidents }) {
  /** @type {Map<string, { targets: RecordTarget[], result: RecordTarget["result"], words: string }>} */
  const groups = new Map();
  for (const target of [...targets].sort((a, b) => a.flown_place - b.flown_place)) {
    const { result, reason } = target;
    if (result === "inspected" || result === "open" || !reason) continue;
    const words = withTime(reason.message, reason.at);
    const group = groups.get(`${result} ${words}`);
    if (group) group.targets.push(target);
    else groups.set(`${result} ${words}`, { targets: [target], result, words });
  }
  const sentences = new Set([...groups.values()].map(({ words }) => words));
  const others = incidents
    .filter(({ kind }) => TOLD.includes(kind))
    .map(({ message, at }) => withTime(message, at))
    .filter((words) => !sentences.has(words));
  return [
    ...[...groups.values()].map(({ targets: of, result, words }) => ({
      targets: of,
      words:
        result === "not-confirmed"
          ? t("{targets} not confirmed: {reason}.", { targets: "{targets}", reason: words })
          : t("{targets} not inspected: {reason}.", { targets: "{targets}", reason: words }),
    })),
    ...others.map((words) => ({ targets: [], words: `${capital(words)}.` })),
  ];
}

/** As a sentence begins. @param {string} words */
export const capital = (words) => words.charAt(0).toLocaleUpperCase() + words.slice(1);

/** @param {string} words @param {string | null} at */
const withTime = (words, at) => (at ? t("{what} ({time})", { what: words, time: clockText(at) }) : words);

/** What else has to be known at once. @param {MissionRecord} record */
export function factsOf(record) {
  const { alerts, lowest_battery_percent: lowest } = record.summary;
  const all = alerts.critical + alerts.warning + alerts.advisory;
  const facts = [];
  const simulated = record.routes.filter(({ is_simulated }) => is_simulated);
  if (simulated.length)
    facts.push(
      simulated.length === record.routes.length
        ? t("Simulated flight.")
        : t("Simulated, no real aircraft: {names}.", { names: simulated.map(({ name }) => name).join(", ") }),
    );
  if (wasFlown(record) && hasOwnClock(record))
    facts.push(
      t("Simulation at {rate}×; durations are simulated time.", { rate: numberText(record.summary.clock_rate, 1) }),
    );
  if (isUnderWay(record) && record.mission.started_at)
    facts.push(t("Under way since {time}.", { time: clockText(record.mission.started_at) }));
  if (!wasFlown(record))
    facts.push(
      isOver(record)
        ? t("Nothing that its UAVs reported is in the log.")
        : t("Its record is written while it is flown."),
    );
  else if (lowest !== null)
    facts.push(t("Lowest battery in flight {percent}.", { percent: percentText(Math.floor(lowest)) }));
  if (all)
    facts.push(
      alerts.critical
        ? tn(all, "{count} alert, {critical} critical.", "{count} alerts, {critical} critical.", {
            critical: alerts.critical,
          })
        : tn(all, "{count} alert, none critical.", "{count} alerts, none critical."),
    );
  else if (wasFlown(record)) facts.push(t("No alerts."));
  return facts.join(" ");
}

/** @param {number} value @param {(value: number) => string} text */
const signed = (value, text) => `${value < 0 ? "−" : "+"}${text(Math.abs(value))}`;

/**
 * Rows of the table; a figure that is not known is "—", one that has no meaning is empty.
 *
 * @param {Pick<MissionRecord, "mission" | "summary" | "routes">} record
 */
export function figuresOf(record) {
  const { planned, flown } = record.summary;
  const hasFlown = wasFlown(record);
  /** @param {string} words @param {keyof Totals} name @param {(value: number | null) => string} text @param {number} [unreported] */
  const compared = (words, name, text, unreported = 0) => {
    const [plan, flight] = [planned[name], flown[name]];
    return {
      words,
      planned: text(plan),
      flown: hasFlown ? text(flight) : "—",
      more:
        hasFlown && !isUnderWay(record) && plan !== null && flight !== null
          ? signed(flight + unreported - plan, text)
          : "",
    };
  };
  return [
    compared(t("Distance"), "length_m", lengthText, flown.unreported_m),
    compared(t("Total duration"), "duration_s", durationText),
    ...(planned.energy_wh === null && flown.energy_wh === null ? [] : [compared(t("Energy"), "energy_wh", energyText)]),
    ...(flown.unreported_s > 0
      ? [
          {
            words: t("Without telemetry, not in these figures"),
            planned: "",
            flown: `${durationText(flown.unreported_s)}, ${lengthText(flown.unreported_m)}`,
            more: "",
          },
        ]
      : []),
  ];
}

/** @param {number | null} value */
const metres = (value) => (value === null ? "—" : exactHeightText(value));

/**
 * Rows of "Quality of data": deviations of tracks from their routes, and of estimates from measurements.
 *
 * @param {Pick<MissionRecord, "summary">} record
 */
export function qualityOf({ summary: { across_rms_m, height_rms_m, estimates } }) {
  return [
    { words: t("Track error (RMS)"), planned: "", flown: metres(across_rms_m), more: "" },
    { words: t("Height error (RMS)"), planned: "", flown: metres(height_rms_m), more: "" },
    ...(estimates.compared >= ENOUGH_TO_SHARE
      ? [
          {
            words: t("Position estimates within 95 % bound"),
            planned: percentText(95),
            flown: percentText((estimates.share_inside ?? 0) * 100),
            more: "",
          },
          { words: t("Estimate error (RMS)"), planned: "", flown: metres(estimates.rms_m), more: "" },
        ]
      : []),
  ];
}
