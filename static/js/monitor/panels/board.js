/** The board and the log of events, one of them at a time. */

import { byId, find, h, icon, keyedList, setChildren } from "../../dom.js";
import { colourClass } from "../../domain/palette.js";
import { simulatedMark } from "../../simulated.js";
import { t } from "../../text.js";
import { clockText, exactClockText, exactText } from "../../units.js";
import { boardRows, STATES } from "../board.js";
import { lineOf } from "../event_log.js";

/** @import { BoardRow } from "../board.js" */
/** @import { LoggedEvent } from "../event_log.js" */
/** @import { LiveMission, MonitorState, MonitorStore } from "../types.d.ts" */

/** @typedef {(mission: string, place: number) => void} ShowTarget brings a target into view on the map */

/** @param {Node} body */
const tableOf = (body) =>
  h(
    "table",
    { class: "board-table" },
    h("caption", { class: "unseen" }, t("Targets")),
    h(
      "thead",
      {},
      h(
        "tr",
        {},
        h("th", { scope: "col" }, t("Target")),
        h("th", { scope: "col" }, t("State")),
        h("th", { scope: "col", class: "number" }, t("At|time")),
      ),
    ),
    body,
  );

/** The mission of the targets below, on a page of several. @param {HTMLTableRowElement} row @param {LiveMission} mission @param {number | undefined} number */
function refreshGroup(row, { id, name, counts: { complete: done, all } }, number) {
  const key = JSON.stringify([name, number, done, all]);
  if (row.dataset.key === key) return;
  row.dataset.key = key;
  setChildren(
    row.cells[0],
    h("span", { class: "mission-number" }, `${number ?? ""}`),
    h("a", { href: `/missions/${id}/fly` }, name),
    h("span", { class: "quiet-text" }, t("{done} of {all} complete", { done, all })),
  );
}

/** @typedef {{ key: string, group: LiveMission }} GroupRow */
/** @param {BoardRow | GroupRow} row @returns {row is GroupRow} */
const isGroup = (row) => "group" in row;

/** Each mission's row before its targets, where there are several. @param {BoardRow[]} rows @param {LiveMission[]} missions */
function withGroups(rows, missions) {
  /** @type {(BoardRow | GroupRow)[]} */
  const all = [];
  for (const [index, row] of rows.entries()) {
    const group = missions.find(({ id }) => id === row.mission);
    if (group && rows[index - 1]?.mission !== row.mission) all.push({ key: `of ${group.id}`, group });
    all.push(row);
  }
  return all;
}

/** @param {BoardRow} row @param {ShowTarget} show */
function makeRow({ mission, place }, show) {
  const name = h("button", { type: "button", class: "text-button", onclick: () => show(mission, place) });
  return h(
    "tr",
    {},
    h("td", {}, h("div", { class: "board-target" }, h("span", { class: "pill" }), name)),
    h("td", { class: "board-state" }),
    h("td", { class: "number" }),
  );
}

/** @param {HTMLTableRowElement} row @param {BoardRow} target */
function refreshRow(row, { colour, pill, label, state, at, isExpected, reason }) {
  const { words, image } = STATES[state];
  const key = JSON.stringify([colour, pill, label, state, at, reason]);
  if (row.dataset.key === key) return;
  row.dataset.key = key;
  row.className = `${state} ${colourClass(colour)}`;
  find(row, ".pill").textContent = pill;
  find(row, "button").textContent = label;
  setChildren(row.cells[1], h("span", {}, icon(image, "small"), words), reason && h("small", {}, reason));
  const time = at && (isExpected ? `~\u2009${clockText(at)}` : exactClockText(at));
  setChildren(row.cells[2], at ? h("time", { datetime: at, title: exactText(at) }, time) : "—");
}

/** @param {HTMLElement} row @param {LoggedEvent} event */
function refreshEvent(row, { at, image, level, isSimulated, words }) {
  if (row.dataset.words === words) return;
  row.dataset.words = words;
  row.className = level ?? "";
  setChildren(
    row,
    icon(image, "small"),
    h("span", {}, words, isSimulated && [" ", simulatedMark()]),
    h("time", { datetime: at, title: exactText(at) }, exactClockText(at)),
  );
}

/** @param {LiveMission[]} missions */
function countWords(missions) {
  const all = missions.reduce((sum, { counts }) => sum + counts.all, 0);
  const done = missions.reduce((sum, { counts }) => sum + counts.complete, 0);
  return all ? t("{done} of {all} complete", { done, all }) : "";
}

/** @param {MonitorStore} store @param {{ show: ShowTarget, readOlder: () => Promise<void> }} on */
export function mountBoard(store, { show, readOlder }) {
  const body = h("tbody", {});
  const [board, log, button, older] = [byId("board"), byId("event-log"), byId("switch-log"), byId("older-events")];
  board.append(tableOf(body));
  const drawRows = keyedList(
    body,
    ({ key }) => key,
    (/** @type {BoardRow | GroupRow} */ row) =>
      isGroup(row) ? h("tr", { class: "board-group" }, h("th", { scope: "rowgroup", colspan: 3 })) : makeRow(row, show),
    (element, row) =>
      isGroup(row) ? refreshGroup(element, row.group, store.state.numbers.get(row.group.id)) : refreshRow(element, row),
  );
  const drawLog = keyedList(
    log,
    (/** @type {LoggedEvent} */ { key }) => key,
    () => h("li", {}),
    refreshEvent,
  );

  /** @param {Readonly<MonitorState>} state */
  function drawEvents({ events, olderEvents, missions }) {
    const names = new Map(missions.map(({ id, name }) => [id, name]));
    drawLog((events ?? []).map((event) => lineOf(event, names)));
    byId("no-events").textContent = events === null ? t("Reading…") : t("Nothing has happened yet.");
    byId("no-events").hidden = Boolean(events?.length);
    older.hidden = olderEvents === null;
  }

  /** @param {Readonly<MonitorState>} state */
  function draw(state) {
    const { showsLog, missions, uavs, details, numbers } = state;
    byId("board-count").textContent = countWords(missions);
    button.setAttribute("aria-pressed", `${showsLog}`);
    button.textContent = showsLog ? t("Back to target status") : t("Event log");
    board.hidden = showsLog;
    byId("log").hidden = !showsLog;
    if (showsLog) drawEvents(state);
    else {
      const rows = boardRows(missions, uavs, details, numbers);
      drawRows(numbers.size > 1 ? withGroups(rows, missions) : rows);
    }
  }

  button.addEventListener("click", () => store.update({ showsLog: !store.state.showsLog }));
  older.addEventListener("click", () => void readOlder());
  store.listen(["showsLog", "missions", "uavs", "details", "numbers", "events", "olderEvents"], draw);
}
