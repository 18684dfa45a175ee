/** Delivery of a command to UAVs without a link. */

import { t } from "../../text.js";

/** @import { CommandKind, LiveUav } from "../../api_types.d.ts" */

/** @type {Set<CommandKind>} */
const SENT = new Set(["hold", "return", "land", "abort"]); // by a gateway at the last address; a companion computer polls by itself
const RECEIVED_WITHIN_MS = 3_600_000;

/**
 * Sentences on UAVs that receive the command anyway, and on those whose command waits.
 *
 * @param {LiveUav[]} uavs
 * @param {CommandKind} kind
 * @param {number} now_ms
 */
export function unreachableLines(uavs, kind, now_ms) {
  /** @param {LiveUav} uav */
  const isSent = ({ link }) =>
    SENT.has(kind) && link?.kind === "mavlink" && now_ms - Date.parse(link.last_message_at ?? "") < RECEIVED_WITHIN_MS;
  const sent = uavs.filter(isSent);
  const waiting = uavs.filter((uav) => !isSent(uav));
  /** @param {LiveUav[]} some */
  const names = (some) => some.map(({ name }) => name).join(", ");
  return [
    sent.length > 0 &&
      t("No telemetry from {names}: the command is sent repeatedly, and confirmed once telemetry returns.", {
        names: names(sent),
      }),
    waiting.length > 0 &&
      t("No link to {names}: the command is sent on contact, unless it expires first.", {
        names: names(waiting),
      }),
  ].filter(Boolean);
}
