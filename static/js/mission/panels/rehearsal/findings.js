/** What a rehearsal found: a table of conditions by UAVs, and the failures of the chosen condition, each with Show and one fix. */

import { h, icon } from "../../../dom.js";
import { routeNumber } from "../../../domain/palette.js";
import { t, tn } from "../../../text.js";
import { percentText } from "../../../units.js";
import { conditionsOf } from "../../options/flight_options.js";
import { conditionsByUav, failuresFirst, fixOf } from "../../rehearsal/findings.js";
import { LEVELS, levelWords } from "../../rehearsal/rehearsal.js";

/** @import { Finding, RehearsalDetail } from "../../../api_types.d.ts" */
/** @import { MissionActions, MissionStore } from "../../types.d.ts" */
/** @import { Fix, ConditionCell } from "../../rehearsal/findings.js" */

/**
 * @typedef {object} FindingsHow
 * @property {MissionStore} store
 * @property {MissionActions} actions
 * @property {boolean} canPlan the plan may be changed
 * @property {boolean} isStage the page shows only the rehearsal
 * @property {(positions: number[][]) => void} showPlaces on the map
 */

const SHOWN_FIRST = 6;

/** @param {RehearsalDetail} detail @param {number} shown @param {(sequence: number) => void} choose */
export function conditionsTable(detail, shown, choose) {
  const { columns, rows } = conditionsByUav(detail);
  return h(
    "div",
    { class: "assessed-place", role: "group", "aria-label": t("Conditions") },
    h(
      "table",
      { class: "assessed" },
      h(
        "thead",
        {},
        h(
          "tr",
          {},
          h("th", { scope: "col" }, t("Condition")),
          columns.map(({ uav, name, letter }) =>
            h(
              "th",
              { scope: "col", class: `route-${routeNumber(uav)}` },
              h("span", { class: "letter", "aria-hidden": "true" }, letter),
              " ",
              h("span", { class: "assessed-uav", title: name }, name),
            ),
          ),
          h("th", { scope: "col", class: "number", title: t("Battery at landing") }, t("Lowest|battery")),
        ),
      ),
      h(
        "tbody",
        {},
        rows.map((row) =>
          h(
            "tr",
            { class: row.sequence === shown ? "chosen" : null },
            h(
              "th",
              { scope: "row" },
              h(
                "button",
                {
                  type: "button",
                  class: "text-button",
                  "aria-pressed": `${row.sequence === shown}`,
                  disabled: !row.level,
                  onclick: () => choose(row.sequence),
                },
                row.words,
              ),
              h("small", {}, ` ${row.air}`),
            ),
            row.cells.map(cell),
            h("td", { class: "number" }, row.lowest_percent === null ? "—" : percentText(row.lowest_percent)),
          ),
        ),
      ),
    ),
  );
}

/** "4", or "3 of 4" where some fail. @param {ConditionCell | null} one */
function cell(one) {
  if (!one?.level) return h("td", {}, "—");
  const { level, passed, all } = one;
  return h(
    "td",
    { class: `assessed-cell ${level}` },
    icon(LEVELS[level], "small"),
    h("span", { class: "unseen" }, `${levelWords(level)}: `),
    passed === all ? `${all}` : t("{passed} of {all}", { passed, all }),
  );
}

/**
 * What failed in the chosen condition, then its warnings; null where nothing did.
 *
 * @param {RehearsalDetail} detail
 * @param {number} number of the run
 * @param {FindingsHow} how
 */
export function failuresList(detail, number, how) {
  const run = detail.runs[number];
  const findings = run ? failuresFirst(run) : [];
  if (!findings.length) return null;
  const rows = findings.map((finding) => {
    const fix =
      how.canPlan && !detail.is_outdated ? fixOf(finding, run, how.store.state.mission?.conditions ?? null) : null;
    return failure(finding, fix, detail.is_outdated ? [] : placesOf(finding, how), how);
  });
  const more = rows.length - SHOWN_FIRST;
  return [
    h("ul", { class: "assessed-failures", "aria-label": t("What failed") }, rows.slice(0, SHOWN_FIRST)),
    more > 0 &&
      h(
        "details",
        { class: "assessed-more" },
        h("summary", {}, tn(more, "{count} more", "{count} more")),
        h("ul", { class: "assessed-failures" }, rows.slice(SHOWN_FIRST)),
      ),
  ];
}

/** @param {Finding} finding @param {Fix | null} fix @param {number[][]} places @param {FindingsHow} how */
function failure({ level, message }, fix, places, how) {
  return h(
    "li",
    { class: level },
    icon(LEVELS[level], "small"),
    h(
      "div",
      {},
      h("p", {}, h("span", { class: "unseen" }, `${levelWords(level)}: `), message),
      h(
        "p",
        { class: "notice-acts" },
        places.length > 0 &&
          h("button", { type: "button", class: "text-button", onclick: () => how.showPlaces(places) }, t("Show")),
        fix && h("button", { type: "button", class: "text-button", onclick: () => planAgain(fix, how) }, fix.words),
      ),
    ),
  );
}

/** Where it happened: at the waypoint, else at the target. @param {Finding} finding @param {FindingsHow} how */
function placesOf({ uav, waypoint, target }, { store }) {
  const { plan } = store.state;
  const point = waypoint === null ? undefined : plan?.result.routes[uav]?.waypoints[waypoint]?.position;
  const centre = target === null ? undefined : plan?.targets[target]?.centre;
  const place = point ?? centre;
  return place ? [place] : [];
}

/** @param {Fix} fix @param {FindingsHow} how */
function planAgain(fix, { store, actions, isStage }) {
  if (fix.code === "by_hand") {
    if (isStage) location.assign(`/missions/${store.state.mission?.id}`);
    else void actions.beginManually(fix.uav);
    return;
  }
  if (fix.code === "reserve") actions.changeUav(fix.uav, { reserve_percent: fix.percent });
  else actions.setOption("conditions", conditionsOf(fix.conditions));
  actions.plan();
}
