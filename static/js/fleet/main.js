/** The page of the fleet: UAVs, their types and bases; search, view, add, edit, retire, delete and restore. */

import { ApiError, get, patch, post, remove, signInAddress } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { readPage, startChrome } from "../page/chrome.js";
import { announce, toast } from "../page/toast.js";
import { createStore } from "../store.js";
import { t } from "../text.js";
import { Editing, ifUnchanged } from "./editing.js";
import { IN_USE, mountFilters } from "./filters.js";
import { KINDS } from "./kinds.js";
import { mountPanel } from "./panel.js";
import { mountTable } from "./table.js";
import { mountUnknownVehicles } from "./unknown_vehicles.js";
import { flat, readRow } from "./words.js";

/** @import { Answer } from "../api.js" */
/** @import { BasePage, UavCollection, UavFeature, UavState, UavTypePage } from "../api_types.d.ts" */
/** @import { FleetBase, FleetMap, FleetPage, FleetState, FleetType, Ground, Row, RowAnswer, Tab } from "./types.d.ts" */

const PAGE = 100;
const wide = matchMedia("(min-width: 1001px)");

/** @type {FleetPage} */
const page = readPage();
const address = new URLSearchParams(location.search);
const tabAsked = address.get("tab") ?? "";
/** @type {FleetState} */
const initial = {
  tab: tabAsked in KINDS ? /** @type {Tab} */ (tabAsked) : "uavs",
  uavs: null,
  types: null,
  bases: null,
  numbers: null,
  next: null,
  text: "",
  state: IN_USE,
  type: "",
  base: "",
  chosen: null,
  problem: null,
};
const store = createStore(initial);
let choosing = 0; // counts requests: an answer to an earlier one is not shown
/** @type {FleetMap | null} */
let map = null;
/** @type {Ground | null} */
let ground = null;

/** @param {Tab} tab @returns {readonly Row[] | null} */
const rowsOf = (tab) => store.state[tab];
const chosenRow = () => {
  const { chosen } = store.state;
  return (chosen && rowsOf(chosen.tab)?.find((row) => row.id === chosen.id)) ?? null;
};

const filters = mountFilters(store, { onTab: turnTo, onChange: load });
const table = mountTable({
  canPlan: page.canPlan,
  onChoose: (id) => choose(store.state.tab, id),
  onNew: startNew,
  onClear: clearFilter,
});
const panel = mountPanel({
  canPlan: page.canPlan,
  isAdministrator: page.role === "administrator",
  acts: {
    back: close,
    edit: () => editing.start(chosenRow()),
    put,
    remove: takeOff,
    refresh: load,
    failed: notify,
    showUavs,
    typeOf: (uav) => store.state.types?.find(({ id }) => id === uav.type),
    addCamera: (type, camera) => editing.addCamera(type, camera).catch(notify),
  },
});
const editing = new Editing({
  store,
  page,
  panel,
  isWide: () => wide.matches,
  open,
  map: () => map,
  showMap,
  turnTo,
  choose,
  close,
  load,
  moment: () => choosing,
});

// what went wrong, and what then

/** @param {unknown} error @param {() => unknown} [again] */
function notify(error, again = load) {
  if (!(error instanceof ApiError)) throw error;
  store.update({ problem: { error, again } });
}

/** @param {NonNullable<FleetState["problem"]>} problem */
function problemNotice({ error, again }) {
  const tryAgain = () => {
    store.update({ problem: null });
    return again();
  };
  const way = error.isSignedOut
    ? h("a", { class: "text-button", href: signInAddress() }, t("Sign in"))
    : h("button", { type: "button", class: "text-button", onclick: tryAgain }, t("Try again"));
  return h(
    "div",
    { class: "notice critical", role: "alert" },
    icon(error.isAway ? "cloud-off" : "circle-alert"),
    h("p", {}, `${error.message} `, way),
  );
}

store.listen(["problem"], ({ problem }) =>
  byId("fleet-problem").replaceChildren(...(problem ? [problemNotice(problem)] : [])),
);

// load

function uavsAddress() {
  const { text, state, type, base, tab } = store.state;
  const query = new URLSearchParams({ limit: `${PAGE}` });
  for (const [name, value] of Object.entries({ text: tab === "uavs" ? text : "", state, type, base }))
    if (value) query.set(name, value);
  return `/uavs?${query}`;
}

let asked = 0;
async function load() {
  const mine = ++asked;
  try {
    const [uavs, types, bases] = /** @type {[Answer<UavCollection>, Answer<UavTypePage>, Answer<BasePage>]} */ (
      await Promise.all([get(uavsAddress()), get("/uav-types?limit=1000"), get("/bases?limit=1000")])
    );
    if (mine !== asked) return;
    store.update({
      uavs: uavs.data.features.map(flat),
      next: uavs.data.next,
      numbers: uavs.data.numbers,
      types: /** @type {FleetType[]} */ (types.data.results),
      bases: /** @type {FleetBase[]} */ (bases.data.results),
      problem: null,
    });
  } catch (error) {
    notify(error);
  }
}

async function loadMore() {
  const { next } = store.state;
  if (!next) return;
  try {
    const { data } = /** @type {Answer<UavCollection>} */ (await get(next));
    store.update({ uavs: [...(store.state.uavs ?? []), ...data.features.map(flat)], next: data.next });
  } catch (error) {
    notify(error, loadMore);
  }
}

/**
 * UAVs are filtered by the server; types and bases are few and all here.
 *
 * @param {FleetState} state
 * @returns {Row[] | null}
 */
function shownRows({ tab, text, uavs, types, bases }) {
  if (tab === "uavs") return uavs;
  const wanted = text.toLocaleLowerCase();
  const rows = tab === "types" ? types : bases;
  return rows && /** @type {Row[]} */ (rows).filter((row) => row.name.toLocaleLowerCase().includes(wanted));
}

store.listen(["tab", "uavs", "types", "bases", "chosen", "text", "next"], (state) => {
  const { tab, text, chosen } = state;
  const isFiltered = Boolean(text || (tab === "uavs" && (state.state || state.type || state.base)));
  table.draw({
    kind: KINDS[tab],
    rows: shownRows(state),
    chosenId: chosen?.tab === tab ? chosen.id : null,
    next: tab === "uavs" ? state.next : null,
    isFiltered,
    text,
  });
  const words = document.getElementById("new-words");
  if (words) words.textContent = KINDS[tab].one;
});

function clearFilter() {
  filters.set({});
  load();
  filters.focus();
}

/** @param {Tab} tab */
function turnTo(tab) {
  if (tab === store.state.tab) return;
  close();
  store.update({ tab });
  remember();
  if (store.state.text) load();
}

/** The UAVs of a type or a base. @param {Tab} tab @param {number} id */
function showUavs(tab, id) {
  turnTo("uavs");
  filters.set({ state: "all", type: tab === "types" ? `${id}` : "", base: tab === "bases" ? `${id}` : "" });
  load();
}

/** Store the selection in the address, so that it can be shared. */
function remember() {
  const { tab, chosen } = store.state;
  const query = new URLSearchParams({ ...(tab === "uavs" ? {} : { tab }), ...(chosen ? { id: `${chosen.id}` } : {}) });
  history.replaceState(history.state, "", `${location.pathname}${query.size ? `?${query}` : ""}`);
}

// map

async function showMap() {
  const isSeen = wide.matches || byId("fleet-body").dataset.open;
  if (!isSeen || store.state.uavs === null) return;
  const { createFleetMap, loadMapLibrary } = await import("/static/js/fleet/fleet_map.js");
  await loadMapLibrary();
  map ??= createFleetMap({
    page,
    rows: store.state,
    ground,
    onChoose(tab, id) {
      turnTo(tab);
      return choose(tab, id);
    },
  });
  map.show(store.state, store.state.chosen);
}

store.listen(["uavs", "bases", "chosen"], () => void showMap());
wide.addEventListener("change", () => void showMap());

// look

function open() {
  choosing += 1;
  byId("fleet-body").dataset.open = "true";
  byId("fleet-side").dataset.panel = "true";
}

/** @param {Tab} tab @param {number} id @param {{ keepFocus?: boolean }} [how] @returns {Promise<void>} */
async function choose(tab, id, { keepFocus = false } = {}) {
  editing.leave();
  const mine = ++choosing;
  try {
    const { data } = /** @type {Answer<RowAnswer>} */ (await get(`${KINDS[tab].path}/${id}`));
    if (mine !== choosing) return;
    const row = readRow(data);
    const others = rowsOf(tab) ?? [];
    const isListed = others.some((known) => known.id === row.id);
    open();
    const shown = choosing;
    store.update({
      [tab]: isListed ? others.map((known) => (known.id === row.id ? row : known)) : [...others, row],
      chosen: { tab, id: row.id },
      problem: null,
    });
    const title = panel.show(KINDS[tab], row);
    remember();
    await showMap();
    if (shown !== choosing) return;
    if ("position" in row) map?.look(row.position);
    if (!keepFocus) title.focus({ preventScroll: wide.matches });
    announce(row.name);
  } catch (error) {
    if (error instanceof ApiError && error.status === 404) toast(t("It is no longer there."));
    else notify(error, () => choose(tab, id));
  }
}

function close() {
  editing.leave();
  choosing += 1;
  const id = store.state.chosen?.id;
  delete byId("fleet-body").dataset.open;
  delete byId("fleet-side").dataset.panel;
  panel.close();
  if (id) store.update({ chosen: null });
  if (wide.matches && store.state.uavs) map?.lookAtAll(store.state);
  remember();
  if (!id) return;
  const link = /** @type {HTMLElement | null} */ (byId("fleet-rows").querySelector(`a[href$="id=${id}"]`));
  link?.focus({ preventScroll: true });
}

function startNew() {
  editing.leave();
  store.update({ chosen: null });
  editing.start(null);
}

// change

/**
 * Show a refusal in a toast, with a link to the present version where another user was faster.
 *
 * @param {() => Promise<unknown>} change
 */
async function attempt(change) {
  try {
    await change();
  } catch (error) {
    const status = error instanceof ApiError ? error.status : 0;
    if (error instanceof ApiError && status === 412) toast(error.message, { label: t("Look"), act: lookAgain });
    else if (error instanceof ApiError && status === 409) toast(error.message);
    else notify(error, () => attempt(change));
  }
}

function lookAgain() {
  const { chosen } = store.state;
  return chosen && choose(chosen.tab, chosen.id);
}

/** Reload the list and the chosen row. @param {number} id */
async function refresh(id) {
  const moment = choosing;
  await load();
  if (moment === choosing && store.state.chosen?.id === id && !editing.isOpen)
    await choose(store.state.tab, id, { keepFocus: true });
}

/** Set the state of the chosen UAV. @param {UavState} state */
function put(state) {
  const row = chosenRow();
  if (!row || !("state" in row)) return;
  const { name } = row;
  const words = {
    active: t("{name} is in service.", { name }),
    maintenance: t("{name} is in maintenance.", { name }),
    retired: t("{name} is retired.", { name }),
  }[state];
  return attempt(async () => {
    const { data } = /** @type {Answer<UavFeature>} */ (await patch(`/uavs/${row.id}`, { state }, ifUnchanged(row)));
    const takeBack = () =>
      attempt(async () => {
        await patch(`/uavs/${row.id}`, { state: row.state }, ifUnchanged(data.properties));
        await refresh(row.id);
      });
    toast(words, { label: t("Undo"), act: takeBack });
    await refresh(row.id);
  });
}

function takeOff() {
  const { tab } = store.state;
  const row = chosenRow();
  if (!row) return;
  const { path, deleted } = KINDS[tab];
  return attempt(async () => {
    await remove(`${path}/${row.id}`, ifUnchanged(row));
    close();
    await load();
    toast(deleted(row), {
      label: t("Undo"),
      act: () =>
        attempt(async () => {
          await post(`${path}/${row.id}/restore`);
          await load();
          turnTo(tab);
          await choose(tab, row.id);
        }),
    });
  });
}

addEventListener("beforeunload", (event) => {
  if (editing.isChanged) event.preventDefault();
});
document.addEventListener("visibilitychange", () => {
  if (document.visibilityState === "visible") load(); // positions grow old while the page is hidden
});
document.getElementById("new-row")?.addEventListener("click", startNew);
byId("fleet-more").addEventListener("click", loadMore);

startChrome({
  bindings: [
    { keys: ["/"], words: t("Find in the fleet"), act: () => filters.focus() },
    { keys: ["j"], words: t("Next in the list"), act: () => table.step(1) },
    { keys: ["k"], words: t("Previous in the list"), act: () => table.step(-1) },
    { keys: ["c"], words: t("Add one"), act: () => (page.canPlan ? startNew() : false) },
    {
      keys: ["e"],
      words: t("Edit"),
      act: () => (chosenRow() && !editing.isOpen && page.canPlan ? void editing.start(chosenRow()) : false),
    },
    { keys: ["mod+s"], words: t("Save"), whileTyping: true, act: () => (editing.isOpen ? editing.submit() : false) },
    {
      keys: ["escape"],
      words: t("A step back"),
      whileTyping: true,
      act: () => (editing.isOpen ? editing.cancel() : store.state.chosen ? close() : false),
    },
  ],
});

async function start() {
  ground = await get("/ground").then(
    ({ data }) => /** @type {Ground} */ (data),
    () => null,
  );
  await load();
  if (page.role === "administrator")
    void mountUnknownVehicles({
      async onAdopted(id) {
        await load();
        turnTo("uavs");
        await choose("uavs", id);
      },
    });
  if (/^\d+$/.test(address.get("id") ?? ""))
    await choose(store.state.tab, Number(address.get("id")), { keepFocus: true });
  document.documentElement.dataset.loaded = "true";
}

start();
