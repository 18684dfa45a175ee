/** "Close mission": a reason for each open target, then its report, or the draft of a follow-up. */

import { ApiError, freshKey, get, post } from "../api.js";
import { h, icon } from "../dom.js";
import { t, tn } from "../text.js";
import { open } from "./keyboard.js";

/** @import { Answer } from "../api.js" */
/** @import { Mission, MissionRecord, MissionState, RecordTarget } from "../api_types.d.ts" */

const MAX_REASON_LENGTH = 300;
/** @type {readonly MissionState[]} */
const ON_ITS_WAY = ["dispatched", "active"];
/** @type {readonly MissionState[]} */
const OVER = ["completed", "aborted", "failed"];

/** @param {Pick<RecordTarget, "state">} target */
const isOpen = ({ state }) => state === "pending" || state === "in-progress";

/**
 * Whether a part of it can still be closed.
 * @param {{ mission: { state: MissionState }, targets: readonly Pick<RecordTarget, "state">[] }} record
 */
export const canBeClosed = ({ mission, targets }) =>
  ON_ITS_WAY.includes(mission.state) || (OVER.includes(mission.state) && targets.some(isOpen));

/**
 * Ask for confirmation, close the mission, and open the report or the follow-up.
 * @param {{ mission: string, opener: HTMLElement }} options
 */
export async function askToClose({ mission, opener }) {
  opener.setAttribute("aria-busy", "true");
  try {
    const { data: record } = /** @type {Answer<MissionRecord>} */ (await get(`/missions/${mission}/record`));
    showQuestion(record);
  } finally {
    opener.removeAttribute("aria-busy");
  }
}

/** @param {MissionRecord} record */
function showQuestion({ mission, targets }) {
  const open_targets = targets.filter(isOpen);
  const fields = open_targets.map(({ place, label, reason }) => ({
    place,
    label,
    input: h("input", {
      class: "input",
      id: `close-reason-${place}`,
      type: "text",
      maxlength: MAX_REASON_LENGTH,
      required: true,
      value: reason?.message ?? "",
    }),
  }));
  const follow = h("input", { type: "checkbox", class: "check", id: "close-follow-up" });
  const fault = h("p", { class: "notice warning", role: "alert", hidden: true });
  const out = h("button", { class: "button", type: "button", onclick: () => dialog.close() }, t("Keep open"));
  const go = h("button", { class: "button primary" }, t("Close mission"));
  /** @param {Event} event */
  const onsubmit = async (event) => {
    event.preventDefault();
    fault.hidden = true;
    go.setAttribute("aria-busy", "true");
    try {
      location.href = await close(mission.id, fields, follow.checked);
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      fault.textContent = `${t("Not closed.")} ${error.message}`;
      fault.hidden = false;
    } finally {
      go.removeAttribute("aria-busy");
    }
  };
  /** @type {HTMLFormElement} */
  const form = h(
    "form",
    { onsubmit },
    h(
      "div",
      { id: "close-lines", class: "confirm-lines" },
      h(
        "p",
        {},
        open_targets.length
          ? tn(
              open_targets.length,
              "{count} target is open. Say why it is left; the reason is in the report.",
              "{count} targets are open. Say why each is left; the reasons are in the report.",
            )
          : t("No target is open. Nothing of this mission can be started any more."),
      ),
    ),
    fields.length > 1 && sameForAll(fields),
    h(
      "div",
      { class: "close-reasons" },
      fields.map(({ label, input }) => h("div", { class: "field" }, h("label", { for: input.id }, label), input)),
    ),
    fields.length > 0 &&
      h(
        "label",
        { class: "close-follow-up" },
        follow,
        h("span", {}, t("Plan a follow-up with the targets not inspected")),
      ),
    fault,
    h("div", { class: "acts" }, out, go),
  );
  /** @type {HTMLDialogElement} */
  const dialog = h(
    "dialog",
    { class: "confirm close-mission", "aria-labelledby": "close-title", "aria-describedby": "close-lines" },
    h("h2", { id: "close-title" }, icon("clipboard-list"), t("Close “{name}”?", { name: mission.name })),
    form,
  );
  open(dialog);
  (fields.find(({ input }) => !input.value)?.input ?? go).focus();
}

/** Fills every field that is still empty. @param {{ input: HTMLInputElement }[]} fields */
function sameForAll(fields) {
  const input = h("input", { class: "input", id: "close-reason-all", type: "text", maxlength: MAX_REASON_LENGTH });
  /** @type {Set<HTMLInputElement>} */
  const empty = new Set(fields.map((field) => field.input).filter(({ value }) => !value));
  input.addEventListener("input", () => {
    for (const one of empty) one.value = input.value;
  });
  return (
    empty.size > 1 &&
    h("div", { class: "field" }, h("label", { for: input.id }, t("The same reason for all without one")), input)
  );
}

/**
 * Returns the address to go on to.
 *
 * @param {string} mission
 * @param {{ place: number, input: HTMLInputElement }[]} fields
 * @param {boolean} isFollowedUp
 * @throws {ApiError}
 */
async function close(mission, fields, isFollowedUp) {
  const reasons = fields.map(({ place, input }) => ({ target: place, reason: input.value.trim() }));
  await post(
    `/missions/${mission}/close`,
    { reasons },
    { headers: { "If-Match": "*", "Idempotency-Key": freshKey() } },
  );
  if (!isFollowedUp) return `/missions/${mission}/report`;
  const { data } = /** @type {Answer<Mission>} */ (
    await post(`/missions/${mission}/follow-up`, {}, { headers: { "Idempotency-Key": freshKey() } })
  );
  return `/missions/${data.id}`;
}
