/** The side panel: the result of the mission in a sentence, in figures, and for each target. */

import { byId, find, h, icon } from "../dom.js";
import { colourClass } from "../domain/palette.js";
import { MISSION_STATES } from "../domain/planned_state.js";
import {
  capital,
  factsOf,
  figuresOf,
  hasOwnClock,
  isUnderWay,
  qualityOf,
  reasonsOf,
  sentenceOf,
  wasFlown,
} from "../record/sentence.js";
import { t, tn } from "../text.js";
import { clockText, dateText, durationText, exactText, lengthText } from "../units.js";

/** @import { MissionRecord, RecordMission, RecordTarget } from "../api_types.d.ts" */
/** @import { Labels } from "../record/labels.js" */

/** @typedef {(target: number) => void} OnLook the target's pill was clicked */

const HASH_LETTERS = 8;
const MAX_NAMED = 4; // targets in a sentence
/** @type {Record<RecordTarget["result"], { words: string, image: string }>} */
const RESULTS = {
  inspected: { words: t("Inspected"), image: "circle-check" },
  "not-confirmed": { words: t("Complete, not confirmed"), image: "circle-dashed" },
  "not-inspected": { words: t("Not inspected"), image: "circle-x" },
  open: { words: t("Open"), image: "circle-dashed" },
};

/** @param {RecordMission} mission */
function whenWords({ started_at, ended_at, departs_at }) {
  const from = started_at ?? departs_at;
  if (!from) return "";
  if (!ended_at) return `${dateText(from)}, ${clockText(from)}`;
  return t("{day}, {from} to {to}", { day: dateText(from), from: clockText(from), to: clockText(ended_at) });
}

/**
 * The head: name, state, time, user, the plan's hash; the sentence with its reasons, and the figures once something was flown.
 *
 * @param {MissionRecord} record
 * @param {OnLook} onLook
 */
export function drawHead(record, onLook) {
  const { mission } = record;
  const chip = byId("report-state");
  chip.hidden = false;
  chip.className = `chip ${mission.state}`;
  chip.replaceChildren(
    ...(mission.state === "completed" ? [icon("check", "small")] : []),
    MISSION_STATES[mission.state],
  );
  const { approval } = mission;
  const facts = [
    whenWords(mission),
    approval?.approved_by,
    approval?.failed_rehearsal_reason &&
      t("approved without a passed rehearsal: {why}", { why: approval.failed_rehearsal_reason }),
    approval && t("plan hash {hash}", { hash: approval.content_sha256.slice(0, HASH_LETTERS) }),
  ];
  byId("report-facts").textContent = facts.filter(Boolean).join(" · ");
  const sentence = sentenceOf(record);
  if (byId("report-sentence").textContent !== sentence) byId("report-sentence").textContent = sentence;
  const reasons = reasonsOf(record);
  byId("report-reasons").hidden = !reasons.length;
  byId("report-reasons").replaceChildren(...reasons.map((reason) => reasonLine(reason, onLook)));
  byId("report-said").textContent = factsOf(record);
  const others = [
    [mission.continues, t("Flies the rest of an earlier mission: its report")],
    [mission.continued_by, t("Its rest is flown by another mission: that one's report")],
  ].filter(([id]) => id);
  const continues = byId("report-continues");
  continues.hidden = !others.length;
  continues.replaceChildren(
    ...others.map(([id, words]) =>
      h("a", { class: "report-link", href: `/missions/${id}/report` }, icon("link", "small"), words),
    ),
  );
  const table = byId("report-figures", HTMLTableElement);
  table.hidden = !record.routes.length;
  table.tBodies[0].replaceChildren(...figuresOf(record).map(figureRow));
}

/** @param {ReturnType<typeof figuresOf>[number]} figure */
const figureRow = ({ words, planned, flown, more }) =>
  h(
    "tr",
    {},
    h("th", { scope: "row" }, words),
    h("td", { class: "number quiet-text" }, planned),
    h("td", { class: "number flown" }, flown),
    h("td", { class: "number quiet-text" }, more),
  );

/** A sentence; a click shows its targets on the map. @param {ReturnType<typeof reasonsOf>[number]} reason @param {OnLook} onLook */
function reasonLine({ targets, words }, onLook) {
  const [before, after = ""] = words.split("{targets}");
  const named = targets.slice(0, MAX_NAMED).map(({ place, label }, index) => [
    index ? ", " : "",
    h(
      "button",
      {
        type: "button",
        class: "text-button",
        title: t("Show {target} on the map", { target: label }),
        onclick: () => onLook(place),
      },
      label,
    ),
  ]);
  const rest = targets.length - named.length;
  return h("li", {}, before, named, rest > 0 && ` ${tn(rest, "and {count} more", "and {count} more")}`, after);
}

/** How well tracks and estimates were: figures for those who judge the data. @param {MissionRecord} record */
export function drawQuality(record) {
  const part = byId("report-quality");
  part.hidden = !wasFlown(record);
  find(part, ".report-part-body").replaceChildren(
    h(
      "table",
      { class: "report-table report-quality" },
      h("caption", {}, t("Tracks against routes, and estimates against what was measured")),
      h("tbody", {}, qualityOf(record).map(figureRow)),
    ),
  );
}

/** @param {MissionRecord} record @param {Labels} labels @param {OnLook} onLook */
export function drawTargets(record, labels, onLook) {
  const targets = [...record.targets].sort((a, b) => a.flown_place - b.flown_place);
  const missed = targets.filter(({ result }) => result === "not-inspected");
  const section = byId("report-missed");
  section.hidden = missed.length === 0;
  find(section, ".count").textContent = `${missed.length}`;
  find(section, ".report-list").replaceChildren(...missed.map((target) => missedRow(target, labels, onLook)));
  const isClose = wasFlown(record) || isUnderWay(record);
  fold("targets", targets.length, targetTable(targets, labels, onLook, { isClose, hasOwnClock: hasOwnClock(record) }));
}

/** @param {RecordTarget} target @param {Labels} labels @param {OnLook} onLook */
function pill(target, labels, onLook) {
  const known = labels.get(target.place);
  if (!known) return h("span", { class: "pill" }, `${target.place + 1}`);
  return h(
    "button",
    {
      type: "button",
      class: `report-pill ${target.uav === null ? "" : colourClass(known.colour)} ${target.state}`,
      "aria-label": t("Show target {label}", { label: known.label }),
      onclick: () => onLook(target.place),
    },
    h("span", { class: "pill" }, known.label),
  );
}

/** @param {RecordTarget} target @param {Labels} labels @param {OnLook} onLook */
function missedRow(target, labels, onLook) {
  const { reason } = target;
  return h(
    "li",
    {},
    pill(target, labels, onLook),
    h(
      "span",
      {},
      h("strong", {}, target.label),
      h(
        "small",
        {},
        reason && capital(reason.message),
        reason?.at && h("time", { datetime: reason.at, title: exactText(reason.at) }, ` ${clockText(reason.at)}`),
      ),
    ),
  );
}

/** @param {string | null} iso */
const time = (iso) => (iso ? h("time", { datetime: iso, title: exactText(iso) }, clockText(iso)) : "—");
/** @param {number | null} value */
const seconds = (value) =>
  value === null ? "—" : value < 100 ? t("{count} s", { count: Math.round(value) }) : durationText(value);

/** Minutes and seconds after take-off. @param {number | null} seconds_s */
const after = (seconds_s) =>
  seconds_s === null
    ? "—"
    : `+${Math.floor(seconds_s / 60)}:${String(Math.floor(Math.max(seconds_s, 0) % 60)).padStart(2, "0")}`;

/**
 * Table of targets in flown order. hasOwnClock: simulated faster than real time, with times after take-off.
 *
 * @param {readonly RecordTarget[]} targets
 * @param {Labels} labels
 * @param {OnLook} onLook
 * @param {{ isClose: boolean, hasOwnClock: boolean }} how isClose: whether there are details of the flight
 */
function targetTable(targets, labels, onLook, { isClose, hasOwnClock: isOwn }) {
  const head = [t("Target"), t("Planned"), t("Reached"), t("Closest"), t("Held")];
  const rows = targets.map((target) => {
    const state = RESULTS[target.result];
    return [
      h(
        "tr",
        { class: "report-named" },
        h("td", { rowspan: isClose ? 2 : 1 }, pill(target, labels, onLook)),
        h(
          "th",
          { scope: "row", colspan: 4 },
          h(
            "div",
            {},
            h("span", { class: "report-name" }, target.label),
            h("span", { class: `report-target-state ${target.result}` }, icon(state.image, "small"), state.words),
          ),
        ),
      ),
      isClose &&
        h(
          "tr",
          {},
          h("td", { class: "number" }, isOwn ? after(target.planned_after_s) : time(target.planned_at)),
          h("td", { class: "number" }, isOwn ? after(target.reached_after_s) : time(target.reached_at)),
          h("td", { class: "number" }, target.closest_m === null ? "—" : lengthText(target.closest_m)),
          h("td", { class: "number" }, seconds(target.held_s)),
        ),
    ];
  });
  return h(
    "table",
    { class: "report-table report-targets" },
    isOwn && h("caption", {}, t("Times after take-off, in simulated time")),
    h(
      "thead",
      {},
      h(
        "tr",
        {},
        head.map((words, index) => h("th", { scope: "col", class: index ? "number" : "" }, words)),
      ),
    ),
    h("tbody", {}, rows),
  );
}

/**
 * Fills a part of the side that can be unfolded; without content it is not there.
 *
 * @param {string} name
 * @param {number} count
 * @param {Node} content
 */
export function fold(name, count, content) {
  const part = byId(`report-${name}`);
  part.hidden = count === 0;
  find(part, ".count").textContent = `${count}`;
  find(part, ".report-part-body").replaceChildren(content);
}
