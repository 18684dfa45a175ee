/** The mission's history in words: who did what, and when. */

import { get } from "../../api.js";
import { h, icon } from "../../dom.js";
import { open } from "../../page/keyboard.js";
import { t, tn } from "../../text.js";
import { exactText, lengthText, whenText } from "../../units.js";
import { lostLinkText } from "../lost_link.js";

const TOGETHER_MS = 10 * 60_000;
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

const names = (list, count) =>
  count > list.length
    ? t("{names} and {count} more", { names: list.join(", "), count: count - list.length })
    : list.join(", ");

function changeWords({ before, after }) {
  const words = [];
  if (before?.name !== after?.name)
    words.push(t("renamed from “{before}” to “{after}”", { before: before?.name, after: after?.name }));
  if (after?.targets_added)
    words.push(
      tn(after.targets_added, "{count} target added: {names}", "{count} targets added: {names}", {
        names: names(after.targets_names.added, after.targets_added),
      }),
    );
  if (after?.targets_removed)
    words.push(
      tn(after.targets_removed, "{count} target removed: {names}", "{count} targets removed: {names}", {
        names: names(after.targets_names.removed, after.targets_removed),
      }),
    );
  if (after?.uavs_added)
    words.push(
      tn(after.uavs_added, "{count} UAV added: {names}", "{count} UAVs added: {names}", {
        names: names(after.uavs_names.added, after.uavs_added),
      }),
    );
  if (after?.uavs_removed)
    words.push(
      tn(after.uavs_removed, "{count} UAV removed: {names}", "{count} UAVs removed: {names}", {
        names: names(after.uavs_names.removed, after.uavs_removed),
      }),
    );
  if (before?.objective !== after?.objective)
    words.push(after?.objective === "total" ? t("best at: fly least") : t("best at: even routes"));
  if (before?.return_to_start !== after?.return_to_start)
    words.push(after?.return_to_start ? t("each UAV returns to its start") : t("no UAV has to return"));
  if (JSON.stringify(before?.lost_link) !== JSON.stringify(after?.lost_link))
    words.push(t("without a link each UAV {does}", { does: lostLinkText(after?.lost_link) }));
  return words.join("; ") || t("places or tasks changed");
}

/** What an entry says: { title, detail }. */
export function wordsOfEntry(entry) {
  const { action, after } = entry;
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
  if (action === "approve")
    return { title: t("Approved"), detail: t("as {hash}", { hash: (after?.sha256 ?? "").slice(0, 12) }) };
  if (action === "revoke") return { title: t("Approval revoked"), detail: after?.reason ?? "" };
  if (action === "revoke-asked") return { title: t("Approval is being revoked"), detail: after?.reason ?? "" };
  if (action === "dispatch")
    return {
      title: t("Sent to UAVs"),
      detail: [tn(after?.sent?.length ?? 0, "{count} UAV", "{count} UAVs"), after?.why].filter(Boolean).join(", "),
    };
  if (action === "start") return { title: t("Started"), detail: "" };
  if (action === "complete") return { title: t("Completed"), detail: "" };
  if (action === "fail") return { title: t("Failed"), detail: "" };
  if (action === "abort") return { title: t("Aborted"), detail: after?.why ?? "" };
  if (action === "delete") return { title: t("Deleted"), detail: "" };
  if (action === "restore") return { title: t("Brought back"), detail: "" };
  if (action === "rename")
    return {
      title: t("Renamed"),
      detail: t("from “{before}” to “{after}”", { before: entry.before?.name, after: after?.name }),
    };
  return { title: t("Changed"), detail: changeWords(entry) };
}

/** Changes of one person within ten minutes are one line, the newest first: [[entry, …], …]. */
export function grouped(entries) {
  const groups = [];
  for (const entry of entries) {
    const last = groups.at(-1)?.at(-1);
    const isNext =
      last &&
      entry.action === "change" &&
      last.action === "change" &&
      entry.actor === last.actor &&
      new Date(last.recorded_at) - new Date(entry.recorded_at) < TOGETHER_MS;
    if (isNext) groups.at(-1).push(entry);
    else groups.push([entry]);
  }
  return groups;
}

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
  const entries = [];
  let next = `/missions/${mission.id}/history?limit=50`;
  async function load() {
    try {
      const { data } = await get(next);
      entries.push(...data.results);
      next = data.next;
      list.replaceChildren(...grouped(entries).map(line));
      state.hidden = true;
      more.hidden = next === null;
    } catch (error) {
      state.hidden = false;
      state.textContent = t("Not loaded: {reason}", { reason: error.message });
      more.hidden = false;
    } finally {
      list.removeAttribute("aria-busy");
    }
  }
  more.addEventListener("click", load);
  open(dialog);
  return load();
}
