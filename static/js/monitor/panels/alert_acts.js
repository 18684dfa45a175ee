/** Acts on an alert: acknowledge, note, close, take over the UAV, and go to where it is down. */

import { ApiError, post } from "../../api.js";
import { h } from "../../dom.js";
import { downAt } from "../../domain/order.js";
import { copyText } from "../../page/clipboard.js";
import { confirmAct } from "../../page/confirm.js";
import { announce, toast } from "../../page/toast.js";
import { t, tn } from "../../text.js";
import { positionText } from "../../units.js";

/** @import { Answer } from "../../api.js" */
/** @import { AlertLevel, EndedAlerts } from "../../api_types.d.ts" */
/** @import { Alert } from "../types.d.ts" */

/** @param {() => Promise<void>} act @param {string} words once it is done */
export async function tried(act, words) {
  try {
    await act();
    announce(words);
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    toast(error.message);
  }
}

/**
 * At the level that was seen: the server refuses where it has risen since.
 *
 * @param {Alert} alert
 * @param {AlertLevel | undefined} seen_level
 * @param {string} [note]
 */
export const acknowledge = (alert, seen_level, note = "") =>
  tried(
    async () => void (await post(`/alerts/${alert.id}/acknowledge`, { note, ...(seen_level && { seen_level }) })),
    t("Acknowledged."),
  );

/** One request for alerts that have ended, answered alert by alert. @param {Alert[]} ended */
export async function acknowledgeEnded(ended) {
  try {
    const answer = await post("/alerts/acknowledge-ended", { alerts: ended.map(({ id }) => id) });
    const { results } = /** @type {Answer<EndedAlerts>} */ (answer).data;
    const count = results.filter(({ outcome }) => outcome === "acknowledged").length;
    toast(tn(count, "{count} ended alert acknowledged.", "{count} ended alerts acknowledged."));
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    toast(error.message);
  }
}

/**
 * A pilot on site takes over the flight: reported to all users by a note.
 *
 * @param {Alert} alert
 * @param {string} name
 * @param {AlertLevel | undefined} seen_level
 * @param {HTMLElement} opener
 */
export async function takeOver(alert, name, seen_level, opener) {
  const asked = await confirmAct({
    title: t("Does a pilot on site fly {name} by hand?", { name }),
    lines: [
      alert.message,
      t("Nothing is sent to the UAV. The pilot takes it by the remote control, in a mode that needs no position."),
    ],
    act: t("Pilot takes over"),
    keep: t("Cancel"),
    opener,
  });
  if (asked) await acknowledge(alert, seen_level, t("A pilot on site takes over {name}.", { name }));
}

/** @param {Alert} alert */
export async function note(alert) {
  const asked = await confirmAct({
    title: t("Add note"),
    lines: [alert.message],
    field: { name: "text", label: t("Note (cannot be changed later)"), isNeeded: true },
    act: t("Save note"),
    keep: t("Cancel"),
  });
  if (!asked?.text) return;
  await tried(async () => void (await post(`/alerts/${alert.id}/notes`, { text: asked.text })), t("Note saved."));
}

/**
 * Close an alert. A UAV that is down away from the end of its flight stays on the board until a user states its outcome.
 * @param {Alert} alert
 */
export async function close(alert) {
  const asked = await confirmAct({
    title: t("Close this alert"),
    lines: [alert.message],
    field: { name: "reason", label: t("What happened to the UAV (saved as a note)"), isNeeded: true },
    act: t("Close"),
    keep: t("Cancel"),
  });
  if (!asked?.reason) return;
  await tried(
    async () => void (await post(`/alerts/${alert.id}/close`, { reason: asked.reason })),
    t("The alert is closed."),
  );
}

/** @param {string} position */
async function copyPosition(position) {
  toast((await copyText(position)) ? t("Position copied: {position}", { position }) : position);
}

/** For the crew that recovers the UAV: its position to copy, and a link to a phone's navigation or to a map. @param {Alert} alert */
export function positionActs(alert) {
  const position = downAt(alert);
  if (!position) return [];
  const [longitude, latitude] = position.map((degrees) => degrees.toFixed(6));
  const address = matchMedia("(pointer: coarse)").matches
    ? `geo:${latitude},${longitude}?q=${latitude},${longitude}`
    : `https://www.openstreetmap.org/?mlat=${latitude}&mlon=${longitude}#map=18/${latitude}/${longitude}`;
  return [
    h(
      "button",
      { type: "button", class: "button small quiet", onclick: () => void copyPosition(positionText(position)) },
      t("Copy position"),
    ),
    h("a", { class: "button small quiet", href: address, target: "_blank", rel: "noreferrer" }, t("Navigate")),
  ];
}
