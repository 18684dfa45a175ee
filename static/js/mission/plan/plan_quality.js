/** Texts on the quality of a plan, the cost of its locks, and the best plan of a running search. Values in, values out. */

import { t, tn } from "../../text.js";
import { durationText, energyText, lengthText, numberText } from "../../units.js";

/** @import { Plan } from "../../api_types.d.ts" */
/** @import { BestSoFar } from "../types.d.ts" */

/** @param {number} share */
const shareText = (share) => `${numberText(share * 100, 1)}\u00a0%`;
const MIN_SHARE = 0.0005; // smaller values are indistinguishable from 0

const LEFT_TO_THE_SEARCH = ["beyond_range", "beyond_energy", "most_targets"]; // others no plan reaches

/**
 * Quality of a plan: { isProven, words, detail }; null where it is unknown, or no UAV flies. A bound holds for the plans that reach as
 * many targets. No bound exists on which targets can be reached together: where the search has dropped some, a figure would mislead.
 *
 * @param {Plan} result
 */
export function qualityOf({
  objective,
  lower_bound_m,
  lower_bound_s,
  lower_bound_wh,
  gap,
  gap_of,
  is_proven,
  wish,
  routes,
  unassigned = [],
}) {
  const isKnown = is_proven || (gap !== null && gap !== undefined && gap < 1);
  if (!isKnown || !routes.some((route) => route.geometry)) return null;
  if (is_proven)
    return { isProven: true, words: provenWords(objective, Boolean(wish), unassigned.length > 0), detail: "" };
  if (gap === null || unassigned.some(({ reason }) => LEFT_TO_THE_SEARCH.includes(reason))) return null;
  const above = gap / (1 - gap); // `gap` is a share of this plan
  const bound = { total: lower_bound_m, energy: lower_bound_wh, makespan: lower_bound_s, time: lower_bound_s }[
    objective
  ];
  const share = shareText(above);
  if (gap_of === "without_timed_zones")
    return { isProven: false, words: beyondTimedZones(above < MIN_SHARE ? null : share, Boolean(wish)), detail: "" };
  const words =
    above < MIN_SHARE
      ? t("Best possible.")
      : wish
        ? t("Within {share} of the best possible with the locked targets.", { share })
        : t("Within {share} of the best possible.", { share });
  return { isProven: false, words, detail: bound === null || bound === undefined ? "" : boundWords(objective, bound) };
}

/**
 * The text against the best plan without temporary zones: possibly no plan that avoids them is as good. share: null: no difference.
 *
 * @param {string | null} share
 * @param {boolean} isLocked
 */
function beyondTimedZones(share, isLocked) {
  if (share === null) return t("As good as the best plan without temporary zones.");
  if (isLocked)
    return t("Within {share} of the best plan with the locked targets and without temporary zones.", {
      share,
    });
  return t("Within {share} of the best plan without temporary zones.", { share });
}

/** @param {Plan["objective"]} objective @param {number} bound */
function boundWords(objective, bound) {
  if (objective === "total") return t("Lower bound: {length}.", { length: lengthText(bound) });
  if (objective === "energy") return t("Lower bound: {energy}.", { energy: energyText(bound) });
  if (objective === "time") return t("Lower bound: {time} of flight.", { time: durationText(bound) });
  return t("Lower bound: {time}.", { time: durationText(bound) });
}

/**
 * By objective: as it is, with locks, where targets are left out, with both.
 *
 * @type {Record<Plan["objective"], string[]>}
 */
const PROVEN = {
  total: [
    t("Proven shortest."),
    t("Proven shortest with what is locked."),
    t("Proven shortest of plans that reach as many targets."),
    t("Proven shortest with what is locked, of plans that reach as many targets."),
  ],
  makespan: [
    t("Proven soonest."),
    t("Proven soonest with what is locked."),
    t("Proven soonest of plans that reach as many targets."),
    t("Proven soonest with what is locked, of plans that reach as many targets."),
  ],
  time: [
    t("Proven least flying time."),
    t("Proven least flying time with what is locked."),
    t("Proven least flying time of plans that reach as many targets."),
    t("Proven least flying time with what is locked, of plans that reach as many targets."),
  ],
  energy: [
    t("Proven least energy."),
    t("Proven least energy with what is locked."),
    t("Proven least energy of plans that reach as many targets."),
    t("Proven least energy with what is locked, of plans that reach as many targets."),
  ],
};

/** @param {Plan["objective"]} objective @param {boolean} isLocked @param {boolean} leavesOut */
const provenWords = (objective, isLocked, leavesOut) => PROVEN[objective][(isLocked ? 1 : 0) + (leavesOut ? 2 : 0)];

/**
 * The cost of the locked parts of a plan: "Your wish costs 2.3 km more (+4.0 %)." Empty without locks.
 *
 * @param {Pick<Plan, "objective" | "wish">} result
 */
export function wishWordsOf({ objective, wish }) {
  if (!wish) return "";
  const isTotal = objective !== "makespan"; // the cost in flying time or energy is not shown: it is stored in metres
  const [cost, free] = isTotal ? [wish.cost_m, wish.free_total_m] : [wish.cost_s, wish.free_longest_s];
  const leftOut =
    wish.left_out > 0
      ? tn(wish.left_out, "The change leaves out {count} target more.", "The change leaves out {count} targets more.")
      : "";
  if (cost === null || cost === undefined) return leftOut || t("Cost of the change unknown.");
  const figure = (isTotal ? lengthText : durationText)(Math.abs(cost));
  const share = free > 0 ? ` (${cost < 0 ? "−" : "+"}${shareText(Math.abs(cost) / free)})` : "";
  const isNothing = Math.abs(cost) < (isTotal ? 1 : 0.5);
  const words = isNothing
    ? t("The change costs nothing.")
    : cost > 0
      ? t("The change costs {figure} more{share}.", { figure, share })
      : t("The change saves {figure}{share}: the search had not found it.", { figure, share });
  return [words, leftOut].filter(Boolean).join(" ");
}

/**
 * The best plan of a search so far: "51.2 km so far, at most 3.1 % above what is possible (49.7 km)".
 *
 * @param {BestSoFar | null} best
 */
export function bestWordsOf(best) {
  if (!best) return "";
  const { unit, value, bound, left_out } = best;
  const textOf = { m: lengthText, s: durationText, Wh: energyText }[unit];
  const figure = textOf(value);
  const words =
    bound !== null && bound > 0 && !left_out
      ? t("{figure} so far, within {share} of the best possible ({least})", {
          figure,
          share: shareText(Math.max(0, value / bound - 1)),
          least: textOf(bound),
        })
      : t("{figure} so far", { figure });
  return [words, left_out > 0 && tn(left_out, "{count} target is not reached", "{count} targets are not reached")]
    .filter(Boolean)
    .join(", ");
}
