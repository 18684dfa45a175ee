/** Why a plan leaves targets out, by cause: what keeps them out, and which. Values in, values out. */

import { t, tn } from "../../text.js";
import { unassignedOf } from "../plan/plan_view.js";

/** @import { Unassigned } from "../../api_types.d.ts" */
/** @import { PickedTarget, ShownPlan } from "../types.d.ts" */

/** @typedef {{ name: string, id: number | null }} NamedZone */
/** @typedef {{ target: PickedTarget, sentence: string }} UnassignedTarget */
/**
 * What keeps targets from every route. code: of the first reason, or of what bars every path; zone: where that is one.
 *
 * @typedef {object} Cause
 * @property {string} code
 * @property {string} reason
 * @property {NamedZone | null} zone
 * @property {UnassignedTarget[]} targets
 */

const BARRIERS = ["not_connected", "barred_by_zone"]; // these stand beside "no permitted route"
const OF_ONE_UAV = /^(tied|locked)_to/;

/** @param {Unassigned["why"]} why @returns {NamedZone | null} */
function zoneOf(why) {
  const params = why.find(({ params }) => typeof params.zone === "string")?.params;
  return params ? { name: String(params.zone), id: typeof params.zone_id === "number" ? params.zone_id : null } : null;
}

/** One entry for each cause, that of most targets first. @param {ShownPlan | null} plan @returns {Cause[]} */
export function causesOf(plan) {
  /** @type {Map<string, Cause>} */
  const causes = new Map();
  for (const { target, reason, sentence, why } of unassignedOf(plan)) {
    const zone = zoneOf(why);
    const code = why.find((one) => BARRIERS.includes(one.code))?.code ?? why[0]?.code ?? reason;
    const uav = OF_ONE_UAV.test(code) ? why[0].params.uav : null;
    const others = why.slice(1).map((one) => one.code);
    const key = JSON.stringify([reason, code, zone, uav, others.includes("locked_run"), why.length ? "" : sentence]);
    const cause = causes.get(key) ?? { code, reason, zone, targets: [] };
    cause.targets.push({ target, sentence });
    causes.set(key, cause);
  }
  return [...causes.values()].sort((a, b) => b.targets.length - a.targets.length);
}

/** The headline of a cause of several targets. @param {Cause} cause */
export function causeWords({ code, reason, zone, targets }) {
  const count = targets.length;
  const values = { zone: zone?.name ?? t("a no-fly zone") };
  /** @type {Record<string, () => string>} */
  const ofCode = {
    runs_through_zone: () =>
      tn(count, "{count} target runs through {zone}.", "{count} targets run through {zone}.", values),
    lands_through_zone: () =>
      tn(
        count,
        "Landing at {count} target leads through {zone}.",
        "Landing at {count} targets leads through {zone}.",
        values,
      ),
    not_connected: () =>
      tn(
        count,
        "{count} target is not connected to the network of any UAV.",
        "{count} targets are not connected to the network of any UAV.",
      ),
    barred_by_zone: () =>
      tn(count, "{zone} bars every route to {count} target.", "{zone} bars every route to {count} targets.", values),
    in_range_alone: () => notTogether(count),
    in_reach_alone: () => notTogether(count),
    not_on_one_route: () => notTogether(count),
  };
  /** @type {Record<string, () => string>} */
  const ofReason = {
    inside_zone: () => tn(count, "{count} target lies in {zone}.", "{count} targets lie in {zone}.", values),
    no_path: () => tn(count, "No permitted route to {count} target.", "No permitted route to {count} targets."),
    too_far_from_network: () =>
      tn(count, "{count} target is too far from the network.", "{count} targets are too far from the network."),
    beyond_range: () =>
      tn(count, "{count} target is out of range of every UAV.", "{count} targets are out of range of every UAV."),
    beyond_energy: () => tn(count, "No battery lasts for {count} target.", "No battery lasts for {count} targets."),
    wind: () => tn(count, "The wind is too strong for {count} target.", "The wind is too strong for {count} targets."),
    above_height_limit: () =>
      tn(
        count,
        "{count} target is too tall for the height limit.",
        "{count} targets are too tall for the height limit.",
      ),
    asset_gone: () => tn(count, "{count} target has been deleted.", "{count} targets have been deleted."),
    most_targets: () =>
      tn(
        count,
        "{count} target is left: every UAV has as many as it may have.",
        "{count} targets are left: every UAV has as many as it may have.",
      ),
    not_allowed: () => tn(count, "No UAV may fly {count} target.", "No UAV may fly {count} targets."),
  };
  return (
    ofCode[code] ??
    ofReason[reason] ??
    (() => tn(count, "{count} target is not reached.", "{count} targets are not reached."))
  )();
}

/** @param {number} count */
const notTogether = (count) =>
  tn(
    count,
    "{count} target is reachable only without the others.",
    "{count} targets are reachable only without the others.",
  );

/** The sentence below the headline: what all of them have in common, empty where figures differ. @param {Cause} cause */
export function commonSentence({ targets }) {
  const [first, ...others] = targets.map(({ sentence }) => sentence);
  return others.every((sentence) => sentence === first) ? first : "";
}
