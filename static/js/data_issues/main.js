/** The page "Data quality": composes list, map and panel, and keeps them in step with the map data. */

import { get, post } from "../api.js";
import { byId } from "../dom.js";
import { boxAround } from "../domain/geodesy.js";
import { mountGroundPage } from "../ground/ground_page.js";
import { coordinatesOf } from "../ground/record_list.js";
import { loadMapLibrary } from "../map/maplibre.js";
import { announce, toast } from "../page/toast.js";
import { t, tn } from "../text.js";
import { whenText } from "../units.js";
import * as layer from "./issue_layer.js";
import { mountIssueList } from "./issue_list.js";
import { mountIssuePanel } from "./issue_panel.js";

/** @import { Answer, ApiError } from "../api.js" */
/** @import { DataIssueSummary, Repaired } from "../api_types.d.ts" */
/** @import { Box } from "../map/types.d.ts" */
/** @import { DataIssue } from "./types.d.ts" */

const PAGE = "100";
const SEARCHING_MS = 2_000; // between polls while the map data are searched
const RESTING_MS = 15_000;
const ROUND_DEG = 0.0015; // minimum margin shown around an issue, some 150 m

/** @type {DataIssue[]} */
let issues = [];
/** Address of the next page. @type {string | null} */
let next = null;
/** @type {DataIssue | null} */
let chosen = null;
/** @type {DataIssueSummary | null} */
let summary = null;
/**
 * Positions that are being clicked, with the callback that receives them.
 * @type {{ positions: number[][], notify: (count: number) => void } | null}
 */
let placed = null;
let asked = 0; // for the list
let choices = 0;
let refreshes = 0; // of the chosen issue
let looks = 0;
let lastLook = 0; // of those that were answered

await loadMapLibrary();
const { page, map, layout, open } = mountGroundPage({
  ringsItself: true,
  isBusy: () => placed !== null,
  click: (_thing, _position, point) => {
    const id = layer.issueAt(map.map, point);
    if (id) choose(id, { stay: true });
  },
});
const list = mountIssueList({
  narrow: () => load(),
  choose: (id) => choose(id),
  point: (issue) =>
    map.ring(issue && issue.id !== chosen?.id ? [{ type: "Point", coordinates: issue.properties.position }] : []),
  more: () => load({ more: true }),
});
const panel = mountIssuePanel(page.canCurate, {
  repair,
  dismiss: (note) => act((id) => post(`/data-issues/${id}/dismiss`, { note }), t("Ignored."), reopen),
  reopen: () => act(reopen, t("On the open list again.")),
  preview: (collection) => layer.showRepair(map.map, collection),
  place: startPlacing,
  placeDone: ({ action }) => repair({ action, positions: placed?.positions }),
  placeBack() {
    placed?.positions.pop();
    drawPlaces();
  },
  placeCancel,
  next: () => list.openNext(),
  close: () => choose(null),
});

function query() {
  const { state, kinds, text, inView } = list.filter;
  const parts = new URLSearchParams({ state, limit: PAGE });
  if (kinds.size) parts.set("kind", [...kinds].join(","));
  if (text) parts.set("text", text);
  if (inView) parts.set("bbox", coordinatesOf(map.box()));
  return `/data-issues?${parts}`;
}

/** @param {unknown} error */
const messageOf = (error) => /** @type {Error} */ (error).message;

/** @param {number} id */
const reopen = (id) => post(`/data-issues/${id}/reopen`);

/** @param {{ more?: boolean }} [how] whether the next page is added */
async function load({ more = false } = {}) {
  asked += 1;
  const turn = asked;
  list.busy(true);
  try {
    const address = more && next ? next : query();
    const { data } = /** @type {Answer<{ features: DataIssue[], next: string | null }>} */ (await get(address));
    if (turn !== asked) return; // the filter has changed since
    issues = more ? [...issues, ...data.features] : data.features;
    next = data.next;
    draw();
  } catch (error) {
    if (turn === asked) toast(messageOf(error), { label: t("Try again"), act: () => load({ more }) });
  } finally {
    if (turn === asked) list.busy(false);
  }
}

function draw() {
  list.show(issues, { hasMore: next !== null, hasSearched: Boolean(summary?.searched_at || summary?.is_current) });
  if (summary) list.counts(summary.kinds);
  layer.showAll(map.map, issues);
}

async function look() {
  looks += 1;
  const turn = looks;
  try {
    const { data } = /** @type {Answer<DataIssueSummary>} */ (await get("/data-issues/summary"));
    if (turn < lastLook) return; // a later poll was answered first
    lastLook = turn;
    const before = summary?.searched_at;
    summary = data;
    list.counts(summary.kinds);
    showFacts(summary);
    if (before !== undefined && before !== summary.searched_at) {
      await load();
      if (chosen && placed === null) await refreshChosen();
    }
  } catch {
    byId("page-facts").textContent = t("The server cannot be reached. Trying again.");
  }
}

/** Poll without end: map data may change at any time, also by other users. */
async function keepLooking() {
  for (;;) {
    await new Promise((resolve) => setTimeout(resolve, summary?.is_current ? RESTING_MS : SEARCHING_MS));
    if (!document.hidden) await look();
  }
}

/** @param {DataIssueSummary} summary */
function showFacts({ kinds, is_current, searched_at }) {
  const open = Object.values(kinds).reduce((total, byState) => total + byState.open, 0);
  const facts = byId("page-facts");
  facts.dataset.searching = String(!is_current);
  if (!searched_at) {
    facts.textContent = is_current ? t("Nothing to search yet") : t("Searching the ground…");
    return;
  }
  const when = is_current ? t("searched {when}", { when: whenText(searched_at) }) : t("searching the changed ground…");
  facts.textContent = `${tn(open, "{count} issue open", "{count} issues open")} · ${when}`;
}

/** @param {number | null} id @param {{ stay?: boolean }} [how] stay: the map does */
async function choose(id, { stay = false } = {}) {
  choices += 1;
  const turn = choices;
  stopPlacing();
  layer.showRepair(map.map, null);
  if (id === null) {
    chooseNone();
    return;
  }
  try {
    const { data } = /** @type {Answer<DataIssue>} */ (await get(`/data-issues/${id}`));
    if (turn !== choices) return; // another has been chosen since
    chosen = data;
    panel.show(data);
    layer.showIssue(map.map, data);
    map.ring([]);
    list.mark(id);
    if (layout.isPhone()) byId("side-scroll").scrollTop = 0; // on small screens the panel is above the list
    remember();
    if (!stay) map.fit(boxOf(data));
    announce(data.properties.sentence);
  } catch (error) {
    const { status, message } = /** @type {ApiError} */ (error);
    if (turn === choices) toast(status === 404 ? t("This issue is gone: its asset was taken away.") : message);
  }
}

function chooseNone() {
  /** @type {HTMLElement | null} */
  const row = document.querySelector(".issue-row[aria-current=true]");
  const hadFocus = byId("issue-panel").contains(document.activeElement);
  chosen = null;
  panel.show(null);
  layer.showIssue(map.map, null);
  list.mark(null);
  remember();
  if (hadFocus) row?.focus();
}

/** Read the chosen issue again; without effect where another has been chosen, or places are being clicked, before the answer arrives. */
async function refreshChosen() {
  if (!chosen) return;
  refreshes += 1;
  const turn = refreshes;
  const { id } = chosen;
  const isLate = () => turn !== refreshes || chosen?.id !== id || placed !== null;
  try {
    const { data } = /** @type {Answer<DataIssue>} */ (await get(`/data-issues/${id}`));
    if (isLate()) return;
    chosen = data;
    panel.refresh(data);
    layer.showIssue(map.map, data.properties.state === "repaired" ? null : data);
    list.mark(id);
  } catch {
    if (!isLate()) chooseNone();
  }
}

function remember() {
  const address = new URL(location.href);
  if (chosen) address.searchParams.set("issue", String(chosen.id));
  else address.searchParams.delete("issue");
  history.replaceState(history.state, "", address);
}

/** @param {DataIssue} issue @returns {Box} */
function boxOf({ geometry, properties }) {
  const { nearest } = properties.details;
  const places = [...layer.placesOf(geometry), ...(nearest ? [nearest] : [])];
  const [west, south, east, north] = /** @type {Box} */ (boxAround(places));
  const wide = Math.max(0, ROUND_DEG - (east - west) / 2) / Math.cos((south * Math.PI) / 180);
  const high = Math.max(0, ROUND_DEG - (north - south) / 2);
  return [west - wide, south - high, east + wide, north + high];
}

/** @param {Record<string, unknown>} body */
async function repair(body) {
  if (!chosen) return;
  const { id } = chosen;
  panel.busy(true);
  panel.fault("");
  try {
    const { data } = /** @type {Answer<Repaired>} */ (await post(`/data-issues/${id}/repair`, body));
    stopPlacing();
    const undo = () => settle(post(`/data-issues/${id}/undo`, { entries: data.entries }), t("Taken back."), id);
    toast(data.said, { label: t("Undo"), act: undo });
    await afterChange(id);
  } catch (error) {
    panel.fault(messageOf(error));
  } finally {
    panel.busy(false);
  }
}

/**
 * Carry out a decision on the chosen issue; `back(id)` undoes it.
 *
 * @param {(id: number) => Promise<unknown>} change
 * @param {string} words
 * @param {((id: number) => Promise<unknown>) | null} [back]
 */
async function act(change, words, back = null) {
  if (!chosen) return;
  const { id } = chosen;
  panel.busy(true);
  try {
    await change(id);
    toast(words, back && { label: t("Undo"), act: () => settle(back(id), t("On the open list again."), id) });
    await afterChange(id);
  } catch (error) {
    panel.fault(messageOf(error));
  } finally {
    panel.busy(false);
  }
}

/** @param {Promise<unknown>} promise @param {string} words @param {number} id */
async function settle(promise, words, id) {
  try {
    await promise;
    toast(words);
    await afterChange(id);
  } catch (error) {
    toast(messageOf(error));
  }
}

/** Reload the list and the map; the changed issue stays in view, so that its new state is seen. @param {number} id */
async function afterChange(id) {
  map.refreshTiles();
  layer.showRepair(map.map, null);
  await look();
  await load();
  if (chosen?.id === id) await refreshChosen();
}

/** @param {(count: number) => void} notify */
function startPlacing(notify) {
  placed = { positions: [], notify };
  layer.showPlaces(map.map, []);
  map.map.getCanvas().style.cursor = "crosshair";
}

function drawPlaces() {
  if (!placed) return;
  layer.showPlaces(map.map, placed.positions);
  placed.notify(placed.positions.length);
}

function stopPlacing() {
  if (!placed) return;
  placed = null;
  map.map.getCanvas().style.cursor = "";
  layer.showPlaces(map.map, []);
}

function placeCancel() {
  stopPlacing();
  panel.show(chosen);
}

map.map.on("click", (event) => {
  if (!placed) return;
  placed.positions.push([event.lngLat.lng, event.lngLat.lat].map((degrees) => Number(degrees.toFixed(7))));
  drawPlaces();
});
map.map.on("moveend", () => {
  if (list.filter.inView) load();
});

const showChosen = () => {
  const row = document.activeElement;
  if (!(row instanceof HTMLElement) || !row.classList.contains("issue-row")) return false;
  row.click();
  return true;
};

open({
  bindings: [
    { keys: ["/"], words: t("Find"), act: list.focusText },
    { keys: ["j"], words: t("Next issue"), act: () => list.step(1) },
    { keys: ["k"], words: t("Previous issue"), act: () => list.step(-1) },
    { keys: ["enter"], words: t("Show it on the map"), act: showChosen },
    { keys: ["escape"], act: () => (placed ? placeCancel() : chosen ? choose(null) : false) },
  ],
  async load() {
    layer.addTo(map.map);
    map.onRecolour(() => layer.recolour(map.map));
    await look();
    await load();
    const wanted = Number(new URLSearchParams(location.search).get("issue"));
    if (wanted) await choose(wanted, { stay: map.opensAtPlace });
    keepLooking();
  },
});
