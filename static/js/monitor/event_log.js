/** The event log as text: who did what, from the server's records. Values in, values out. */

import { KINDS } from "../domain/flying.js";
import { t } from "../text.js";
import { numberText } from "../units.js";
import { reasonWords, STATES } from "./board.js";
import { causeWords } from "./text/offer_text.js";

/** @import { AlertLevel, CommandKind, MissionEvent, MissionEventKindEnum } from "../api_types.d.ts" */

/**
 * A line of the log.
 *
 * @typedef {object} LoggedEvent
 * @property {string} key
 * @property {string} at
 * @property {string} image name of an icon
 * @property {AlertLevel | null} level
 * @property {boolean} isSimulated
 * @property {string} words
 */

/** Values of an event, with its UAV, who did it and its mission, by name. @typedef {Record<string, any> & { name: string, who: string, mission: string }} Facts */
/** @typedef {[image: string, words: (facts: Facts) => string]} Shape */

/** @type {Record<AlertLevel, string>} */
const IMAGES = { critical: "octagon-alert", warning: "triangle-alert", advisory: "info" };

/** @param {string} words @param {string | undefined} why */
const because = (words, why) => (why ? `${words} – ${why}` : words);

/** @param {string} image @param {string} state @returns {Shape} */
const command = (image, state) => [
  image,
  ({ name, command_kind, outcome }) =>
    because(
      t("{name}: {act}, {state}", { name, act: KINDS[/** @type {CommandKind} */ (command_kind)], state }),
      outcome,
    ),
];

/** @param {"in-progress" | "complete" | "skipped" | "failed"} state @returns {Shape} */
const target = (state) => [
  STATES[state].image,
  ({ label, reason }) => [`${label}: ${STATES[state].words}`, reasonWords(reason)].filter(Boolean).join(", "),
];

/** @type {Record<string, (value: any) => string | false>} */
const FAULTS = {
  link_lost_for_s: (s) => s > 0 && t("link lost for {seconds} s of simulated time", { seconds: numberText(s) }),
  gps_lost_for_s: (s) => s > 0 && t("GPS lost for {seconds} s of simulated time", { seconds: numberText(s) }),
  battery_wh_left: (wh) => wh !== null && t("battery at {wh} Wh", { wh: numberText(wh) }),
  motor_failed: (motor) => motor !== null && t("motor {number} has failed", { number: motor + 1 }),
  stuck_item: (item) => item !== null && t("stuck at item {number} of its list", { number: item }),
  clock_offset_s: (s) => s !== 0 && s !== null && t("clock off by {seconds} s", { seconds: numberText(s) }),
};

/** "motor 1 has failed"; without faults: all is well again. @param {Record<string, unknown>} faults */
function faultWords(faults) {
  const wrong = Object.entries(faults).map(([name, value]) => FAULTS[name]?.(value));
  return wrong.filter(Boolean).join(", ") || t("faults cleared");
}

/** What of a simulation was changed. @param {Facts} facts */
const changeWords = ({ speed, conditions }) =>
  [speed !== undefined && t("speed {speed}×", { speed }), conditions !== undefined && t("wind")]
    .filter(Boolean)
    .join(", ");

/** @param {Facts} facts */
function endWords({ mission, state }) {
  if (state === "completed") return t("“{name}” has ended: completed", { name: mission });
  if (state === "failed") return t("“{name}” has ended: a flight failed", { name: mission });
  return t("“{name}” has ended: another mission continues it", { name: mission });
}

/** @type {Record<MissionEventKindEnum, Shape>} */
const SHAPES = {
  "mission-approved": ["badge-check", ({ mission, who }) => t("“{name}” approved by {who}", { name: mission, who })],
  "approval-revoked": [
    "undo-2",
    ({ mission, who, why }) => because(t("Approval of “{name}” revoked by {who}", { name: mission, who }), why),
  ],
  "mission-started": ["plane-takeoff", ({ mission }) => t("“{name}” has begun", { name: mission })],
  "mission-aborted": [
    "octagon-alert",
    ({ mission, who, why }) => because(t("“{name}” aborted by {who}", { name: mission, who }), why),
  ],
  "mission-closed": ["clipboard-list", ({ mission, who }) => t("“{name}” closed by {who}", { name: mission, who })],
  "mission-ended": ["plane-landing", endWords],
  "starts-begun": ["list-checks", ({ who }) => t("Starts in planned order begun by {who}", { who })],
  "starts-stopped": ["circle-pause", ({ who }) => t("Starts in planned order stopped by {who}", { who })],
  "take-off": ["plane-takeoff", ({ name }) => t("{name} took off", { name })],
  landing: ["plane-landing", ({ name }) => t("{name} landed", { name })],
  crash: ["octagon-alert", ({ name, text }) => because(t("{name} has crashed", { name }), text)],
  "drop-out": ["triangle-alert", ({ name }) => t("{name} has dropped out", { name })],
  "command-given": [
    "send",
    ({ name, command_kind, who, why }) => {
      const act = KINDS[/** @type {CommandKind} */ (command_kind)];
      return because(t("{name}: {act}, given by {who}", { name, act, who }), why);
    },
  ],
  "command-sent": command("send", t("sent")),
  "command-acknowledged": command("check", t("acknowledged")),
  "command-done": command("circle-check", t("done")),
  "command-failed": command("circle-x", t("failed")),
  "command-expired": command("circle-x", t("expired")),
  "alert-opened": ["info", ({ message }) => message],
  "alert-raised": [
    "info",
    ({ message, level }) =>
      level === "critical" ? t("Critical now: {message}", { message }) : t("Warning now: {message}", { message }),
  ],
  "alert-acknowledged": ["check", ({ message, who }) => t("Acknowledged by {who}: {message}", { who, message })],
  "alert-resolved": [
    "circle-check",
    ({ message, who, reason, code, name }) => {
      if (reason === "by-person") return t("Closed by {who}: {message}", { who, message });
      return code === "link-lost"
        ? t("Resolved: link to {name} restored.", { name })
        : t("Resolved: {message}", { message });
    },
  ],
  "target-started": target("in-progress"),
  "target-complete": target("complete"),
  "target-skipped": target("skipped"),
  "target-failed": target("failed"),
  "offer-made": [
    "replace",
    ({ code, name }) => t("Re-plan: {why}", { why: because(causeWords({ code, cause: {} }), name) }),
  ],
  "offer-accepted": ["circle-check", ({ who }) => t("Re-plan accepted by {who}", { who })],
  "offer-declined": ["circle-x", ({ who }) => t("Re-plan declined by {who}", { who })],
  "offer-expired": ["timer", () => t("Re-plan expired")],
  "offer-impossible": ["circle-x", () => t("No re-plan possible.")],
  "simulation-started": ["play", ({ who }) => t("Simulated UAVs started by {who}", { who })],
  "simulation-changed": [
    "gauge",
    ({ name, who, ...facts }) =>
      t("{name}: {what}, set by {who}", { name, what: changeWords({ name, who, ...facts }), who }),
  ],
  "simulation-ended": ["x", ({ message }) => t("The simulation is over: {why}", { why: message })],
  "fault-injected": [
    "wrench",
    ({ name, who, faults }) => t("{name}: {what}, injected by {who}", { name, what: faultWords(faults), who }),
  ],
};

/**
 * @param {MissionEvent} event
 * @param {Map<string, string>} missions their names
 * @returns {LoggedEvent}
 */
export function lineOf({ key, at, kind, mission, uav, who, level, is_simulated, values }, missions) {
  const [image, words] = SHAPES[kind];
  const isOfSimulation = kind === "fault-injected" || kind === "simulation-changed";
  const facts = {
    ...values,
    level,
    name: uav?.name ?? (isOfSimulation ? t("All UAVs") : ""),
    who: who ?? t("somebody who has left"),
    mission: missions.get(mission) ?? "",
  };
  const isAlert = kind === "alert-opened" || kind === "alert-raised";
  const shown = /** @type {AlertLevel | null} */ (level);
  return {
    key,
    at,
    image: isAlert && shown ? IMAGES[shown] : image,
    level: shown,
    isSimulated: is_simulated,
    words: words(facts),
  };
}

/**
 * The known events merged with a page that was read again; the newest first.
 *
 * @param {MissionEvent[]} known
 * @param {MissionEvent[]} read
 */
export function merged(known, read) {
  const all = new Map([...known, ...read].map((event) => [event.key, event]));
  return [...all.values()].sort((a, b) => Date.parse(b.at) - Date.parse(a.at) || (a.key < b.key ? 1 : -1));
}
