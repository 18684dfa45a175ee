/** The mission's history: who did what, and when. */

import { get } from "../../api.js";
import { h, icon } from "../../dom.js";
import { open } from "../../page/keyboard.js";
import { t, tn } from "../../text.js";
import { exactText, lengthText, whenText } from "../../units.js";
import { lostLinkText } from "../options/lost_link.js";

/** @import { Answer } from "../../api.js" */
/** @import { HistoryEntry, HistoryPage, LostLinkOutput, Mission } from "../../api_types.d.ts" */

/**
 * Facts of an entry on the mission before or after it; each action has some of them.
 *
 * @typedef {object} Facts
 * @property {string} [name]
 * @property {string} [of] the name of the mission that was copied
 * @property {string} [objective]
 * @property {boolean} [return_to_start]
 * @property {LostLinkOutput | null} [lost_link]
 * @property {number} [targets]
 * @property {number} [uavs]
 * @property {number} [targets_added]
 * @property {number} [targets_removed]
 * @property {{ added: string[], removed: string[] }} [targets_names]
 * @property {number} [uavs_added]
 * @property {number} [uavs_removed]
 * @property {{ added: string[], removed: string[] }} [uavs_names]
 * @property {number} [total_length_m]
 * @property {number} [unassigned]
 * @property {string} [uav]
 * @property {string} [sha256]
 * @property {string} [reason]
 * @property {unknown[]} [sent]
 * @property {string} [why]
 */
/** @typedef {{ before?: Facts | null, after?: Facts | null }} Change */
/** @typedef {HistoryEntry & Change} Entry */
/** @typedef {{ title: string, detail: string }} EntryWords */

const TOGETHER_MS = 10 * 60_000;
/** @type {Record<string, string>} */
const ICONS = {
  create: "plus",
  change: "pencil",
  rename: "pencil",
  plan: "waypoints",
  delete: "trash-2",
  restore: "archive-restore",
  duplicate: "copy",
  approve: "badge-check",
  revoke: "undo-2",
  "revoke-asked": "undo-2",
  dispatch: "send",
  start: "plane-takeoff",
  complete: "circle-check",
  fail: "circle-x",
  abort: "octagon-alert",
};

/** @param {string[]} list @param {number} count */
const names = (list, count) =>
  count > list.length
    ? t("{names} and {count} more", { names: list.join(", "), count: count - list.length })
    : list.join(", ");

/** @param {Change} change */
function changeWords({ before, after }) {
  /** @type {string[]} */
  const words = [];
  const targets = after?.targets_names ?? { added: [], removed: [] };
  const uavs = after?.uavs_names ?? { added: [], removed: [] };
  if (before?.name !== after?.name)
    words.push(t("renamed from “{before}” to “{after}”", { before: before?.name, after: after?.name }));
  if (after?.targets_added)
    words.push(
      tn(after.targets_added, "{count} target added: {names}", "{count} targets added: {names}", {
        names: names(targets.added, after.targets_added),
      }),
    );
  if (after?.targets_removed)
    words.push(
      tn(after.targets_removed, "{count} target removed: {names}", "{count} targets removed: {names}", {
        names: names(targets.removed, after.targets_removed),
      }),
    );
  if (after?.uavs_added)
    words.push(
      tn(after.uavs_added, "{count} UAV added: {names}", "{count} UAVs added: {names}", {
        names: names(uavs.added, after.uavs_added),
      }),
    );
  if (after?.uavs_removed)
    words.push(
      tn(after.uavs_removed, "{count} UAV removed: {names}", "{count} UAVs removed: {names}", {
        names: names(uavs.removed, after.uavs_removed),
      }),
    );
  if (before?.objective !== after?.objective)
    words.push(after?.objective === "total" ? t("optimised for: shortest distance") : t("optimised for: even routes"));
  if (before?.return_to_start !== after?.return_to_start)
    words.push(after?.return_to_start ? t("each UAV returns to its start") : t("no UAV has to return"));
  if (JSON.stringify(before?.lost_link) !== JSON.stringify(after?.lost_link))
    words.push(t("without a link each UAV {does}", { does: lostLinkText(after?.lost_link) }));
  return words.join("; ") || t("places or tasks changed");
}

/** The text of an entry. @param {Pick<Entry, "action" | "before" | "after">} entry @returns {EntryWords} */
export function wordsOfEntry(entry) {
  return wordsOfMaking(entry) ?? wordsOfFlying(entry) ?? { title: t("Changed"), detail: changeWords(entry) };
}

/**
 * The text of a change of the mission itself; null for other entries.
 *
 * @param {Pick<Entry, "action" | "before" | "after">} entry
 * @returns {EntryWords | null}
 */
function wordsOfMaking({ action, before, after }) {
  if (action === "create")
    return {
      title: t("Created"),
      detail: [
        tn(after?.targets ?? 0, "{count} target", "{count} targets"),
        tn(after?.uavs ?? 0, "{count} UAV", "{count} UAVs"),
      ].join(", "),
    };
  if (action === "duplicate") return { title: t("Copied from “{name}”", { name: after?.of ?? "" }), detail: "" };
  if (action === "plan")
    return {
      title: t("Planned"),
      detail: [
        lengthText(after?.total_length_m),
        after?.unassigned
          ? tn(after.unassigned, "{count} target is not reached", "{count} targets are not reached")
          : "",
      ]
        .filter(Boolean)
        .join(", "),
    };
  if (action === "by-hand")
    return { title: t("Changed by hand"), detail: t("the route of {name}", { name: after?.uav }) };
  if (action === "by-hand-undone")
    return { title: t("Change by hand taken back"), detail: t("the route of {name}", { name: after?.uav }) };
  if (action === "delete") return { title: t("Deleted"), detail: "" };
  if (action === "restore") return { title: t("Brought back"), detail: "" };
  if (action === "rename")
    return {
      title: t("Renamed"),
      detail: t("from “{before}” to “{after}”", { before: before?.name, after: after?.name }),
    };
  return null;
}

/**
 * The text of an act of flying; null for other entries.
 *
 * @param {Pick<Entry, "action" | "after">} entry
 * @returns {EntryWords | null}
 */
function wordsOfFlying({ action, after }) {
  if (action === "approve")
    return { title: t("Approved"), detail: t("as {hash}", { hash: (after?.sha256 ?? "").slice(0, 12) }) };
  if (action === "revoke") return { title: t("Approval revoked"), detail: after?.reason ?? "" };
  if (action === "revoke-asked") return { title: t("Approval is being revoked"), detail: after?.reason ?? "" };
  if (action === "dispatch")
    return {
      title: t("Uploaded to UAVs"),
      detail: [tn(after?.sent?.length ?? 0, "{count} UAV", "{count} UAVs"), after?.why].filter(Boolean).join(", "),
    };
  if (action === "begin-starts")
    return {
      title: t("Starts in planned order begun"),
      detail: tn(Array.isArray(after?.uavs) ? after.uavs.length : 0, "{count} UAV", "{count} UAVs"),
    };
  if (action === "stop-starts") return { title: t("Starts in planned order stopped"), detail: "" };
  if (action === "start") return { title: t("Started"), detail: "" };
  if (action === "complete") return { title: t("Completed"), detail: "" };
  if (action === "fail") return { title: t("Failed"), detail: "" };
  if (action === "abort") return { title: t("Aborted"), detail: after?.why ?? "" };
  return null;
}

/**
 * Changes of one user within ten minutes are one line, the newest first: [[entry, …], …].
 *
 * @param {Entry[]} entries
 */
export function grouped(entries) {
  /** @type {Entry[][]} */
  const groups = [];
  for (const entry of entries) {
    const group = groups.at(-1);
    const last = group?.at(-1);
    const isNext =
      last &&
      entry.action === "change" &&
      last.action === "change" &&
      entry.actor === last.actor &&
      Date.parse(last.recorded_at) - Date.parse(entry.recorded_at) < TOGETHER_MS;
    if (group && isNext) group.push(entry);
    else groups.push([entry]);
  }
  return groups;
}

/** @param {Entry[]} group */
function line(group) {
  const [newest] = group;
  const { title, detail } = wordsOfEntry(newest);
  const all = group.map((entry) => wordsOfEntry(entry).detail);
  return h(
    "li",
    {},
    icon(ICONS[newest.action] ?? "pencil", "small"),
    h(
      "div",
      {},
      h(
        "p",
        {},
        h("strong", {}, title),
        " ",
        h(
          "span",
          { class: "quiet-text" },
          newest.actor ?? t("somebody who has left"),
          " · ",
          h(
            "time",
            { datetime: newest.recorded_at, title: exactText(newest.recorded_at) },
            whenText(newest.recorded_at),
          ),
        ),
      ),
      group.length === 1 && detail && h("p", { class: "caption" }, detail),
      group.length > 1 &&
        h(
          "details",
          {},
          h("summary", { class: "caption" }, tn(group.length, "{count} change", "{count} changes")),
          h(
            "ul",
            {},
            all.map((words) => h("li", { class: "caption" }, words)),
          ),
        ),
    ),
  );
}

/** @param {Pick<Mission, "id" | "name">} mission */
export function showHistory(mission) {
  const list = h("ol", { class: "history-list", "aria-label": t("History"), "aria-busy": "true" });
  const more = h("button", { type: "button", class: "button", hidden: true }, t("Show more"));
  const state = h("p", { class: "caption", role: "status" }, t("Loading…"));
  const dialog = h(
    "dialog",
    { class: "history", "aria-labelledby": "history-title" },
    h("h2", { id: "history-title" }, t("History of “{name}”", { name: mission.name })),
    state,
    list,
    h("form", { method: "dialog", class: "acts" }, more, h("button", { class: "button" }, t("Close"))),
  );
  /** @type {Entry[]} */
  const entries = [];
  /** @type {string | null} */
  let next = `/missions/${mission.id}/history?limit=50`;
  async function load() {
    if (!next) return;
    try {
      const { data } = /** @type {Answer<HistoryPage>} */ (await get(next));
      entries.push(.../** @type {Entry[]} */ (data.results));
      next = data.next;
      list.replaceChildren(...grouped(entries).map(line));
      state.hidden = true;
      more.hidden = next === null;
    } catch (error) {
      state.hidden = false;
      state.textContent = t("Not loaded: {reason}", { reason: error instanceof Error ? error.message : "" });
      more.hidden = false;
    } finally {
      list.removeAttribute("aria-busy");
    }
  }
  more.addEventListener("click", load);
  open(dialog);
  return load();
}
