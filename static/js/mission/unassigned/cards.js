/** One card for each cause for which a plan leaves targets out: how many, why, and the acts that resolve it. */

import { h, icon } from "../../dom.js";
import { shownWhereTimed } from "../../map/zone_details.js";
import { t, tn } from "../../text.js";
import { causesOf, causeWords, commonSentence } from "./causes.js";

/** @import { Child } from "../../dom.js" */
/** @import { MissionActions, ShownPlan, Why } from "../types.d.ts" */
/** @import { Cause } from "./causes.js" */

/**
 * @typedef {object} CardContext
 * @property {MissionActions} actions
 * @property {boolean} canPlan
 * @property {boolean} canCurate
 * @property {(why: Why) => void} askWhy
 * @property {(positions: number[][], zones: number[]) => void} showTogether on the map, with zones lit
 * @property {(position: number[]) => void} addUavAt
 * @property {() => void} lookForDeparture
 * @property {() => void} planFromLaunchSites
 */

const MAX_LISTED = 20;
const TOLD_BY_TITLE = ["stands_inside_zone", "runs_through_zone", "lands_through_zone"];
const BEYOND_BATTERY = ["beyond_range", "beyond_energy"]; // reasons: more launch sites would do
const NEEDS_UAV = ["not_connected", "no_access_for_uavs"]; // a UAV that starts there would do

/** @param {ShownPlan | null} plan @param {CardContext} context @returns {HTMLElement[]} */
export const unassignedCards = (plan, context) => causesOf(plan).map((cause) => card(cause, context));

/** @param {Cause} cause @param {CardContext} context */
function card(cause, context) {
  const { targets } = cause;
  const [first] = targets;
  const isOne = targets.length === 1;
  const title = isOne ? t("{target} is not reached.", { target: first.target.label }) : causeWords(cause);
  return h(
    "div",
    { class: "notice warning", dataset: { cause: cause.code } },
    icon("triangle-alert"),
    h(
      "div",
      {},
      h(
        "p",
        {},
        h("strong", {}, title),
        " ",
        isOne ? first.sentence : !TOLD_BY_TITLE.includes(cause.code) && commonSentence(cause),
      ),
      !isOne && whichOf(cause),
      h("p", { class: "notice-acts" }, actsOf(cause, context)),
    ),
  );
}

/** The targets, each with its own sentence where these differ. @param {Cause} cause */
function whichOf(cause) {
  const common = commonSentence(cause);
  const more = cause.targets.length - MAX_LISTED;
  return h(
    "details",
    {},
    h("summary", {}, t("Which targets")),
    h(
      "ul",
      { class: "causes" },
      cause.targets
        .slice(0, MAX_LISTED)
        .map(({ target, sentence }) => h("li", {}, common ? target.label : `${target.label}: ${sentence}`)),
    ),
    more > 0 && h("p", { class: "caption" }, tn(more, "{count} more target", "{count} more targets")),
  );
}

/** @param {Cause} cause @param {CardContext} context @returns {Child[]} */
function actsOf({ code, reason, targets, zone }, context) {
  const { actions, canPlan, canCurate, askWhy, showTogether, addUavAt } = context;
  const places = targets.flatMap(({ target }) => (target.centre ? [target.centre] : []));
  const id = zone?.id ?? null;
  const [{ target: first }] = targets;
  return [
    places.length > 0 && button(t("Show"), () => showTogether(places, id === null ? [] : [id])),
    targets.length === 1 && button(t("Why?"), () => askWhy({ target: first.key })),
    canPlan && NEEDS_UAV.includes(code) && places.length > 0 && button(t("Add a UAV there"), () => addUavAt(places[0])),
    canPlan && BEYOND_BATTERY.includes(reason) && button(t("Plan from launch sites"), context.planFromLaunchSites),
    canPlan && id !== null && shownWhereTimed(button(t("Look for a better departure"), context.lookForDeparture), id),
    canCurate && id !== null && h("a", { class: "text-button", href: `/zones?id=${id}` }, t("Open the zone")),
    canPlan &&
      button(
        targets.length === 1
          ? t("Remove it")
          : tn(targets.length, "Remove this target", "Remove these {count} targets", { count: targets.length }),
        () => actions.removeTargets(targets.map(({ target }) => target.key)),
      ),
  ];
}

/** @param {string} label @param {() => unknown} act */
const button = (label, act) => h("button", { type: "button", class: "text-button", onclick: act }, label);
