/** Shares of a route's length, the alternatives with another UAV, limits of the plan, and suggestions. */

import { h } from "../../../dom.js";
import { scheduleText } from "../../../domain/schedule_words.js";
import { heightsText } from "../../../domain/zone_heights.js";
import { zoneDetails } from "../../../map/zone_details.js";
import { t } from "../../../text.js";
import { durationText, energyText, lengthText } from "../../../units.js";
import { longestDuration_s, OBJECTIVES, otherObjective, routesOf } from "../../plan/plan_view.js";
import { basisOf } from "../../selection.js";
import { inUnit } from "./in_unit.js";
import { insteadWords } from "./instead_words.js";

/** @import { BindsEnum, ObjectiveEnum, RouteExplanation } from "../../../api_types.d.ts" */
/** @import { Child } from "../../../dom.js" */
/** @import { MissionActions, MissionStore, ShownPlan, ShownRoute } from "../../types.d.ts" */

/**
 * What an explanation is drawn with.
 *
 * @typedef {object} Explaining
 * @property {ShownPlan} plan
 * @property {MissionStore} store
 * @property {MissionActions} actions
 * @property {boolean} canPlan
 */

const MIN_M = 20; // less is the rounding of positions

/** @param {RouteExplanation} explanation @param {Explaining} explaining @returns {Child[]} */
export function routeExplanation(explanation, explaining) {
  const { plan } = explaining;
  const route = routesOf(plan)[explanation.uav];
  return [
    bar(explanation),
    parts(explanation, route, plan.result.objective),
    zonesInTheWay(explanation),
    instead(explanation, plan),
    limit(plan, route),
    bound(explanation),
    heaviest(explanation, route, explaining),
    otherWay(explaining),
  ];
}

/**
 * [{ name, words, length_m }]: straight, kept to the lines, round zones.
 *
 * @param {Pick<RouteExplanation, "zones" | "straight_m" | "on_lines_m" | "round_zones_m">} explanation
 */
export function partsOf({ zones, straight_m, on_lines_m, round_zones_m }) {
  const names = zones.map(({ name }) => name).join(", ");
  const list = [
    { name: "straight", words: t("Straight from target to target"), length_m: straight_m },
    { name: "lines", words: t("Extra for following lines"), length_m: on_lines_m },
    {
      name: "zones",
      words: names ? t("Round {zones}", { zones: names }) : t("Round no-fly zones"),
      length_m: round_zones_m ?? 0, // null: too large to compute
    },
  ];
  return list.filter(({ name, length_m }) => name === "straight" || length_m >= MIN_M);
}

/** @param {RouteExplanation} explanation */
function bar(explanation) {
  const pieces = partsOf(explanation).map(({ name, length_m }) => {
    const piece = h("i", { class: name });
    piece.style.flexGrow = `${Math.max(1, length_m)}`;
    return piece;
  });
  return h("div", { class: "why-bar", "aria-hidden": "true" }, pieces);
}

/** @param {RouteExplanation} explanation @param {ShownRoute} route @param {ObjectiveEnum} objective */
function parts(explanation, route, objective) {
  const rows = partsOf(explanation).map(({ name, words, length_m }) => {
    const { text, beside } = inUnit(route, length_m, objective);
    return h(
      "div",
      {},
      h("dt", {}, h("i", { class: name, "aria-hidden": "true" }), words),
      h("dd", {}, `${name === "straight" ? "" : "+"}${text}`, beside && h("small", {}, ` ${beside}`)),
    );
  });
  return h("dl", { class: "why-parts" }, rows);
}

/**
 * Zones that force a detour, its length, and their heights and times, once they are read.
 *
 * @param {RouteExplanation} explanation
 */
function zonesInTheWay({ zones }) {
  const found = zones.filter(({ extra_m }) => extra_m >= MIN_M);
  if (!found.length) return null;
  return h(
    "ul",
    { class: "why-zones", "aria-label": t("Zones that force a detour") },
    found.map(({ id, name, extra_m }) => {
      const reason = h("small", {}, id === null ? "" : t("Reading times and source…"));
      if (id !== null) showReason(id, reason);
      return h("li", {}, h("span", { class: "zone-name" }, name, reason), h("span", {}, `+${lengthText(extra_m)}`));
    }),
  );
}

/** Heights and times of a zone. @param {number} id @param {HTMLElement} reason */
function showReason(id, reason) {
  zoneDetails(id).then(
    (details) => {
      const schedule = scheduleText(details.schedule, { otherwise: details.schedule_words });
      reason.textContent = [heightsText(details), schedule].filter(Boolean).join(" · ");
    },
    () => {
      reason.textContent = t("Times and source cannot be read now.");
    },
  );
}

/** @param {RouteExplanation} explanation @param {ShownPlan} plan */
function instead(explanation, plan) {
  const words = insteadWords(explanation, plan);
  return words && h("p", {}, words);
}

/** @param {ShownPlan} plan @param {ShownRoute} route */
function limit(plan, route) {
  const flown = plan.result.routes.filter(({ geometry }) => geometry);
  if (flown.length < 2) return null;
  /** @param {typeof flown[number]} one */
  const end_s = ({ departs_s, duration_s }) => (departs_s ?? 0) + duration_s;
  const last = flown.reduce((a, b) => (end_s(b) > end_s(a) ? b : a));
  const time = durationText(end_s(last));
  const words =
    last.uav === route.uav
      ? t("{name} is the last to be done, after {time}.", { name: last.uav, time })
      : t("Not this route: {name} is the last to be done, after {time}.", { name: last.uav, time });
  return h("p", {}, h("strong", {}, t("Limiting factor:")), " ", words);
}

/** What keeps the route from more targets, or from being quicker. @param {RouteExplanation} explanation */
function bound({ binds, used_wh, usable_wh, wind_s }) {
  /** @type {Record<BindsEnum, string>} */
  const words = {
    battery: t("the battery, {used} of {usable} are used", {
      used: energyText(used_wh ?? 0),
      usable: energyText(usable_wh ?? 0),
    }),
    range: t("its range"),
    most_targets: t("as many targets as it may have"),
    zone: t("a zone"),
    wind: wind_s > 0 ? t("the wind, {time} more than in calm air", { time: durationText(wind_s) }) : t("the wind"),
    balance: t("another UAV’s route is the longest"),
  };
  const explanation = (binds ?? []).flatMap((what) => words[what] ?? []);
  return explanation.length
    ? h("p", {}, h("strong", {}, t("Limiting factor:")), " ", `${sentence(explanation.join("; "))}.`)
    : null;
}

/** @param {string} words */
const sentence = (words) => words[0].toUpperCase() + words.slice(1);

/** @param {RouteExplanation} explanation @param {ShownRoute} route @param {Explaining} explaining */
function heaviest({ heaviest: found }, route, { plan, actions, canPlan }) {
  const target = found && plan.targets[found.target];
  if (!found || !target || found.saves_m < MIN_M || route.targets.length < 2) return null;
  const { text, beside } = inUnit(route, found.saves_m, plan.result.objective);
  const values = { target: target.label, name: route.name, amount: text, length: beside };
  const words = beside
    ? t("Without {target} {name} flies about {amount} ({length}) less.", values)
    : t("Without {target} {name} flies {amount} less.", values);
  return h(
    "p",
    {},
    h("strong", {}, t("What costs most.")),
    " ",
    words,
    " ",
    canPlan &&
      h(
        "button",
        { type: "button", class: "text-button", onclick: () => actions.removeTargets([target.key]) },
        t("Remove it"),
      ),
  );
}

/** The plan by the other objective, where there is one: its gains and costs. @param {Explaining} explaining */
function otherWay({ plan, store, actions, canPlan }) {
  /** @type {ObjectiveEnum} */
  const objective = otherObjective(plan.result.objective);
  const other = store.state.figures[basisOf({ ...store.state.selection, objective })];
  if (!other || !canPlan) return null;
  const time = longestDuration_s(other) - longestDuration_s(plan.result);
  const length = other.total_length_m - plan.result.total_length_m;
  if (Math.abs(time) < 30 && Math.abs(length) < 50) return null;
  const name = OBJECTIVES.find(({ value }) => value === objective)?.words ?? "";
  const clauses = [
    Math.abs(time) >= 30 &&
      (time < 0 ? t("{time} sooner", { time: durationText(-time) }) : t("{time} later", { time: durationText(time) })),
    Math.abs(length) >= 50 &&
      (length < 0
        ? t("{length} less in total", { length: lengthText(-length) })
        : t("{length} more in total", { length: lengthText(length) })),
  ];
  return h(
    "p",
    {},
    h("strong", {}, t("Worth trying.")),
    " ",
    `${name}: ${clauses.filter(Boolean).join(", ")}.`,
    " ",
    h(
      "button",
      { type: "button", class: "text-button", onclick: () => actions.setOption("objective", objective) },
      t("Try it"),
    ),
  );
}
