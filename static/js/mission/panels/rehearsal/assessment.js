/** The assessment of a rehearsal: the sentence, its runs, then each route with its figures, curves and targets. */

import { byId, h, icon, refill } from "../../../dom.js";
import { routeLetter, routeNumber } from "../../../domain/palette.js";
import { t } from "../../../text.js";
import { exactHeightText, heightText, numberText, percentText, speedText, whenText } from "../../../units.js";
import { figuresOf, LEVELS, levelWords, nearestOther, sentenceOf } from "../../rehearsal/rehearsal.js";
import { drawCharts } from "../../rehearsal/rehearsal_charts.js";
import { createRehearsalDock } from "./dock.js";
import { conditionsTable, failuresList } from "./findings.js";

/**
 * @import { RehearsalConditions, RehearsalDetail, RehearsalRunWithAssessment, RehearsalTrack, RehearsedRoute, RehearsedTarget,
 *   Assessment, AssessmentLevel } from "../../../api_types.d.ts"
 */
/** @import { Child } from "../../../dom.js" */
/** @import { MissionStore, RehearsalState } from "../../types.d.ts" */
/** @import { Rehearsing } from "./rehearsal.js" */

/** @import { FindingsHow } from "./findings.js" */

/** @typedef {Omit<FindingsHow, "store"> & { canRehearse: boolean, seeInSpace: () => unknown }} AssessmentHow */

/** @param {MissionStore} store @param {Rehearsing} rehearsing @param {AssessmentHow} how */
export function createAssessment(store, rehearsing, { canRehearse, isStage, seeInSpace, ...how }) {
  const place = byId("rehearsal-assessment");
  const dock = isStage ? createRehearsalDock(store, { choose: open }) : null;
  /** @type {number | null} */
  let chosenRoute = null;

  /** Open a route that was chosen elsewhere. @param {number} uav */
  function open(uav) {
    for (const details of /** @type {NodeListOf<HTMLDetailsElement>} */ (place.querySelectorAll(".rehearsal-route")))
      if (details.dataset.uav === `${uav}`) details.open = true;
    choose(uav);
  }

  /** Only one route is open. @param {number} uav */
  function choose(uav) {
    if (chosenRoute === uav) return;
    chosenRoute = uav;
    dock?.draw(uav);
    for (const details of /** @type {NodeListOf<HTMLDetailsElement>} */ (place.querySelectorAll(".rehearsal-route")))
      if (!details.classList.contains(`route-${routeNumber(uav)}`)) details.open = false;
  }

  /** @param {RehearsalDetail} detail @returns {Child} */
  const againButton = (detail) => [
    " ",
    h(
      "button",
      {
        type: "button",
        class: "text-button",
        disabled: store.state.rehearsal.running !== null,
        onclick: () =>
          void rehearsing.start(
            detail.runs.map(({ conditions }) => askedAgain(conditions)),
            { afresh: true },
          ),
      },
      t("Fly it again"),
    ),
  ];

  /**
   * @param {RehearsalDetail} detail
   * @param {number} number of the run
   * @param {RehearsalTrack | null} track
   * @returns {Child}
   */
  function content(detail, number, track) {
    const run = detail.runs[number];
    return [
      h("h3", { class: "rehearsal-sentence", id: "rehearsal-sentence" }, sentenceOf(detail)),
      h(
        "p",
        { class: "caption" },
        t("Simulated {time}", { time: whenText(detail.created_at) }),
        detail.created_by && ` · ${detail.created_by}`,
      ),
      ageNotice(detail),
      conditionsTable(detail, number, (sequence) => void rehearsing.chooseRun(sequence)),
      run?.assessment && failuresList(detail, number, { ...how, isStage, store }),
      run?.is_reused && reusedNote(run, canRehearse && !detail.is_outdated && againButton(detail)),
      run?.assessment && [
        h("p", { class: "rehearsal-air" }, airWords(run.conditions)),
        h(
          "button",
          { type: "button", class: "button small", onclick: seeInSpace },
          icon("move-3d", "small"),
          t("See it in 3D"),
        ),
        routesOf(run.assessment, detail, isStage ? null : track, {
          open: chosenRoute ?? worstRoute(run.assessment),
          choose,
        }),
      ],
      limitsOf(detail),
    ];
  }

  return {
    /** @param {RehearsalState} rehearsal @param {number | undefined} revision of the mission */
    draw({ detail, run, track }, revision) {
      if (!detail?.runs) {
        refill(place, "", () => []);
        return;
      }
      const { id, state, level, is_outdated, ground_changed } = detail;
      const key = [id, state, level, is_outdated, ground_changed, run, Boolean(track), chosenRoute, revision];
      refill(place, JSON.stringify(key), () => content(detail, run, track));
      const shown = detail.runs[run]?.assessment;
      dock?.draw(chosenRoute ?? (shown ? worstRoute(shown) : undefined));
    },
  };
}

/** A notice where it belongs to another plan, or to other map data. @param {RehearsalDetail} detail */
function ageNotice({ is_outdated, ground_changed }) {
  if (is_outdated)
    return h(
      "p",
      { class: "notice warning", role: "status" },
      icon("triangle-alert"),
      h("span", {}, h("strong", {}, t("Outdated:")), " ", t("the plan has changed since. Rehearse again.")),
    );
  if (!ground_changed) return null;
  return h(
    "p",
    { class: "notice advisory" },
    icon("info"),
    h("span", {}, t("Zones, assets or terrain have changed somewhere since.")),
  );
}

/** @param {RehearsalRunWithAssessment} run @param {Child} again */
const reusedNote = (run, again) =>
  h(
    "p",
    { class: "caption rehearsal-reused" },
    t("Flown {time}: the same plan in the same air flies alike, and was not flown again.", {
      time: run.finished_at ? whenText(run.finished_at) : "",
    }),
    again,
  );

/** @param {RehearsalDetail} detail */
const limitsOf = ({ uavs, limits }) =>
  h(
    "details",
    { class: "rehearsal-limits" },
    h("summary", {}, t("Limits and simulated aircraft")),
    uavs.map(({ words }) => h("p", { class: "caption" }, words)),
    h(
      "dl",
      {},
      limits.map(({ words, value, name, source }) => [
        h("dt", {}, words),
        h("dd", {}, limitText(name, value), h("small", {}, source)),
      ]),
    ),
  );

/**
 * @param {Assessment} assessment
 * @param {RehearsalDetail} detail
 * @param {RehearsalTrack | null} track
 * @param {{ open: number | undefined, choose: (uav: number) => void }} chosen
 */
const routesOf = (assessment, { limits }, track, { open, choose }) =>
  assessment.routes.map((route) => {
    const flown = track?.routes.find(({ uav }) => uav === route.uav);
    const element = h(
      "details",
      {
        class: `rehearsal-route route-${routeNumber(route.uav)}`,
        dataset: { uav: route.uav },
        open: open === route.uav,
      },
      h(
        "summary",
        {},
        h("span", { class: "letter" }, routeLetter(route.uav)),
        h("strong", {}, route.name),
        levelMark(route.level),
        icon("chevron-down", "small"),
      ),
      route.reasons.length > 0 &&
        h(
          "ul",
          { class: "rehearsal-reasons" },
          route.reasons.map((words) => h("li", {}, words)),
        ),
      figuresTable(route, limits, assessment),
      flown && drawCharts(flown, route.reserve_percent),
      h("h4", {}, t("Targets")),
      h("ol", { class: "rehearsal-targets" }, failedFirst(route.targets).map(targetRow)),
    );
    element.addEventListener("toggle", () => {
      if (element.open) choose(route.uav);
    });
    return element;
  });

/** @param {RehearsedRoute} route @param {RehearsalDetail["limits"]} limits @param {Assessment} assessment */
function figuresTable(route, limits, assessment) {
  const other = nearestOther(assessment, route.uav);
  const rows = [
    ...figuresOf(route, limits).map(({ words, flown, beside }) => [words, flown, beside]),
    ...(other?.other === undefined
      ? []
      : [[t("From another UAV"), heightText(other.away_m), routeLetter(other.other)]]),
  ];
  return h(
    "table",
    { class: "rehearsal-table" },
    h("caption", { class: "unseen" }, t("Simulated against planned and allowed")),
    h(
      "tbody",
      {},
      rows.map(([words, value, beside]) =>
        h("tr", {}, h("th", { scope: "row" }, words), h("td", { class: "number" }, value), h("td", {}, beside)),
      ),
    ),
  );
}

/** @param {RehearsedTarget[]} targets */
const failedFirst = (targets) =>
  [...targets].sort((a, b) => Number(b.level === "fail") - Number(a.level === "fail") || a.target - b.target);

/** @param {RehearsedTarget} target */
function targetRow({ target, label, level, closest_m, is_reached, battery_percent, reasons }) {
  const reached =
    closest_m === null
      ? t("not flown to")
      : is_reached
        ? t("reached, {away} off", { away: heightText(closest_m) })
        : t("not reached, {away} off", { away: heightText(closest_m) });
  const battery = battery_percent !== null && t("battery {percent}", { percent: percentText(battery_percent) });
  return h(
    "li",
    { class: level },
    icon(LEVELS[level], "small"),
    h(
      "div",
      {},
      h("p", {}, h("strong", {}, `${target + 1} ${label}`), h("span", { class: "unseen" }, ` ${levelWords(level)}`)),
      h("p", { class: "caption" }, [reached, battery].filter(Boolean).join(" · ")),
      reasons.map((words) => h("p", { class: "rehearsal-why" }, words)),
    ),
  );
}

/** @param {AssessmentLevel | ""} level */
const iconOf = (level) => (level ? LEVELS[level] : "circle-dashed");

/** @param {AssessmentLevel} level */
const levelMark = (level) =>
  h("span", { class: `rehearsal-level ${level || "open"}` }, icon(iconOf(level), "small"), levelWords(level));

/** Conditions of a run in the form of a request, for another run. @param {RehearsalConditions} conditions */
const askedAgain = ({ code, name, wind, temperature_c, gusts_mps, turbulence_mps_at_20ft, battery_percent }) =>
  code === "own" ? { name, wind, temperature_c, gusts_mps, turbulence_mps_at_20ft, battery_percent } : code;

/** @param {Assessment} assessment */
const worstRoute = ({ routes }) =>
  (routes.find(({ level }) => level === "fail") ?? routes.find(({ level }) => level === "warnings") ?? routes.at(0))
    ?.uav;

/** @param {string} name ends with its unit @param {number} value */
const limitText = (name, value) =>
  name.endsWith("_percent")
    ? percentText(value)
    : name.endsWith("_s")
      ? `${numberText(value)}\u00a0s`
      : exactHeightText(value);

/** @param {RehearsalConditions} conditions */
function airWords({ wind, gusts_mps, battery_percent }) {
  const first = wind.at(0);
  const words = [
    first && first.speed_mps > 0
      ? t("wind {speed} from {from}° at {height}", {
          speed: speedText(first.speed_mps),
          from: Math.round(first.from_deg),
          height: heightText(first.altitude_agl_m),
        })
      : t("no wind"),
  ];
  if (gusts_mps > 0) words.push(t("gusts {speed}", { speed: speedText(gusts_mps) }));
  if (battery_percent < 100) words.push(t("battery holds {percent}", { percent: percentText(battery_percent) }));
  return words.join(", ");
}
