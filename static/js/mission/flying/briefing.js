/** The briefing before approval: the rehearsal first, then times, heights, batteries and what is left out. Values in, values out. */

import { t, tn } from "../../text.js";
import { durationText, exactText, heightText, lengthText, percentText } from "../../units.js";
import { landing_s } from "../plan/route_times.js";
import { levelWords } from "../rehearsal/rehearsal.js";

/** @import { Mission, NearestZone, Plan, Rehearsal, Route } from "../../api_types.d.ts" */

/** @typedef {{ term: string, words: string, isBad?: boolean }} BriefingFact */

/**
 * The newest finished rehearsal of the present plan, if there is one.
 *
 * @param {Rehearsal[]} rehearsals newest first
 */
export const rehearsalOfPlan = (rehearsals) =>
  rehearsals.find(({ state, is_outdated }) => state === "done" && !is_outdated) ?? null;

/**
 * Whether approval has to say why: the rehearsal failed, or aircraft fly what no simulation has flown.
 *
 * @param {Pick<Mission, "uavs" | "simulates">} mission
 * @param {Rehearsal[]} rehearsals
 */
export function needsReason({ uavs, simulates }, rehearsals) {
  if (simulates) return false;
  const newest = rehearsalOfPlan(rehearsals);
  if (newest) return newest.level === "fail";
  return uavs.some(({ is_simulated }) => !is_simulated);
}

/**
 * @param {Pick<Mission, "plan">} mission
 * @param {Rehearsal[]} rehearsals
 * @param {NearestZone | null} [nearest] of the plan; without it nothing is said of zones, null: none is near
 * @returns {BriefingFact[]}
 */
export function briefingOf({ plan }, rehearsals, nearest) {
  const facts = [rehearsalFact(rehearsals)];
  const routes = plan?.routes.filter(({ geometry }) => geometry) ?? [];
  if (!plan || !routes.length) return facts;
  return [
    ...facts,
    { term: t("Departure"), words: plan.departs_at ? exactText(plan.departs_at) : t("Any time") },
    ...timeFacts(routes),
    { term: t("Distance"), words: lengthText(plan.total_length_m) },
    {
      term: t("Highest point"),
      words: t("{height} above ground", {
        height: heightText(Math.max(...routes.flatMap(({ waypoints }) => waypoints.map((one) => one.altitude_agl_m)))),
      }),
    },
    ...zoneFact(nearest),
    ...batteryFact(routes),
    ...leftOut(plan),
  ];
}

/** @param {Rehearsal[]} rehearsals @returns {BriefingFact} */
function rehearsalFact(rehearsals) {
  const term = t("Rehearsal");
  const newest = rehearsalOfPlan(rehearsals);
  if (newest) {
    const failing = newest.runs.filter(({ level }) => level === newest.level).map(({ words }) => words);
    const words = failing.length ? `${levelWords(newest.level)}: ${failing.join(", ")}` : levelWords(newest.level);
    return { term, words: words ?? "", isBad: newest.level === "fail" };
  }
  const wasFlown = rehearsals.some(({ state }) => state === "done");
  return { term, words: wasFlown ? t("None of this plan: it has changed since") : t("Not rehearsed"), isBad: true };
}

/** @param {Route[]} routes @returns {BriefingFact[]} */
function timeFacts(routes) {
  const landings = routes.map(landing_s);
  const ends_s = landings.every((landing) => landing !== null) ? Math.max(...landings.map(Number)) : null;
  const starts = routes.filter(({ departs_s }) => departs_s > 0);
  return [
    ...(ends_s === null ? [] : [{ term: t("Total duration"), words: durationText(ends_s) }]),
    ...(starts.length
      ? [
          {
            term: t("Later take-offs"),
            words: starts.map(({ uav, departs_s }) => `${uav} +${durationText(departs_s)}`).join(", "),
          },
        ]
      : []),
  ];
}

/** @param {NearestZone | null | undefined} nearest @returns {BriefingFact[]} */
function zoneFact(nearest) {
  if (nearest === undefined) return [];
  const words = nearest ? `${nearest.name}, ${lengthText(nearest.metres)}` : t("None within 5 km");
  return [{ term: t("Nearest zone"), words }];
}

/** @param {Route[]} routes @returns {BriefingFact[]} */
function batteryFact(routes) {
  const left = routes.flatMap(({ uav, battery_left_percent }) =>
    (battery_left_percent ?? []).map((percent) => ({ uav, percent })),
  );
  if (!left.length) return [];
  const lowest = left.reduce((least, one) => (one.percent < least.percent ? one : least));
  return [{ term: t("Lowest battery"), words: `${percentText(lowest.percent)} (${lowest.uav})` }];
}

/** @param {Plan} plan @returns {BriefingFact[]} */
function leftOut({ unassigned }) {
  const count = unassigned.length;
  return count ? [{ term: t("Not planned"), words: tn(count, "{count} target", "{count} targets"), isBad: true }] : [];
}
