/** Starts in planned order, which the server carries out: a countdown for each UAV and Stop, on every page that shows the mission. */

import { ApiError, freshKey, get, post, remove } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { t, tn } from "../text.js";
import { countdownText } from "../units.js";
import { confirmAct } from "./confirm.js";
import { toast } from "./toast.js";

/** @import { Answer } from "../api.js" */
/** @import { PlannedStart, PlannedStarts, PlannedStartsList, MissionStarts, WaitingStart } from "../api_types.d.ts" */

/**
 * @typedef {object} StartsContext
 * @property {string | null} mission the only one of the page; null: all
 * @property {boolean} canFly
 */

export const PILOT_CHECK = t(
  "Looked at on site: propellers and battery, take-off place, airspace and weather, radio at hand",
);
const POLL_MS = 2000;
const TICK_MS = 500;
const SHOWN_AFTER_MS = 300_000; // as the server lists them
const DONE_SHOWN_AFTER_MS = 30_000; // where no act is possible

/** @type {Record<string, string>} */
const ENDS = {
  done: t("All starts were given."),
  stopped: t("Stopped. No further UAV is started."),
  commanded: t("Stopped: a UAV of the mission was commanded to hold, return, land or abort."),
  "mission-over": t("Stopped: the mission is over."),
  interrupted: t("Stopped: the server could not look after it for a minute."),
};

/** Those that go on, or ended a moment ago. @param {PlannedStarts} starts @param {number} now_ms */
export const isShown = ({ ended_at, end, uavs }, now_ms) =>
  !ended_at ||
  now_ms - Date.parse(ended_at) <
    (end === "done" && uavs.every(({ state }) => state === "started") ? DONE_SHOWN_AFTER_MS : SHOWN_AFTER_MS);

/** The text on one UAV's start. @param {PlannedStart} start @param {boolean} goesOn @param {number} now_ms */
export function startWords({ state, due_at, why }, goesOn, now_ms) {
  if (state === "started") return t("Start given");
  if (state === "refused") return t("Not started: {why}", { why });
  if (!goesOn) return t("Not started");
  const left_ms = Date.parse(due_at) - now_ms;
  if (left_ms > 0) return t("in {time}", { time: countdownText(left_ms) });
  return why ? t("Waits: {why}", { why }) : t("now");
}

/** By their plan, the first one at once: lines of the question. @param {Pick<WaitingStart, "name" | "after_s">[]} waiting */
export const orderLines = (waiting) =>
  waiting.map(({ name, after_s }, place) =>
    place === 0
      ? t("{name}: in 10 s", { name })
      : t("{name}: {time} after the first", {
          name,
          time: countdownText((after_s - waiting[0].after_s) * 1000),
        }),
  );

/** @param {() => Promise<unknown>} act @param {string} failed */
async function tried(act, failed) {
  try {
    await act();
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    toast(`${failed} ${error.message}`);
  }
}

/**
 * Ask for confirmation, and start them through the server; the pilot's visual checks were confirmed, or are with `checked`.
 *
 * @param {string} mission
 * @param {WaitingStart[]} waiting those that are to be started
 * @param {HTMLElement} opener
 * @param {{ left: string[], checked?: string[] | null }} how left: the reason of each UAV that is not started with them;
 *   checked: lines on its checks, where the question is the place of the pilot's own
 */
export async function beginStarts(mission, waiting, opener, { left, checked = null }) {
  const asked = await confirmAct({
    title: tn(waiting.length, "Start {count} UAV in planned order?", "Start {count} UAVs in planned order?"),
    lines: [
      ...orderLines(waiting),
      ...(checked ?? []),
      left.length > 0 && t("Not started: {names}.", { names: left.join("; ") }),
      t(
        "Each start is checked against the UAVs in the air and waits where it has to. Closing this page stops nothing.",
      ),
      t("Stop, or any Hold, Return, Land or Abort of this mission ends it: no further UAV is started."),
    ],
    checks: checked ? [{ name: "pilot_checked", words: PILOT_CHECK, isNeeded: true }] : [],
    act: t("Start in planned order"),
    image: "plane-takeoff",
    opener,
  });
  const headers = { "Idempotency-Key": freshKey() };
  const body = { uavs: waiting.map(({ uav }) => uav), pilot_checked: true };
  if (asked) await tried(() => post(`/missions/${mission}/planned-starts`, body, { headers }), t("Not started."));
}

/** @param {PlannedStarts} starts */
const stop = ({ mission }) => tried(() => remove(`/missions/${mission}/planned-starts`), t("Not stopped."));

/** @param {string} act @param {string} image @param {string} words @param {(button: HTMLElement) => unknown} does */
const actButton = (act, image, words, does) =>
  h(
    "button",
    {
      type: "button",
      class: "button",
      "data-act": act,
      /** @param {Event} event */
      onclick: ({ currentTarget }) => void does(/** @type {HTMLElement} */ (currentTarget)),
    },
    icon(image, "small"),
    words,
  );

/** @param {PlannedStarts} starts @param {{ now_ms: number, isNamed: boolean }} how */
const startsPart = ({ ended_at, ended_by, end, mission_name, uavs }, { now_ms, isNamed }) => [
  h("h3", {}, isNamed ? `${mission_name}: ` : "", t("Start in planned order")),
  h(
    "ol",
    {},
    uavs.map((start) =>
      h("li", { class: start.state }, h("strong", {}, start.name), ` ${startWords(start, !ended_at, now_ms)}`),
    ),
  ),
  h("p", { class: "caption", hidden: !end }, end && ENDS[end], ended_by && ` (${ended_by})`),
];

/** @param {StartsContext} context */
export function mountPlannedStarts({ mission, canFly }) {
  const place = byId("planned-starts");
  /** @type {PlannedStarts[]} */
  let shown = [];
  let ahead_ms = 0; // the server's clock before this one
  let drawn = "";

  async function readMission() {
    const { data } = /** @type {Answer<MissionStarts>} */ (await get(`/missions/${mission}/planned-starts`));
    const newest = data.starts;
    shown = newest && isShown(newest, Date.parse(data.server_time)) ? [newest] : [];
    return data.server_time;
  }

  async function readAll() {
    const { data } = /** @type {Answer<PlannedStartsList>} */ (await get("/planned-starts"));
    shown = data.results;
    return data.server_time;
  }

  async function read() {
    try {
      ahead_ms = Date.parse(await (mission === null ? readAll() : readMission())) - Date.now();
      draw();
    } catch (error) {
      if (!(error instanceof ApiError)) throw error; // the page itself reports that the server is unavailable
    }
  }

  function draw() {
    const now_ms = Date.now() + ahead_ms;
    place.hidden = shown.length === 0;
    const words = shown.flatMap((starts) => starts.uavs.map((start) => startWords(start, !starts.ended_at, now_ms)));
    const key = JSON.stringify([words, shown.map(({ id, end }) => [id, end])]);
    if (key === drawn) return;
    const hadFocus = place.contains(document.activeElement);
    drawn = key;
    place.replaceChildren(...shown.flatMap((starts) => partOf(starts, now_ms)));
    if (hadFocus) place.querySelector("button")?.focus({ preventScroll: true });
  }

  /** @param {PlannedStarts} starts @param {number} now_ms */
  const partOf = (starts, now_ms) => [
    ...startsPart(starts, { now_ms, isNamed: mission === null }),
    ...(canFly && !starts.ended_at
      ? [actButton("stop", "octagon-alert", t("Stop starting"), () => stop(starts).then(read))]
      : []),
  ];

  void read();
  setInterval(() => !document.hidden && void read(), POLL_MS);
  setInterval(() => !document.hidden && draw(), TICK_MS);
}
