/** A mission in progress: commands of its UAVs, their outcomes, and possible next acts. Values in, values out. */

import { t } from "../text.js";
import { agoText, clockText, exactClockText } from "../units.js";
import { routeLetter } from "./palette.js";

/** @import { Command, CommandKind, CommandState, Mission, MissionState, UavConnection } from "../api_types.d.ts" */

/** @typedef {ReturnType<typeof flyersOf>[number]} Flyer */
/** @typedef {{ words: string, image: string, level?: string | null }} StatusText */

/** @type {Record<CommandKind, string>} */
export const KINDS = {
  "upload-mission": t("Upload mission"),
  "clear-mission": t("Remove mission"),
  arm: t("Arm"),
  "take-off": t("Take off"),
  start: t("Start"),
  pause: t("Hold"), // as older clients of the API still ask for it
  resume: t("Resume"),
  hold: t("Hold"),
  return: t("Return"),
  land: t("Land here"),
  abort: t("Abort"),
  "change-speed": t("Change speed"),
  "set-return-height": t("Set return height"),
};

/** @type {Record<CommandState, { words: string, image: string }>} */
const STATES = {
  queued: { words: t("waiting"), image: "timer" },
  sent: { words: t("sent"), image: "send" },
  acknowledged: { words: t("acknowledged"), image: "check" },
  applied: { words: t("done"), image: "circle-check" },
  failed: { words: t("failed"), image: "circle-x" },
  expired: { words: t("expired"), image: "circle-dashed" },
};

const ON_ITS_WAY = ["dispatched", "active"];

/** @param {{ state: MissionState }} mission */
export const isFrozen = (mission) => !["draft", "planned"].includes(mission.state);
/** @param {{ state: MissionState }} mission */
export const isOnItsWay = (mission) => ON_ITS_WAY.includes(mission.state);
/** Whether a mission is approved and not over. @param {{ state: MissionState }} mission */
export const isFlown = ({ state }) => state === "approved" || ON_ITS_WAY.includes(state);
/** @param {{ state: CommandState }} command */
export const isOpen = ({ state }) => ["queued", "sent", "acknowledged"].includes(state);
/** @param {{ kind: CommandKind }} command */
const isOfMission = ({ kind }) => kind === "upload-mission" || kind === "clear-mission";

/**
 * UAVs that fly a route, in the order of the mission: [{ place, letter, name, uav, flights, flown, hasFailed }].
 *
 * @param {Pick<Mission, "approval" | "plan">} mission
 */
export function flyersOf(mission) {
  const flights = new Map((mission.approval?.flights ?? []).map((entry) => [entry.uav, entry]));
  return (mission.plan?.routes ?? [])
    .map((route, place) => ({
      place,
      letter: routeLetter(place),
      name: route.uav,
      uav: route.uav_id,
      flights: flights.get(place)?.flights ?? 1,
      flown: flights.get(place)?.flown ?? 0,
      hasFailed: flights.get(place)?.has_failed ?? false,
      route,
    }))
    .filter(({ route }) => route.geometry);
}

/**
 * The last word about what the UAV is to have on board; `commands` the newest first.
 *
 * @param {readonly Command[]} commands
 * @param {number | null} uav
 */
export function boardOf(commands, uav) {
  return commands.find((command) => command.uav.id === uav && isOfMission(command)) ?? null;
}

/** The last word about how it flies. @param {readonly Command[]} commands @param {number | null} uav */
export function flightOf(commands, uav) {
  return commands.find((command) => command.uav.id === uav && !isOfMission(command)) ?? null;
}

/** Whether a UAV holds a mix of missions, which no one has approved: shown with the highest level. @param {Command} command */
export const isMixed = ({ state, outcome_code }) => state === "failed" && outcome_code.includes("mix");

/** @type {Record<string, string>} */
const DOUBTS = {
  rebooted: t("it has booted since"),
  "other-station": t("another ground station has changed its lists since"),
  "other-length": t("its list has another length since"),
};

/**
 * Whether the last readback equals the upload; `connection` is null while that is unknown here.
 *
 * @param {Command} command
 * @param {UavConnection | null} connection
 */
const isSeenThere = ({ approval, finished_at }, connection) =>
  !connection ||
  Date.parse(connection.server_time) < Date.parse(finished_at ?? "") ||
  connection.loaded_approval === approval;

/**
 * "read back 3 min ago", and the reason to doubt it: { words, isDoubted }.
 *
 * @param {UavConnection & { loaded_read_at: string }} connection
 */
function readBack({ loaded_read_at, loaded_doubt, server_time }) {
  const ago = agoText((Date.parse(server_time) - Date.parse(loaded_read_at)) / 1000, loaded_read_at);
  return loaded_doubt
    ? { words: t("verified {ago}; uncertain now: {why}", { ago, why: DOUBTS[loaded_doubt] }), isDoubted: true }
    : { words: t("verified {ago}", { ago }), isDoubted: false };
}

/**
 * The onboard list as text: { words, image, level, share }. share: 0 to 1 of a running upload.
 *
 * @param {Command | null | undefined} command undefined: not read yet
 * @param {UavConnection | null} [connection]
 * @returns {StatusText & { share?: number }}
 */
export function boardWords(command, connection = null) {
  if (command === undefined) return { words: t("Reading the mission on the UAV…"), image: "loader-circle" };
  if (!command) return { words: t("Not uploaded yet"), image: "circle-dashed" };
  const { kind, state, progress, outcome, parameters } = command;
  const why = outcome || STATES[state].words;
  if (kind === "clear-mission") {
    if (state === "applied") return { words: t("Removed from the UAV"), image: "circle-check" };
    if (isOpen(command)) return { words: t("Being removed from the UAV"), image: "loader-circle" };
    return { words: t("Still on the UAV: {why}", { why }), image: "octagon-alert", level: "critical" };
  }
  if (isMixed(command))
    return { words: t("Mixed mission on the UAV – {why}", { why }), image: "octagon-alert", level: "critical" };
  if (state === "applied") {
    const flight = parameters.flight ?? 1;
    const what = flight > 1 ? t("Flight {flight} uploaded", { flight }) : t("Uploaded");
    if (!isSeenThere(command, connection))
      return {
        words: t("Mission on the UAV unknown: upload it again."),
        image: "triangle-alert",
        level: "warning",
      };
    const { loaded_read_at } = connection ?? {};
    const read = connection && loaded_read_at ? readBack({ ...connection, loaded_read_at }) : null;
    const words = read ? t("{what}, {read}", { what, read: read.words }) : what;
    if (read?.isDoubted)
      return { words: outcome ? `${words} – ${outcome}` : words, image: "triangle-alert", level: "warning" };
    return outcome
      ? { words: `${words} – ${outcome}`, image: "triangle-alert", level: "warning" }
      : { words, image: "circle-check", level: "good" };
  }
  if (state === "failed" || state === "expired")
    return { words: t("Not uploaded: {why}", { why }), image: "triangle-alert", level: "warning" };
  if (progress?.total)
    return {
      words: t("Uploading, {done} of {total} items", progress),
      image: "loader-circle",
      share: progress.done / progress.total,
    };
  return state === "queued"
    ? { words: t("Waiting for the UAV"), image: "timer" }
    : { words: t("Sending"), image: "loader-circle", share: 0 };
}

/**
 * "Hold: done 14:05", with the reason where it did not come to that: { words, image, level }.
 *
 * @param {Command} command
 * @returns {StatusText}
 */
export function commandWords(command) {
  const { words, image } = STATES[command.state];
  const at = command.finished_at ?? command.acknowledged_at ?? command.sent_at ?? command.created_at;
  const summary = t("{kind}: {state} {time}", { kind: KINDS[command.kind], state: words, time: clockText(at) });
  const { progress } = command;
  if (command.state === "queued" && progress?.total && !isOfMission(command)) {
    return {
      words: t("{kind}: verifying the mission on board, {done} of {total} items", {
        kind: KINDS[command.kind],
        ...progress,
      }),
      image: "loader-circle",
      level: null,
    };
  }
  const wait_s = command.parameters.wait_s ?? 0;
  if (command.state === "queued" && command.kind === "return" && wait_s > 0) {
    const due = new Date(Date.parse(command.created_at) + wait_s * 1000).toISOString();
    return { words: t("Return: holds until {time}", { time: exactClockText(due) }), image: "timer", level: null };
  }
  const level = command.state === "failed" ? "critical" : command.state === "expired" ? "warning" : null;
  return {
    words: command.outcome && command.state !== "applied" ? `${summary} – ${command.outcome}` : summary,
    image,
    level,
  };
}

/**
 * Its times in order: "given 14:02:10, sent 14:02:11".
 *
 * @param {Command} command
 * @param {(iso: string) => string} timeText
 */
export function timesOf({ created_at, sent_at, acknowledged_at, finished_at, state }, timeText) {
  /** @type {[string, string | null][]} */
  const steps = [
    [t("given"), created_at],
    [t("sent"), sent_at],
    [t("acknowledged"), acknowledged_at],
    [STATES[state].words, finished_at],
  ];
  return steps.flatMap(([word, at]) => (at ? [`${word} ${timeText(at)}`] : [])).join(", ");
}

const IN_MOTION = ["arm", "take-off", "start", "resume"];

/**
 * Why a UAV is not set in motion by this command; empty where it is, and for commands that stop it or bring it back.
 *
 * @param {CommandKind} kind
 * @param {Mission} mission
 * @param {Pick<Flyer, "uav" | "name" | "hasFailed">} flyer
 * @param {readonly Command[]} commands
 */
export function whyNotMoved(kind, mission, { uav, name, hasFailed }, commands) {
  if (!IN_MOTION.includes(kind)) return "";
  if (!isOnItsWay(mission) || !mission.approval) return t("{name} has no mission.", { name });
  if (mission.approval.revoke_requested_at) return t("The approval is being revoked.");
  if (hasFailed) return t("A flight of {name} has failed: it does not fly on in this mission.", { name });
  const { id } = mission.approval;
  const wasStarted = commands.some(
    (command) => command.kind === "start" && command.uav.id === uav && command.sent_at && command.approval === id,
  );
  return kind === "resume" && !(mission.state === "active" && wasStarted)
    ? t("{name} has not started its mission: there is nothing to go on with.", { name })
    : "";
}

/**
 * Why a UAV cannot be started; empty where it can.
 *
 * @param {Mission} mission
 * @param {Flyer} flyer
 * @param {readonly Command[]} commands
 */
export function whyNoStart(mission, flyer, commands) {
  const { uav, name, flown } = flyer;
  const unmoved = whyNotMoved("start", mission, flyer, commands);
  if (unmoved) return unmoved;
  const board = boardOf(commands, uav);
  if (board?.kind !== "upload-mission" || board.state !== "applied")
    return t("{name} does not have its mission yet.", { name });
  const flight = board.parameters.flight ?? 1;
  if (flight <= flown) return t("{name} has flown this flight.", { name });
  const started = commands.find(
    ({ kind, uav: { id }, parameters, state, approval }) =>
      kind === "start" &&
      id === uav &&
      state === "applied" &&
      parameters.flight === flight &&
      approval === mission.approval?.id,
  );
  return started ? t("{name} has already been started.", { name }) : "";
}

/**
 * The number of the flight that can be sent to a UAV now; null where none is to be sent.
 *
 * @param {Pick<Flyer, "uav" | "flights" | "flown">} flyer
 * @param {readonly Command[]} commands
 * @param {UavConnection | null} [connection]
 * @returns {number | null}
 */
export function flightToSend({ uav, flights, flown }, commands, connection = null) {
  const board = boardOf(commands, uav);
  const next = flown + 1;
  if (next > flights) return null;
  const isThere =
    board?.kind === "upload-mission" &&
    (isOpen(board) || (board.state === "applied" && isSeenThere(board, connection))) &&
    (board.parameters.flight ?? 1) === next;
  return isThere ? null : next;
}

/** Why the mission can be neither changed nor, where it applies, sent; a sentence. @param {Mission} mission */
export function stageWords(mission) {
  const { approval, state } = mission;
  if (state === "completed") return t("Flown to its end. Save a copy to fly it again.");
  if (state === "aborted") return t("Aborted. Save a copy to fly it again.");
  if (state === "failed") return t("A flight failed. Save a copy to fly it again.");
  if (approval?.revoke_requested_at)
    return t("The approval is being revoked: {reason}. It ends once the mission is removed from every UAV.", {
      reason: approval.revoke_reason,
    });
  const by = t("Approved by {name} {time}.", {
    name: approval?.approved_by ?? t("somebody who has left"),
    time: approval ? clockText(approval.approved_at) : "",
  });
  const how =
    state === "active"
      ? t("It is being flown: nothing of it can be changed.")
      : t("Nothing of it can be changed until that is revoked.");
  return `${by} ${how}`;
}

/**
 * Causes of a map data change that affect the routes; empty where all changes lie elsewhere. Causes of UAVs are shown separately.
 *
 * @param {Pick<Mission, "is_stale" | "stale_causes">} mission
 */
export const groundCauses = ({ is_stale, stale_causes }) =>
  is_stale ? (stale_causes ?? []).filter(({ what }) => what !== "uav" && what !== "elsewhere") : [];

/** Whether its approval can be revoked. @param {Pick<Mission, "state">} mission */
export const canBeRevoked = ({ state }) => ["approved", "dispatched"].includes(state);

/** Whether the mission can be aborted: the report that its last flight failed may be wrong. @param {Pick<Mission, "state">} mission */
export const canBeAborted = (mission) => isOnItsWay(mission) || mission.state === "failed";
