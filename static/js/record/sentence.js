/** What came of a mission, in a sentence and some figures. Values in, values out. */

import { t, tn } from "../text.js";
import { clockText, durationText, energyText, exactHeightText, lengthText, percentText } from "../units.js";

/** @import { MissionRecord, MissionState, Totals } from "../api_types.d.ts" */

/** @typedef {{ mission: { state: MissionState } }} InState */

const UNDER_WAY = ["dispatched", "active"];
const ENOUGH_TO_SHARE = 20; // estimates beside a measurement: of fewer a share says nothing
const HURRIED = 0.75; // of the planned time: only who flies faster than real time is back so early
const NOT_BEGUN = ["draft", "planned", "approved", "dispatched"];

/** @param {InState} record */
export const isUnderWay = ({ mission }) => UNDER_WAY.includes(mission.state);
/** @param {InState} record */
export const isOver = ({ mission }) => !isUnderWay({ mission }) && !NOT_BEGUN.includes(mission.state);
/** @param {{ routes: readonly { flown: { reports: number } }[] }} record */
export const wasFlown = ({ routes }) => routes.some(({ flown }) => flown.reports > 0);

/** "11 of 12 targets complete", "Not flown yet." @param {MissionRecord} record */
export function sentenceOf(record) {
  const { targets } = record.summary;
  if (!wasFlown(record) && NOT_BEGUN.includes(record.mission.state)) return t("Not flown yet.");
  if (isUnderWay(record))
    return t("{done} of {all} targets complete so far", { done: targets.complete, all: targets.all });
  return t("{done} of {all} targets complete", { done: targets.complete, all: targets.all });
}

/** What else has to be known at once. @param {MissionRecord} record */
export function factsOf(record) {
  const { alerts, lowest_battery_percent: lowest } = record.summary;
  const all = alerts.critical + alerts.warning + alerts.advisory;
  const facts = [];
  const simulated = record.routes.filter(({ is_simulated }) => is_simulated);
  if (simulated.length)
    facts.push(
      simulated.length === record.routes.length
        ? t("Flown in simulation, by no real aircraft.")
        : t("Simulated, no real aircraft: {names}.", { names: simulated.map(({ name }) => name).join(", ") }),
    );
  if (
    simulated.length &&
    wasFlown(record) &&
    (record.summary.flown.duration_s ?? 0) < HURRIED * (record.summary.planned.duration_s ?? 0)
  )
    facts.push(t("Times are of the clock on the wall: it was flown faster than real time."));
  if (isUnderWay(record) && record.mission.started_at)
    facts.push(t("Under way since {time}.", { time: clockText(record.mission.started_at) }));
  if (!wasFlown(record))
    facts.push(
      isOver(record)
        ? t("Nothing that its UAVs reported is in the log.")
        : t("Its record is written while it is flown."),
    );
  else if (lowest !== null)
    facts.push(t("No battery was below {percent}.", { percent: percentText(Math.floor(lowest)) }));
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
  const { planned, flown, across_rms_m, height_rms_m, estimates } = record.summary;
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
  /** @param {number | null} value */
  const metres = (value) => (value === null ? "—" : exactHeightText(value));
  return [
    compared(t("Distance"), "length_m", lengthText, flown.unreported_m),
    compared(t("Until the last landing"), "duration_s", durationText),
    ...(planned.energy_wh === null && flown.energy_wh === null ? [] : [compared(t("Energy"), "energy_wh", energyText)]),
    ...(flown.unreported_s > 0
      ? [
          {
            words: t("Without reports, not in these figures"),
            planned: "",
            flown: `${durationText(flown.unreported_s)}, ${lengthText(flown.unreported_m)}`,
            more: "",
          },
        ]
      : []),
    { words: t("Off route, RMS"), planned: "", flown: metres(across_rms_m), more: "" },
    { words: t("Height error, RMS"), planned: "", flown: metres(height_rms_m), more: "" },
    ...(estimates.compared >= ENOUGH_TO_SHARE
      ? [
          {
            words: t("Estimates inside bound"),
            planned: percentText(95),
            flown: percentText((estimates.share_inside ?? 0) * 100),
            more: "",
          },
          { words: t("Estimates off, RMS"), planned: "", flown: metres(estimates.rms_m), more: "" },
        ]
      : []),
  ];
}
