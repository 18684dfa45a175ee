/** The row of a route: its UAV, strip and figures, and the buttons to edit and to explain it. */

import { h, icon } from "../../../dom.js";
import { routeNumber } from "../../../domain/palette.js";
import { t, tn } from "../../../text.js";
import { durationText, lengthText } from "../../../units.js";
import { timeAt } from "../../options/flight_options.js";
import { moreOrLess } from "../../plan/compare.js";
import { endingOf, GROUNDING } from "../../plan/plan_view.js";
import { batteryOf, delayText, landing_s, staysText } from "../../plan/route_times.js";

/** @import { Child } from "../../../dom.js" */
/** @import { PlanResult, ShortRoute, ShownRoute } from "../../types.d.ts" */

/**
 * @typedef {object} RowContext
 * @property {PlanResult} result of the plan
 * @property {boolean} canPlan
 * @property {boolean} isChosen
 * @property {boolean} isChanged targets were moved to it or from it since
 * @property {boolean} showsBattery
 * @property {ShortRoute | null} before the route of the same UAV in the plan that it is compared with
 * @property {Child} strips
 * @property {RowActs} acts
 */
/**
 * @typedef {object} RowActs
 * @property {() => void} look
 * @property {() => void} leave
 * @property {() => void} choose
 * @property {() => void} change edit manually
 * @property {() => void} explain
 */

/**
 * Whether its UAV cannot take off; the notice and the UAV's row name it.
 *
 * @param {PlanResult} result
 * @param {ShownRoute} route
 */
const isGrounded = ({ warnings }, { sequence }) =>
  (warnings ?? []).some(({ code, uav }) => GROUNDING.includes(code) && uav === sequence);

/** @param {ShownRoute} route @param {PlanResult} result */
function secondWords(route, result) {
  if (route.geometry)
    return [
      tn(route.targets.length, "{count} target", "{count} targets"),
      route.by_hand?.length > 0 && t("changed by hand"),
      staysText(route),
      delayText(route),
      endingOf(route),
    ]
      .filter(Boolean)
      .join(" · ");
  if (isGrounded(result, route)) return t("cannot take off");
  return result.unassigned.length ? t("Not used: no target in reach") : t("not needed");
}

/** @param {ShownRoute} route @param {RowContext} context */
export function routeRow(route, context) {
  const { result, isChosen, isChanged, strips, acts } = context;
  const second = isChanged ? t("Change not planned yet.") : secondWords(route, result);
  return h(
    "li",
    {
      class: `route route-${routeNumber(route.sequence)}`,
      dataset: { sequence: route.sequence },
      onpointerenter: acts.look,
      onpointerleave: acts.leave,
      onfocusin: acts.look,
      onfocusout: acts.leave,
    },
    h(
      "button",
      {
        type: "button",
        class: "who",
        disabled: !route.geometry,
        "aria-pressed": String(isChosen),
        title: second,
        onclick: acts.choose,
      },
      h("span", { class: "letter" }, route.letter),
      h("span", {}, h("strong", {}, route.name), h("small", {}, second)),
    ),
    h("div", { class: "strip-place" }, strips),
    figuresOf(route, context),
    route.geometry && actsOf(route, context),
  );
}

/**
 * Length, time and battery; with an earlier plan also the differences.
 *
 * @param {ShownRoute} route
 * @param {RowContext} context
 */
function figuresOf(route, { result, before, showsBattery }) {
  const isUsed = Boolean(route.geometry);
  const landing = isUsed && result.departs_at && !before ? landing_s(route) : null;
  const battery = isUsed ? batteryOf(route) : null;
  return [
    h(
      "span",
      { class: "figure length-figure" },
      isUsed ? lengthText(route.length_m) : "—",
      before && h("small", {}, moreOrLess(route.length_m - before.length_m, 50, lengthText)),
    ),
    h(
      "span",
      {
        class: "figure",
        title: landing === null ? null : t("until {time}", { time: timeAt(result.departs_at, landing) }),
      },
      isUsed ? durationText(route.duration_s) : "—",
      before && h("small", {}, moreOrLess(route.duration_s - before.duration_s, 30, durationText)),
      landing !== null && h("small", {}, t("until {time}", { time: timeAt(result.departs_at, landing) })),
    ),
    showsBattery &&
      h(
        "span",
        {
          class: "figure battery-figure",
          title: battery ? t("{percent} left, {energy} used", { percent: battery.left, energy: battery.used }) : null,
        },
        battery?.left ?? "—",
        battery && h("small", {}, t("at landing")),
      ),
  ];
}

/** @param {ShownRoute} route @param {RowContext} context */
function actsOf({ name, charging }, { canPlan, acts }) {
  const charges = Boolean(charging?.length);
  return h(
    "span",
    { class: "route-acts" },
    canPlan &&
      h(
        "button",
        {
          type: "button",
          class: "icon-button tight",
          "aria-label": t("Change the route of {name} by hand", { name }),
          title: charges ? t("A route with stops to charge cannot be changed by hand.") : t("Change by hand"),
          disabled: charges,
          onclick: acts.change,
        },
        icon("hand", "small"),
      ),
    h(
      "button",
      {
        type: "button",
        class: "text-button why-button",
        "aria-label": t("Why does {name} fly this route?", { name }),
        onclick: acts.explain,
      },
      t("Why?"),
    ),
  );
}
