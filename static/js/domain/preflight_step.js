/** Before start: the state of each UAV, and the next act. Values in, values out. */

import { t, tn } from "../text.js";

/** @import { Preflight, PreflightCheck, UavPreflight } from "../api_types.d.ts" */

/** Whether simulated UAVs replace the mission's: null where they cannot. @typedef {"off" | "starting" | "running" | null} Stand */
/**
 * The button: its text, whether it can be pressed (`why` is then empty), and what it leaves undone.
 *
 * @typedef {object} NextStep
 * @property {Preflight["next_act"] | "simulate"} act
 * @property {string} words
 * @property {string} image name of an icon
 * @property {string} why it cannot be pressed
 * @property {string[]} left the reason of each UAV that is not started with the others
 * @property {number[]} uavs ids of those that it is about
 */

/** @type {PreflightCheck["state"][]} */
const WORST_FIRST = ["failed", "waiting", "warning", "unknown", "ok"];

/** @param {Pick<PreflightCheck, "state">[]} checks */
export const worstOf = (checks) => WORST_FIRST.find((state) => checks.some((check) => check.state === state)) ?? "ok";

/** @type {Record<string, string>} */
const CHECK_NAMES = {
  crash: t("crash"),
  link: t("link"),
  position: t("position"),
  home: t("home position"),
  battery: t("battery"),
  mission: t("mission on board"),
  fence: t("fence"),
  return: t("return path"),
  camera: t("camera"),
  wind: t("wind"),
  others: t("other UAVs"),
  departure: t("departure"),
  ground: t("zones and ground"),
};

/** Each once. @param {Pick<PreflightCheck, "code">[]} checks */
const namesOfChecks = (checks) => [...new Set(checks.map(({ code }) => CHECK_NAMES[code] ?? code))].join(", ");

/** One line on a UAV: its worst check, or that it is ready. @param {Pick<UavPreflight, "checks">} row */
export function summaryOf({ checks }) {
  const worst = worstOf(checks);
  const worstChecks = checks.filter(({ state }) => state === worst);
  if (worst === "ok") return t("Ready");
  if (worst === "failed" || worst === "waiting") return worstChecks[0].message;
  const names = namesOfChecks(worstChecks.filter(({ code }) => code !== "mission")); // that it was not uploaded is known
  if (!names) return worstChecks[0].message;
  return worst === "warning" ? t("Warning: {names}", { names }) : t("Not known: {names}", { names });
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

/** @param {UavPreflight} row */
const isConnected = ({ checks }) => checks.every(({ code, state }) => code !== "link" || state === "ok");

/** Whether all UAVs without the mission can receive it now. @param {Preflight} preflight */
export const canUploadToAll = ({ next_act, uavs }) =>
  next_act === "upload" && uavs.every((row) => row.is_loaded || isConnected(row));

/** Before the first answer. @returns {NextStep} */
export const firstStep = () => ({
  act: null,
  words: t("Checking …"),
  image: "timer",
  why: t("Link, position, battery and mission of each UAV are being checked."),
  left: [],
  uavs: [],
});

/**
 * @param {Preflight} preflight
 * @param {boolean} isPilotDone the pilot has confirmed the visual checks
 * @param {Stand} [stand]
 * @returns {NextStep | null} null where nothing is left to start
 */
export function nextStep(preflight, isPilotDone, stand = null) {
  const { next_act, uavs, checks } = preflight;
  const against = checks.find(({ state }) => state === "failed");
  const waiting = uavs.filter(({ is_loaded }) => !is_loaded);
  const step = { act: next_act, why: "", left: [], uavs: waiting.map(({ uav }) => uav) };
  const isStarting = stand === "starting" && (next_act === "connect" || next_act === "upload");
  if (isStarting || (stand === "running" && next_act === "connect")) return startingStep(waiting);
  switch (next_act) {
    case "connect":
      if (stand === "off")
        return { ...step, act: "simulate", words: t("Fly in simulation"), image: "play", why: against?.message ?? "" };
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

/** Simulated UAVs connect by themselves. @param {UavPreflight[]} waiting for the mission @returns {NextStep} */
function startingStep(waiting) {
  const unacknowledged = waiting.filter((row) => !isConnected(row));
  return {
    act: "connect",
    words: t("Starting simulated UAVs …"),
    image: "radio",
    why: unacknowledged.length
      ? t("They connect by themselves. Waiting for: {names}.", { names: namesOf(unacknowledged) })
      : t("All are connected. The mission is uploaded next."),
    left: [],
    uavs: waiting.map(({ uav }) => uav),
  };
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
