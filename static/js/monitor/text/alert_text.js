/** Text of an alert on a live page: words that change with time, additional lines, and the acts that still apply. */

import { inAir } from "../../domain/in_air.js";
import { isOpenAlert } from "../../domain/order.js";
import { t } from "../../text.js";
import { exactClockText } from "../../units.js";
import { contactWords, durationWords, isLanding, isReturning } from "./uav_text.js";

/** @import { Alert, LiveUav } from "../types.d.ts" */

/**
 * When the UAV of a lost-link alert last sent a message [s since 1970]; null for other alerts, and once messages arrive again.
 *
 * @param {Alert} alert
 */
function silentSince_s(alert) {
  const { received_s } = /** @type {{ received_s?: unknown }} */ (alert.details ?? {});
  return alert.code === "link-lost" && isOpenAlert(alert) && typeof received_s === "number" ? received_s : null;
}

/** Whether its text changes with time alone. @param {Alert} alert */
export const isMoving = (alert) => silentSince_s(alert) !== null;

/**
 * Its sentence: of a silent link with the age of this moment and the time of the last message.
 *
 * @param {Alert} alert
 * @param {Pick<LiveUav, "name"> | undefined} uav undefined: it is not on the page
 * @param {number} now_ms
 */
export function messageWords(alert, uav, now_ms) {
  const received_s = silentSince_s(alert);
  if (received_s === null || !uav) return alert.message;
  const values = {
    uav: uav.name,
    age: durationWords(Math.max(0, now_ms / 1000 - received_s)),
    time: exactClockText(new Date(received_s * 1000).toISOString()),
  };
  return alert.level === "critical"
    ? t("Link to {uav} lost: no telemetry for {age} (last message {time}).", values)
    : t("{uav}: no telemetry for {age} (last message {time}).", values);
}

/** That it returns or lands already, and since when. @param {Alert} alert */
function ownActWords({ own_act }) {
  if (!own_act) return "";
  const { kind, since, is_commanded } = own_act;
  if (since === null) {
    if (is_commanded) return kind === "land" ? t("Landing, as commanded.") : t("Returning, as commanded.");
    return kind === "land" ? t("Landing by itself: failsafe or pilot.") : t("Returning by itself: failsafe or pilot.");
  }
  const values = { time: exactClockText(since) };
  if (is_commanded)
    return kind === "land"
      ? t("Landing since {time}, as commanded.", values)
      : t("Returning since {time}, as commanded.", values);
  return kind === "land"
    ? t("Landing by itself since {time}: failsafe or pilot.", values)
    : t("Returning by itself since {time}: failsafe or pilot.", values);
}

/** What an expected time of contact rests on. */
export const CONTACT_MEANS = t("Calculated from the route and from where UAVs were heard on earlier flights.");

/**
 * Additional lines of an open alert: what the UAV does by itself, what an act costs or why it is not offered, and when a silent UAV is
 * expected to report; "" without any.
 *
 * @param {Alert} alert
 * @param {LiveUav | undefined} uav
 * @param {number} now_ms
 */
export function besideWords(alert, uav, now_ms) {
  if (!isOpenAlert(alert)) return "";
  const expected = isMoving(alert) && uav?.estimated?.contact_expected_at;
  return [ownActWords(alert), alert.advice, expected && `${contactWords(expected, now_ms)} ${CONTACT_MEANS}`]
    .filter(Boolean)
    .join(" ");
}

/**
 * Acts of an alert for UAVs of the page: none that a UAV does already by itself.
 *
 * @param {Alert} alert
 * @param {LiveUav[]} uavs
 * @returns {{ kind: Alert["acts"][number]["kind"], uav: LiveUav }[]}
 */
export const actsNow = ({ acts }, uavs) =>
  acts.flatMap(({ kind, uav: id }) => {
    const uav = uavs.find((entry) => entry.id === id);
    return uav && !overtakenWords(kind, uav) ? { kind, uav } : [];
  });

/**
 * Why a question before a return or a landing is over: the UAV does so already, or is down; "" where it is not.
 *
 * @param {string} kind of the act
 * @param {LiveUav} uav
 */
export function overtakenWords(kind, uav) {
  const { name } = uav;
  if (kind === "return" && isReturning(uav)) return t("{name} is already returning.", { name });
  if ((kind === "return" || kind === "land") && isLanding(uav)) return t("{name} is already landing.", { name });
  if ((kind === "return" || kind === "land") && inAir(uav) === false) return t("{name} is on the ground.", { name });
  return "";
}

export const SEEN_AFTER_MS = 1000; // a level that is shown for less was not read before a click

/**
 * Create the levels at which the user saw alerts before acknowledging: a level that rose under the pointer was not read.
 *
 * @returns {{ show: (alerts: Pick<Alert, "id" | "level">[], at_ms: number) => void, of: (id: number, at_ms: number) => Alert["level"] | undefined }}
 */
export function createSeenLevels() {
  /** @type {Map<number, { level: Alert["level"], before: Alert["level"], since_ms: number }>} */
  let shown = new Map();
  /** @param {number} id @param {number} at_ms */
  const of = (id, at_ms) => {
    const entry = shown.get(id);
    return entry && (at_ms - entry.since_ms < SEEN_AFTER_MS ? entry.before : entry.level);
  };
  return {
    of,
    show(alerts, at_ms) {
      shown = new Map(
        alerts.map(({ id, level }) => {
          const entry = shown.get(id);
          const isSame = entry?.level === level;
          return [id, isSame ? entry : { level, before: of(id, at_ms) ?? level, since_ms: at_ms }];
        }),
      );
    },
  };
}
