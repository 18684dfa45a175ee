/** Legs, alerts, commands and results, each a list that can be unfolded. */

import { h, icon } from "../dom.js";
import { commandWords, timesOf } from "../domain/flying.js";
import { routeLetter, routeNumber } from "../domain/palette.js";
import { waypointName } from "../record/labels.js";
import { capital } from "../record/sentence.js";
import { simulatedMark } from "../simulated.js";
import { t, tn } from "../text.js";
import { clockText, exactClockText, exactHeightText, exactText, lengthText } from "../units.js";
import { fold } from "./side.js";

/** @import { Alert, Command, FlownLeg, FlownStage, Incident, MissionRecord, RecordRoute } from "../api_types.d.ts" */
/** @import { Properties } from "../dom.js" */
/** @import { Labels } from "../record/labels.js" */
/** @import { LookedLeg } from "./types.d.ts" */

/** @typedef {(leg: LookedLeg | null) => void} OnLook what the pointer or the focus is on */

const LEVELS = {
  critical: { words: t("Critical"), image: "octagon-alert" },
  warning: { words: t("Warning"), image: "triangle-alert" },
  advisory: { words: t("Advisory"), image: "info" },
};
const ENDS = { start: t("take-off"), end: t("end"), base: t("base") };
/** @param {number} sequence */
const pointName = (sequence) => t("point {number}", { number: sequence });
/** @param {number} place @param {readonly number[]} colours of the mission */
const letter = (place, colours) =>
  h("span", { class: `letter route-${routeNumber(place, colours)}` }, routeLetter(place));

/**
 * By target, the legs to each unfolded at will.
 *
 * @param {MissionRecord} record
 * @param {Labels} labels
 * @param {OnLook} onLook
 */
export function drawLegs(record, labels, onLook) {
  const routes = record.routes.filter(({ stages }) => stages.length);
  const count = routes.reduce((sum, { stages }) => sum + stages.length, 0);
  fold(
    "legs",
    count,
    h(
      "div",
      {},
      routes.map((route) => legTable(route, labels, record.mission.colours, onLook)),
    ),
  );
}

/** @param {number | null} value */
const metres = (value) => (value === null ? "—" : exactHeightText(value));
/** @param {number | null} rms @param {number | null} max */
const errors = (rms, max) =>
  h(
    "td",
    { class: "number", title: t("RMS {rms}, greatest {max}", { rms: metres(rms), max: metres(max) }) },
    rms === null ? "—" : [metres(rms), h("small", {}, metres(max))],
  );

/**
 * A row of a leg or of a stage.
 *
 * @param {FlownLeg | FlownStage} leg
 * @param {string} name
 * @param {() => void} look
 * @param {() => void} leave
 * @param {{ button?: Properties, words?: string, isWithin?: boolean }} how isWithin: part of a stage, collapsed with it
 */
function legRow(leg, name, look, leave, { button, words = "", isWithin = false }) {
  const small = [words, leg.reports === 0 && t("no telemetry")].filter(Boolean).join(", ");
  return h(
    "tr",
    {
      class: [isWithin && "report-within", !leg.reports && "unflown"].filter(Boolean).join(" "),
      hidden: isWithin,
      onpointerenter: look,
      onpointerleave: leave,
    },
    h(
      "th",
      { scope: "row" },
      h("button", { type: "button", class: "report-leg", onfocus: look, onblur: leave, ...button }, name),
      small && h("small", {}, small),
    ),
    h("td", { class: "number" }, lengthText(leg.length_m)),
    errors(leg.across_rms_m, leg.across_max_m),
    errors(leg.height_rms_m, leg.height_max_m),
  );
}

/** @param {RecordRoute} route @param {Labels} labels @param {readonly number[]} colours of the mission @param {OnLook} onLook */
function legTable(route, labels, colours, onLook) {
  const heads = [t("Leg"), t("Length"), t("Off route"), t("Height error")];
  const several = route.stages.some(({ flight }) => flight > 1);
  /** @param {FlownLeg | FlownStage} leg @param {Parameters<typeof legRow>[4]} how */
  const row = (leg, how) => {
    const { from_sequence: from, to_sequence: to } = leg;
    const name = [from, to].map((sequence) => waypointName(route, sequence, labels, ENDS, pointName)).join(" – ");
    return legRow(
      leg,
      name,
      () => onLook({ place: route.place, from, to }),
      () => onLook(null),
      how,
    );
  };
  /** @param {FlownStage} stage */
  const stageRows = (stage) => {
    const legs = route.legs.filter(
      (leg) => leg.length_m >= 1 && leg.from_sequence >= stage.from_sequence && leg.to_sequence <= stage.to_sequence,
    );
    const words = several ? t("flight {number}", { number: stage.flight }) : "";
    if (legs.length < 2) return h("tbody", {}, row(stage, { words }));
    const rows = legs.map((leg) => row(leg, { isWithin: true }));
    /** @param {Event} event */
    const unfold = ({ currentTarget }) => {
      const button = /** @type {HTMLButtonElement} */ (currentTarget);
      const isOpen = button.getAttribute("aria-expanded") !== "true";
      button.setAttribute("aria-expanded", String(isOpen));
      for (const one of rows) one.hidden = !isOpen;
    };
    return h(
      "tbody",
      {},
      row(stage, {
        words: [words, t("{count} legs", { count: legs.length })].filter(Boolean).join(", "),
        button: { "aria-expanded": "false", onclick: unfold },
      }),
      rows,
    );
  };
  return h(
    "details",
    { class: "report-route" },
    h(
      "summary",
      {},
      icon("chevron-down", "small"),
      letter(route.place, colours),
      h("strong", {}, route.name),
      route.is_simulated && simulatedMark(),
      h("span", { class: "count" }, route.stages.length),
      route.photos > 0 && h("span", { class: "count" }, tn(route.photos, "{count} photo", "{count} photos")),
    ),
    h(
      "table",
      { class: "report-table report-legs" },
      h("caption", {}, t("RMS, and below it the greatest")),
      h(
        "thead",
        {},
        h(
          "tr",
          {},
          heads.map((words, index) => h("th", { scope: "col", class: index ? "number" : "" }, words)),
        ),
      ),
      route.stages.map(stageRows),
    ),
  );
}

/**
 * What happened to UAVs, by time.
 *
 * @param {readonly Incident[]} incidents
 * @param {(incident: Incident) => void} onPick
 */
export function drawIncidents(incidents, onPick) {
  const rows = incidents.map((incident) =>
    h(
      "li",
      { class: `report-alert ${INCIDENTS[incident.kind].level}` },
      icon(INCIDENTS[incident.kind].image, "small"),
      h(
        "span",
        {},
        h("strong", {}, capital(incident.message)),
        h(
          "small",
          {},
          h(
            "button",
            { type: "button", class: "text-button", title: exactText(incident.at), onclick: () => onPick(incident) },
            exactClockText(incident.at),
          ),
        ),
      ),
    ),
  );
  fold("incidents", rows.length, h("ul", { class: "report-list" }, rows));
}

/** @type {Record<Incident["kind"], { image: string, level: string }>} */
export const INCIDENTS = {
  crashed: { image: "octagon-alert", level: "critical" },
  down: { image: "octagon-alert", level: "critical" },
  "failsafe-return": { image: "house", level: "warning" },
  "failsafe-land": { image: "triangle-alert", level: "warning" },
  "told-return": { image: "house", level: "" },
  "told-land": { image: "circle-pause", level: "" },
  aborted: { image: "octagon-alert", level: "warning" },
  battery: { image: "triangle-alert", level: "critical" },
  "link-lost": { image: "triangle-alert", level: "critical" },
  alert: { image: "octagon-alert", level: "critical" },
};

/**
 * @param {readonly Alert[]} alerts
 * @param {(uav: number | null) => string} nameOf
 * @param {(iso: string) => void} onSeek the time of an alert was clicked
 */
export function drawAlerts(alerts, nameOf, onSeek) {
  const rows = [...alerts]
    .sort((a, b) => Date.parse(a.opened_at) - Date.parse(b.opened_at))
    .map((alert) => {
      const level = LEVELS[alert.level];
      const until = alert.closed_at ? t("until {time}", { time: exactClockText(alert.closed_at) }) : t("still open");
      const known =
        alert.acknowledged_at &&
        t("acknowledged by {who}", { who: alert.acknowledged_by ?? t("somebody who has left") });
      return h(
        "li",
        { class: `report-alert ${alert.level}` },
        icon(level.image, "small"),
        h(
          "span",
          {},
          h(
            "strong",
            {},
            h("span", { class: "unseen" }, `${level.words}: `),
            [nameOf(alert.uav), alert.message].filter(Boolean).join(": "),
          ),
          alert.is_simulated && [" ", simulatedMark()],
          h(
            "small",
            {},
            h(
              "button",
              {
                type: "button",
                class: "text-button",
                title: exactText(alert.opened_at),
                onclick: () => onSeek(alert.opened_at),
              },
              exactClockText(alert.opened_at),
            ),
            ` ${[until, known].filter(Boolean).join(", ")}`,
          ),
        ),
      );
    });
  fold("alerts", rows.length, h("ul", { class: "report-list" }, rows));
}

/** @param {readonly Command[]} commands */
export function drawCommands(commands) {
  const rows = [...commands]
    .sort((a, b) => Date.parse(a.created_at) - Date.parse(b.created_at))
    .map((command) => {
      const { words, image, level } = commandWords(command);
      const by = command.created_by ?? t("the program");
      return h(
        "li",
        { class: `report-command ${level ?? ""}` },
        icon(image, "small"),
        h(
          "span",
          {},
          h("strong", {}, `${command.uav.name}: ${words}`),
          command.uav.is_simulated && [" ", simulatedMark()],
          h("small", {}, [by, timesOf(command, exactClockText), command.why].filter(Boolean).join(" · ")),
        ),
      );
    });
  fold("commands", rows.length, h("ul", { class: "report-list" }, rows));
}

/** @param {MissionRecord} record @param {Labels} labels */
export function drawResults(record, labels) {
  const rows = record.results.map(({ place, uav_name, outcome, note, values, measured_at }) => {
    const target = labels.get(place)?.label ?? `${place + 1}`;
    const figures = Object.entries(values ?? {}).map(
      ([name, value]) => `${name} ${typeof value === "object" ? JSON.stringify(value) : value}`,
    );
    return h(
      "li",
      {},
      icon("clipboard-list", "small"),
      h(
        "span",
        {},
        h("strong", {}, `${target}: ${outcome}`),
        h("small", {}, [`${uav_name}, ${clockText(measured_at)}`, note, ...figures].filter(Boolean).join(" · ")),
      ),
    );
  });
  fold("results", rows.length, h("ul", { class: "report-list" }, rows));
}
