/** Rare commands to one UAV: its start alone, another upload, the next flight; with the reason where one cannot be sent. */

import { ApiError, freshKey, get, post } from "../api.js";
import { flightToSend, flyersOf, isFlown, KINDS, whyNoStart, whyNotMoved } from "../domain/flying.js";
import { confirmAct } from "../page/confirm.js";
import { toast } from "../page/toast.js";
import { t } from "../text.js";

/** @import { Answer } from "../api.js" */
/** @import { Command, CommandPage, Mission, UavConnection } from "../api_types.d.ts" */
/** @import { AskedKind } from "../domain/command_questions.js" */
/** @import { Flyer } from "../domain/flying.js" */
/** @import { MenuItem } from "../page/chrome.js" */

/** @typedef {{ mission: Mission, commands: Command[], connection: UavConnection | null }} Known the server's state of a UAV's mission */
/** @typedef {{ kind: AskedKind | "send", icon: string, label: string, reason: string, flight: number }} Entry */

/** @type {[AskedKind, string][]} */
const KIND_ICONS = [
  ["start", "plane-takeoff"],
  ["arm", "plane-takeoff"],
  ["take-off", "plane-takeoff"],
  ["change-speed", "gauge"],
];

/**
 * Entries for a UAV beside the buttons of the command bar.
 *
 * @param {Known} known
 * @param {Flyer} flyer
 * @param {string} silent why it cannot receive commands in the air; "" where it can
 * @returns {Entry[]}
 */
export function menuEntries({ mission, commands, connection }, flyer, silent) {
  const next = flightToSend(flyer, commands, connection);
  const isBeingRevoked = Boolean(mission.approval?.revoke_requested_at);
  const canSend = next !== null && isFlown(mission) && !isBeingRevoked;
  const flight = next ?? 1;
  /** @param {AskedKind} kind */
  const reasonOf = (kind) => {
    if (kind === "start") return whyNoStart(mission, flyer, commands);
    return kind === "change-speed" ? silent : whyNotMoved(kind, mission, flyer, commands);
  };
  return [
    {
      kind: "send",
      icon: "send",
      label: flight > 1 ? t("Upload flight {flight}", { flight }) : t("Upload again"),
      reason: canSend ? "" : t("The mission is already on {name}.", { name: flyer.name }),
      flight,
    },
    ...KIND_ICONS.map(([kind, icon]) => ({ kind, icon, label: KINDS[kind], reason: reasonOf(kind), flight })),
  ];
}

/** @param {string} mission @param {number} uav @returns {Promise<Known>} */
async function knownOf(mission, uav) {
  const [read, commands, connection] = await Promise.all([
    get(`/missions/${mission}`),
    get(`/missions/${mission}/commands?limit=200`),
    get(`/uavs/${uav}/connection`),
  ]);
  return {
    mission: /** @type {Answer<Mission>} */ (read).data,
    commands: /** @type {Answer<CommandPage>} */ (commands).data.results,
    connection: /** @type {Answer<UavConnection>} */ (connection).data,
  };
}

/** Send to one UAV after confirmation. @param {Mission} mission @param {Flyer} flyer @param {number} flight @param {HTMLElement} opener */
async function send(mission, { name, place }, flight, opener) {
  const asked = await confirmAct({
    title:
      flight > 1
        ? t("Upload flight {flight} to {name}?", { flight, name })
        : t("Upload its route to {name}?", { name }),
    lines: [
      t("The upload is verified against the approved mission. The UAV does not take off."),
      t("A UAV that is not connected receives its route on contact, within the hour."),
    ],
    act: t("Upload to {name}", { name }),
    isBack: true,
    image: "send",
    opener,
  });
  if (!asked) return;
  const headers = { "If-Match": `"${mission.revision}"`, "Idempotency-Key": freshKey() };
  await tried(() => post(`/missions/${mission.id}/dispatch`, { uav: place, flight }, { headers }));
}

/** @param {() => Promise<unknown>} act */
async function tried(act) {
  try {
    await act();
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    toast(`${t("Not sent.")} ${error.message}`);
  }
}

/**
 * Items of the menu of a UAV of a mission, read now; null where it has no route in it, or it could not be read.
 *
 * @param {{ mission: string, uav: number, silent: string }} of silent: as for menuEntries
 * @param {{ opener: HTMLElement, ask: (kind: AskedKind) => unknown }} on
 * @returns {Promise<MenuItem[] | null>}
 */
export async function uavMenu({ mission, uav, silent }, { opener, ask }) {
  try {
    const known = await knownOf(mission, uav);
    const flyer = flyersOf(known.mission).find((entry) => entry.uav === uav);
    if (!flyer) return null;
    return menuEntries(known, flyer, silent).map(({ kind, icon, label, reason, flight }) => ({
      icon,
      label,
      reason,
      act: () => void (kind === "send" ? send(known.mission, flyer, flight, opener) : ask(kind)),
    }));
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    toast(error.message);
    return null;
  }
}
