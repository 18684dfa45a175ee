/** Before start: what is said of each UAV, and which act comes next. Values in, values out. */

import { t, tn } from "../text.js";

/** @import { Preflight, PreflightCheck, UavPreflight } from "../api_types.d.ts" */

/**
 * The button: what it says, whether it can be pressed (`why` is then empty), and what it leaves undone.
 *
 * @typedef {object} NextStep
 * @property {Preflight["next_act"]} act
 * @property {string} words
 * @property {string} image name of an icon
 * @property {string} why it cannot be pressed
 * @property {string[]} left of each UAV that is not started with the others, why
 * @property {number[]} uavs ids of those that it is about
 */

/** @type {PreflightCheck["state"][]} */
const WORST_FIRST = ["failed", "waiting", "warning", "unknown", "ok"];

/** @param {Pick<PreflightCheck, "state">[]} checks */
export const worstOf = (checks) => WORST_FIRST.find((state) => checks.some((check) => check.state === state)) ?? "ok";

/** What is said of a UAV in one line: its worst check, or that it is ready. @param {Pick<UavPreflight, "checks">} row */
export function summaryOf({ checks }) {
  const worst = worstOf(checks);
  const said = checks.filter(({ state }) => state === worst);
  if (worst === "ok") return t("Ready");
  if (worst === "failed" || worst === "waiting") return said[0].message;
  return worst === "warning"
    ? tn(said.length, "{count} warning", "{count} warnings")
    : tn(said.length, "{count} check not known", "{count} checks not known");
}

/** Why a UAV is not started with the others. @param {UavPreflight} row */
function whyLeft({ name, is_loaded, checks }) {
  const failed = checks.find(({ state }) => state === "failed");
  if (failed?.code === "link") return t("{name} is not connected", { name });
  if (failed) return t("{name}: {why}", { name, why: failed.message });
  return is_loaded ? t("{name} is not ready", { name }) : t("{name} does not have the mission", { name });
}

/** @param {UavPreflight[]} rows */
const namesOf = (rows) => rows.map(({ name }) => name).join(", ");

/**
 * @param {Preflight} preflight
 * @param {boolean} isPilotDone what only a pilot can see was looked at
 * @returns {NextStep | null} null where nothing is left to start
 */
export function nextStep(preflight, isPilotDone) {
  const { next_act, uavs, checks } = preflight;
  const against = checks.find(({ state }) => state === "failed");
  const waiting = uavs.filter(({ is_loaded }) => !is_loaded);
  const step = { act: next_act, why: "", left: [], uavs: waiting.map(({ uav }) => uav) };
  switch (next_act) {
    case "connect":
      return {
        ...step,
        words: tn(waiting.length, "Connect {count} UAV", "Connect {count} UAVs"),
        image: "radio",
        why: t("Not connected: {names}. Switch them on; this page detects them.", { names: namesOf(waiting) }),
      };
    case "upload":
      return {
        ...step,
        words: tn(waiting.length, "Upload to {count} UAV", "Upload to {count} UAVs"),
        image: "send",
        why: against?.message ?? "",
      };
    case "wait":
      return {
        ...step,
        words: t("Uploading …"),
        image: "send",
        why: t("The upload to each UAV is verified."),
      };
    case "start":
      return startStep(preflight, isPilotDone);
    default:
      return null;
  }
}

/** Those that are ready are started; the others are named. @param {Preflight} preflight @param {boolean} isPilotDone @returns {NextStep} */
function startStep({ checks, uavs }, isPilotDone) {
  const ready = uavs.filter(({ is_ready }) => is_ready);
  const left = uavs.filter(({ is_ready }) => !is_ready);
  const against = checks.find(({ state }) => state === "failed");
  const ticked = isPilotDone ? "" : t("Tick what was looked at on site.");
  const [started, all] = [ready.length, uavs.length];
  return {
    act: "start",
    words:
      started && left.length
        ? tn(all, "Start {started} of {count} UAV", "Start {started} of {count} UAVs", { started })
        : tn(all, "Start {count} UAV", "Start {count} UAVs"),
    image: "plane-takeoff",
    why: against ? against.message : started ? ticked : t("Blocked: {names}", { names: namesOf(left) }),
    left: started ? left.map(whyLeft) : [],
    uavs: ready.map(({ uav }) => uav),
  };
}
