/** What a rehearsal found: conditions by UAVs, and what failed first, each with one fix. Values in, values out. */

import { routeLetter } from "../../domain/palette.js";
import { t } from "../../text.js";
import { percentText, speedText } from "../../units.js";

/** @import { AssessmentLevel, Finding, RehearsalConditions, RehearsalDetail, RehearsalRunWithAssessment } from "../../api_types.d.ts" */
/** @import { Conditions } from "../types.d.ts" */

/** @typedef {{ level: AssessmentLevel | "", passed: number, all: number }} ConditionCell of one UAV in one of the conditions */
/**
 * @typedef {object} ConditionRow
 * @property {number} sequence of the run
 * @property {string} words
 * @property {string} air
 * @property {AssessmentLevel | ""} level
 * @property {(ConditionCell | null)[]} cells in the order of the UAVs; null: not flown
 * @property {number | null} lowest_percent of the battery at a landing
 */
/**
 * What is planned again, and how.
 *
 * @typedef {{ code: "reserve", uav: number, percent: number, words: string }
 *   | { code: "conditions", conditions: Pick<Conditions, "wind" | "temperature_c">, words: string }
 *   | { code: "by_hand", uav: number, words: string }} Fix
 */

const MAX_RESERVE_PERCENT = 90;
const BY_HAND = ["zone-entered", "zone-near", "low", "obstacle", "across", "height", "missed", "passed-wide"];
const BY_WIND = [...BY_HAND, "wind", "unfinished", "crashed", "not-flown-to", "not-held", "late", "apart"];
const SEVERITY = ["fail", "warnings", "pass"];

/** @param {Pick<RehearsalConditions, "wind">} conditions */
const strongest_mps = ({ wind }) => Math.max(0, ...wind.map(({ speed_mps }) => speed_mps));

/** "12 m/s, gusts 2 m/s", "80 % capacity". @param {RehearsalConditions} conditions */
export function airText(conditions) {
  const { gusts_mps, battery_percent } = conditions;
  const parts = [speedText(strongest_mps(conditions))];
  if (gusts_mps > 0) parts.push(t("gusts {speed}", { speed: speedText(gusts_mps) }));
  if (battery_percent < 100) parts.push(t("{percent} capacity", { percent: percentText(battery_percent) }));
  return parts.join(", ");
}

/** @param {Pick<RehearsalDetail, "runs" | "uavs">} detail */
export function conditionsByUav({ runs, uavs }) {
  const columns = uavs.map(({ uav, name }) => ({ uav, name, letter: routeLetter(uav) }));
  /** @type {ConditionRow[]} */
  const rows = runs.map(({ sequence, words, conditions, level, assessment }) => {
    const routes = assessment?.routes ?? [];
    const left = routes.flatMap(({ energy }) => energy.map(({ left_percent }) => left_percent));
    return {
      sequence,
      words,
      air: airText(conditions),
      level,
      cells: columns.map(({ uav }) => {
        const route = routes.find((one) => one.uav === uav);
        if (!route) return null;
        const passed = route.targets.filter((target) => target.level !== "fail").length;
        return { level: route.level, passed, all: route.targets.length };
      }),
      lowest_percent: left.length ? Math.min(...left) : null,
    };
  });
  return { columns, rows };
}

/**
 * The findings of a run, those that fail first; targets that were not flown to after what is the cause of it.
 *
 * @param {Pick<RehearsalRunWithAssessment, "assessment">} run
 */
export function failuresFirst({ assessment }) {
  /** @param {Finding} finding */
  const rank = ({ level, code }) => 2 * SEVERITY.indexOf(level) + Number(code === "not-flown-to");
  return [...(assessment?.findings ?? [])].sort((a, b) => rank(a) - rank(b));
}

/**
 * The one change with which planning again resolves a finding; null where there is none.
 *
 * @param {Finding} finding
 * @param {Pick<RehearsalRunWithAssessment, "conditions" | "assessment">} run
 * @param {Pick<Conditions, "wind" | "temperature_c"> | null} planned the mission's own conditions
 * @returns {Fix | null}
 */
export function fixOf({ code, uav, short_percent }, { conditions, assessment }, planned) {
  if (code === "reserve" && short_percent !== null) {
    const route = assessment?.routes.find((one) => one.uav === uav);
    const percent = Math.ceil((route?.reserve_percent ?? 0) + short_percent);
    if (!route || route.planned_wh === null || percent > MAX_RESERVE_PERCENT) return null; // without a capacity no plan counts energy
    return { code: "reserve", uav, percent, words: t("Keep {percent} in reserve", { percent: percentText(percent) }) };
  }
  const mps = strongest_mps(conditions);
  if (BY_WIND.includes(code) && mps > strongest_mps({ wind: planned?.wind ?? [] })) {
    const { wind, temperature_c } = conditions;
    const words = t("Plan again for {speed}", { speed: speedText(mps) });
    return { code: "conditions", conditions: { wind, temperature_c }, words };
  }
  if (!BY_HAND.includes(code)) return null;
  return { code: "by_hand", uav, words: t("Change the route by hand") };
}
