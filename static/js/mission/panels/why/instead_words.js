/** The cost of giving a target to another UAV, in the unit of the plan's objective. Values in, values out. */

import { t } from "../../../text.js";
import { durationText, energyText, lengthText } from "../../../units.js";
import { longestDuration_s } from "../../plan/plan_view.js";
import { energyFor_wh, timeFor_s } from "./in_unit.js";

/** @import { RouteExplanation } from "../../../api_types.d.ts" */
/** @import { ShownPlan } from "../../types.d.ts" */

const MIN_S = 30; // less is no other time

/**
 * Delay of the last UAV's end: the target's own hover time moves with it and counts for neither.
 *
 * @param {RouteExplanation} explanation
 * @param {ShownPlan["result"]} result
 */
function finishChange_s({ uav, alternative }, result) {
  if (!alternative) return 0;
  const { uav: to, other_length_m, total_change_m } = alternative;
  const [own, other] = [result.routes[uav], result.routes[to]];
  const theirs_m = other_length_m - other.length_m;
  const routes = result.routes.map((route, place) => {
    if (place === uav) return { ...route, duration_s: own.duration_s + timeFor_s(own, total_change_m - theirs_m) };
    const speed = other.length_m > 0 ? other : own; // one that has not flown yet flies as fast as this one
    return place === to ? { ...route, duration_s: other.duration_s + timeFor_s(speed, theirs_m) } : route;
  });
  return longestDuration_s({ ...result, routes }) - longestDuration_s(result);
}

/**
 * What both routes together take more, by the means of each: seconds or watt-hours; null where these are not counted.
 *
 * @param {RouteExplanation} explanation
 * @param {ShownPlan["result"]} result
 * @param {typeof energyFor_wh} amountFor
 */
function totalChange({ uav, alternative }, result, amountFor) {
  if (!alternative) return null;
  const [own, other] = [result.routes[uav], result.routes[alternative.uav]];
  const theirs_m = alternative.other_length_m - other.length_m;
  const theirs = amountFor(other.length_m > 0 ? other : own, theirs_m);
  const ours = amountFor(own, alternative.total_change_m - theirs_m);
  return theirs === null || ours === null ? null : theirs + ours;
}

/**
 * For plans of the least flying time or energy of all together; empty where that is not counted.
 *
 * @param {RouteExplanation} explanation
 * @param {ShownPlan["result"]} result
 * @param {Record<string, string>} values
 */
function totalWords(explanation, result, values) {
  const [amountFor, textOf] = result.objective === "energy" ? [energyFor_wh, energyText] : [timeFor_s, durationText];
  const change = totalChange(explanation, result, amountFor);
  if (change === null) return "";
  const of = { ...values, amount: textOf(Math.abs(change)) };
  return change >= 0
    ? t("Giving {target} to {other} would take about {amount} more in total.", of)
    : t("Giving {target} to {other} would take about {amount} less in total.", of);
}

/** Empty where there is no other UAV for it. @param {RouteExplanation} explanation @param {ShownPlan} plan */
export function insteadWords(explanation, { result, targets }) {
  const { alternative } = explanation;
  if (!alternative) return "";
  const time_s = finishChange_s(explanation, result);
  const values = {
    other: result.routes[alternative.uav].uav,
    target: targets[alternative.target]?.label ?? "",
    length: lengthText(alternative.other_length_m),
    range: lengthText(alternative.max_range_m),
    change: lengthText(Math.abs(alternative.total_change_m)),
    time: durationText(Math.abs(time_s)),
  };
  const isMore = alternative.total_change_m >= 0;
  if (alternative.is_beyond_range)
    return t("Giving {target} to {other} is not possible: it would fly {length}, its range is {range}.", values);
  const inTotal = ["time", "energy"].includes(result.objective) ? totalWords(explanation, result, values) : "";
  if (inTotal) return inTotal;
  if (result.objective !== "makespan")
    return isMore
      ? t("Giving {target} to {other} would fly {change} more in total.", values)
      : t("Giving {target} to {other} would fly {change} less in total.", values);
  if (Math.abs(time_s) < MIN_S)
    return isMore
      ? t("Giving {target} to {other} would finish at about the same time (and fly {change} more).", values)
      : t("Giving {target} to {other} would finish at about the same time (and fly {change} less).", values);
  if (time_s < 0) return t("Giving {target} to {other} would finish about {time} earlier.", values);
  return isMore
    ? t("Giving {target} to {other} would finish about {time} later (and fly {change} more).", values)
    : t("Giving {target} to {other} would finish about {time} later (and fly {change} less).", values);
}
