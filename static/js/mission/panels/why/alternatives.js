/** The four objectives side by side: figures of each, the present one marked, one click chooses one. */

import { h, icon } from "../../../dom.js";
import { t } from "../../../text.js";
import { durationText, energyText, lengthText, numberText } from "../../../units.js";
import { isWithoutCapacity, longestDuration_s, OBJECTIVES } from "../../plan/plan_view.js";
import { standing_s } from "../../plan/route_times.js";
import { basisOf } from "../../selection.js";
import { openChanges } from "../../uavs/uav_changes.js";

/** @import { Child } from "../../../dom.js" */
/** @import { MissionActions, MissionPageState, PlanResult } from "../../types.d.ts" */

/** @typedef {ReturnType<typeof waysOf>[number]} Way of planning */
/**
 * @typedef {object} Column
 * @property {string} words
 * @property {(result: PlanResult) => number | null} figureOf
 * @property {(value: number) => string} textOf
 * @property {number} least a smaller difference does not count
 */

/** @param {PlanResult} result */
function missed({ unassigned }) {
  return unassigned.length;
}

/** @type {Column[]} */
const COLUMNS = [
  { words: t("Distance"), figureOf: ({ total_length_m }) => total_length_m, textOf: lengthText, least: 50 },
  { words: t("Done in"), figureOf: longestDuration_s, textOf: durationText, least: 30 },
  { words: t("In the air"), figureOf: flying_s, textOf: durationText, least: 30 },
  { words: t("Energy"), figureOf: ({ total_energy_wh }) => total_energy_wh ?? null, textOf: energyText, least: 1 },
  { words: t("Not reached"), figureOf: missed, textOf: (count) => numberText(count), least: 0.5 },
];

/**
 * Flying time of all UAVs together [s], without stops at a base between two flights or on a tower to charge.
 *
 * @param {PlanResult} result
 */
export function flying_s({ routes }) {
  const used = routes.filter(({ waypoints }) => waypoints?.length);
  return used.reduce((sum, route) => sum + route.duration_s - standing_s(route), 0);
}

/**
 * The ways to plan in the order in which they are offered; `result` is null where one is not planned.
 *
 * @param {Pick<MissionPageState, "selection" | "figures" | "planningBeside" | "refusedBeside" | "plan">} state
 */
export function waysOf({ selection, figures, planningBeside, refusedBeside, plan }) {
  return OBJECTIVES.map(({ value, words, meaning }) => {
    const basis = basisOf({ ...selection, objective: value });
    const result = figures[basis] ?? null;
    const fault =
      refusedBeside[basis] ??
      (value === "energy" && isWithoutCapacity(plan)
        ? t("No UAV states its battery’s capacity: energy is not calculated.")
        : "");
    return {
      objective: value,
      words,
      meaning,
      result,
      fault,
      isPresent: plan?.basis === basis,
      isBeingMade: planningBeside === basis,
    };
  });
}

/**
 * For each column whether a plan equals the best there, unless all do. A plan that reaches fewer targets than another is never best.
 *
 * @param {Pick<Way, "result">[]} ways
 */
export function isBestIn(ways) {
  const made = ways.map(({ result }) => result);
  const fewest = Math.min(...made.filter((result) => result !== null).map(missed));
  return COLUMNS.map(({ figureOf, least }) => {
    const values = made.map((result) =>
      result && (figureOf === missed || missed(result) === fewest) ? figureOf(result) : null,
    );
    const known = values.filter((value) => value !== null);
    const best = Math.min(...known);
    const areAlike = known.every((value) => value - best < least);
    return values.map((value) => value !== null && !areAlike && value - best < least);
  });
}

/** @param {MissionPageState} state @param {MissionActions} actions @param {boolean} canPlan @returns {Child[]} */
export function alternatives(state, actions, canPlan) {
  const ways = waysOf(state);
  const best = isBestIn(ways);
  const isBusy = ways.some(({ isBeingMade }) => isBeingMade);
  const canAsk = canPlan && !isBusy && ways.some(({ result, fault }) => !result && !fault);
  return [
    h(
      "p",
      { class: "quiet-text" },
      [
        t("One plan of the same targets for each. The best figure of a column is bold."),
        differ(ways) && t("Plans that reach fewer targets do not count for it."),
        openChanges(state.selection, state.mission?.uav_changes).some(({ figures }) => figures.length > 0) &&
          t("All are planned with the figures that this mission has of its UAVs."),
      ]
        .filter(Boolean)
        .join(" "),
    ),
    h(
      "div",
      { class: "ways-place" },
      h(
        "table",
        { class: "why-table ways", "aria-busy": String(isBusy) },
        h(
          "thead",
          {},
          h(
            "tr",
            {},
            h("th", { scope: "col" }, t("Plan|noun")),
            COLUMNS.map(({ words }) => h("th", { scope: "col" }, words)),
          ),
        ),
        h(
          "tbody",
          {},
          ways.map((way, index) =>
            h(
              "tr",
              { class: way.isPresent ? "present" : null, "aria-current": way.isPresent ? "true" : null },
              h("th", { scope: "row" }, nameOf(way, actions, canPlan)),
              cellsOf(
                way,
                best.map((isBest) => isBest[index]),
              ),
            ),
          ),
        ),
      ),
    ),
    isBusy &&
      h("div", {}, h("button", { type: "button", class: "button", onclick: actions.stopAlternatives }, t("Stop"))),
    canAsk &&
      h(
        "div",
        {},
        h("button", { type: "button", class: "button", onclick: actions.planAlternatives }, t("Plan the others")),
      ),
  ];
}

/** Its figures, or why there are none. @param {Way} way @param {boolean[]} isBest by column */
function cellsOf({ result, fault, isBeingMade }, isBest) {
  if (!result)
    return h("td", { colspan: COLUMNS.length }, fault || (isBeingMade ? t("being planned") : t("not planned")));
  return COLUMNS.map(({ figureOf, textOf }, column) => {
    const value = figureOf(result);
    return h(
      "td",
      { class: isBest[column] ? "best" : null },
      value === null ? "—" : textOf(value),
      isBest[column] && h("span", { class: "unseen" }, ` ${t("(best)")}`),
    );
  });
}

/** Whether some reach more targets than others. @param {Way[]} ways */
const differ = (ways) => new Set(ways.flatMap(({ result }) => (result ? [missed(result)] : []))).size > 1;

/** @param {Way} way @param {MissionActions} actions @param {boolean} canPlan */
function nameOf({ objective, words, meaning, result, isPresent }, actions, canPlan) {
  if (isPresent || !result || !canPlan)
    return h(
      "span",
      { class: "way", title: meaning },
      isPresent && icon("check", "small"),
      words,
      isPresent && h("span", { class: "unseen" }, ` ${t("(shown)")}`),
    );
  return h(
    "button",
    { type: "button", class: "text-button", title: meaning, onclick: () => actions.setOption("objective", objective) },
    words,
  );
}
