/** The page of the fleet: UAVs, their types and bases; find, look, add, edit, retire, delete and bring back. */

import { ApiError, get, patch, post, remove, signInAddress } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { readPage, startChrome } from "../page/chrome.js";
import { say, toast } from "../page/toast.js";
import { createStore } from "../store.js";
import { t } from "../text.js";
import { createEditing, ifUnchanged } from "./editing.js";
import { IN_USE, mountFilters } from "./filters.js";
import { KINDS } from "./kinds.js";
import { mountPanel } from "./panel.js";
import { mountTable } from "./table.js";
import { mountUnknownVehicles } from "./unknown_vehicles.js";

const PAGE = 100;
const wide = matchMedia("(min-width: 1001px)");

const page = readPage();
const address = new URLSearchParams(location.search);
const store = createStore({
  tab: KINDS[address.get("tab")] ? address.get("tab") : "uavs",
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
});
let choosing = 0; // counts what was begun: an answer that comes after something else was begun is not shown
let map = null;
let ground = null;

const chosenRow = () =>
  store.state.chosen && (store.state[store.state.chosen.tab]?.find((row) => row.id === store.state.chosen.id) ?? null);

const filters = mountFilters(store, { onTab: turnTo, onChange: load });
const table = mountTable({
  canPlan: page.canPlan,
  onChoose: (id) => choose(store.state.tab, id),
  onNew: startNew,
  onClear: clearFilter,
});
const panel = mountPanel({
  canPlan: page.canPlan,
  acts: {
    back: close,
    edit: () => editing.start(chosenRow()),
    put,
    remove: takeOff,
    refresh: load,
    failed: tell,
    showUavs,
  },
});
const editing = createEditing({
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

function tell(error, again = load) {
  if (!(error instanceof ApiError)) throw error;
  store.update({ problem: { error, again } });
}

function problemNotice({ error, again }) {
  const way = error.isSignedOut
    ? h("a", { class: "text-button", href: signInAddress() }, t("Sign in"))
    : h(
        "button",
        { type: "button", class: "text-button", onclick: () => (store.update({ problem: null }), again()) },
        t("Try again"),
      );
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

// what is there

function uavsAddress() {
  const { text, state, type, base, tab } = store.state;
  const query = new URLSearchParams({ limit: PAGE });
  for (const [name, value] of Object.entries({ text: tab === "uavs" ? text : "", state, type, base }))
    if (value) query.set(name, value);
  return `/uavs?${query}`;
}

let asked = 0;
async function load() {
  const mine = ++asked;
  try {
    const [uavs, types, bases] = await Promise.all([
      get(uavsAddress()),
      get("/uav-types?limit=1000"),
      get("/bases?limit=1000"),
    ]);
    if (mine !== asked) return;
    store.update({
      uavs: uavs.data.features.map(KINDS.uavs.read),
      next: uavs.data.next,
      numbers: uavs.data.numbers,
      types: types.data.results,
      bases: bases.data.results,
      problem: null,
    });
  } catch (error) {
    tell(error);
  }
}

async function loadMore() {
  try {
    const { data } = await get(store.state.next);
    store.update({ uavs: [...store.state.uavs, ...data.features.map(KINDS.uavs.read)], next: data.next });
  } catch (error) {
    tell(error, loadMore);
  }
}

/** UAVs are filtered by the server; types and bases are few and all here. */
function shownRows({ tab, text, ...state }) {
  const wanted = text.toLocaleLowerCase();
  return tab === "uavs" || state[tab] === null
    ? state[tab]
    : state[tab].filter((row) => row.name.toLocaleLowerCase().includes(wanted));
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

function turnTo(tab) {
  if (tab === store.state.tab) return;
  close();
  store.update({ tab });
  remember();
  if (store.state.text) load();
}

function showUavs(tab, id) {
  turnTo("uavs");
  filters.set({ state: "all", type: tab === "types" ? `${id}` : "", base: tab === "bases" ? `${id}` : "" });
  load();
}

/** The address says what is looked at: it can be passed on. */
function remember() {
  const { tab, chosen } = store.state;
  const query = new URLSearchParams({ ...(tab === "uavs" ? {} : { tab }), ...(chosen ? { id: chosen.id } : {}) });
  history.replaceState(history.state, "", `${location.pathname}${query.size ? `?${query}` : ""}`);
}

// map

async function showMap() {
  const isSeen = wide.matches || byId("fleet-body").dataset.open;
  if (!isSeen || store.state.uavs === null) return;
  const { createFleetMap } = await import("./fleet_map.js");
  const onChoose = (tab, id) => (turnTo(tab), choose(tab, id));
  map ??= createFleetMap({ page, rows: store.state, ground, onChoose });
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

async function choose(tab, id, { keepFocus = false } = {}) {
  editing.leave();
  const mine = ++choosing;
  try {
    const { data } = await get(`${KINDS[tab].path}/${id}`);
    if (mine !== choosing) return;
    const row = KINDS[tab].read(data);
    const others = store.state[tab] ?? [];
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
    if (row.position) map?.look(row.position);
    if (!keepFocus) title.focus({ preventScroll: wide.matches });
    say(row.name);
  } catch (error) {
    if (error.status === 404) toast(t("It is no longer there."));
    else tell(error, () => choose(tab, id));
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
  if (id) byId("fleet-rows").querySelector(`a[href$="id=${id}"]`)?.focus({ preventScroll: true });
}

function startNew() {
  editing.leave();
  store.update({ chosen: null });
  editing.start(null);
}

// change

/** A refusal is told in a toast, with a way to what is there now where somebody was faster. */
async function attempt(change) {
  try {
    await change();
  } catch (error) {
    if (error.status === 412)
      toast(error.message, { label: t("Look"), act: () => choose(store.state.tab, store.state.chosen.id) });
    else if (error.status === 409) toast(error.message);
    else tell(error, () => attempt(change));
  }
}

/** The list and what is chosen, as they are now. */
async function refresh(id) {
  const moment = choosing;
  await load();
  if (moment === choosing && store.state.chosen?.id === id && !editing.isOpen())
    await choose(store.state.tab, id, { keepFocus: true });
}

function put(state) {
  const row = chosenRow();
  const words = {
    active: t("{name} is in service.", row),
    maintenance: t("{name} is in maintenance.", row),
    retired: t("{name} is retired.", row),
  }[state];
  return attempt(async () => {
    const { data } = await patch(`/uavs/${row.id}`, { state }, ifUnchanged(row));
    const takeBack = () =>
      attempt(
        async () => (
          await patch(`/uavs/${row.id}`, { state: row.state }, ifUnchanged(KINDS.uavs.read(data))),
          await refresh(row.id)
        ),
      );
    toast(words, { label: t("Undo"), act: takeBack });
    await refresh(row.id);
  });
}

function takeOff() {
  const { tab } = store.state;
  const row = chosenRow();
  const { path, deleted } = KINDS[tab];
  return attempt(async () => {
    await remove(`${path}/${row.id}`, ifUnchanged(row));
    close();
    await load();
    toast(deleted(row), {
      label: t("Undo"),
      act: () =>
        attempt(
          async () => (await post(`${path}/${row.id}/restore`), await load(), turnTo(tab), await choose(tab, row.id)),
        ),
    });
  });
}

addEventListener("beforeunload", (event) => {
  if (editing.isChanged()) event.preventDefault();
});
document.addEventListener("visibilitychange", () => document.visibilityState === "visible" && load()); // positions grow old while nobody looks
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
      act: () => (chosenRow() && !editing.isOpen() && page.canPlan ? void editing.start(chosenRow()) : false),
    },
    { keys: ["mod+s"], words: t("Save"), whileTyping: true, act: () => (editing.isOpen() ? editing.submit() : false) },
    {
      keys: ["escape"],
      words: t("A step back"),
      whileTyping: true,
      act: () => (editing.isOpen() ? editing.cancel() : store.state.chosen ? close() : false),
    },
  ],
});

async function start() {
  ground = await get("/ground").then(
    ({ data }) => data,
    () => null,
  );
  await load();
  if (page.role === "administrator")
    void mountUnknownVehicles({ onAdopted: async (id) => (await load(), turnTo("uavs"), choose("uavs", id)) });
  if (/^\d+$/.test(address.get("id") ?? ""))
    await choose(store.state.tab, Number(address.get("id")), { keepFocus: true });
  document.documentElement.dataset.loaded = "true";
}

start();
