/** The page of the fleet: UAVs, their types and bases; find, look, add, edit, retire, delete and bring back. */

import { ApiError, get, patch, post, remove, signInAddress } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { readPage, startChrome } from "../page/chrome.js";
import { say, toast } from "../page/toast.js";
import { createStore } from "../store.js";
import { t } from "../text.js";
import { bodies, BLANK, createForm } from "./forms.js";
import { KINDS } from "./kinds.js";
import { conflictNotice, mountPanel } from "./panel.js";
import { mountTable } from "./table.js";
import { STATES } from "./words.js";

const TYPING_MS = 250;
const PAGE = 100;
const IN_USE = ""; // all but the retired ones
const wide = matchMedia("(min-width: 1001px)");

const page = readPage();
const address = new URLSearchParams(location.search);
const store = createStore({
  tab: KINDS[address.get("tab")] ? address.get("tab") : "uavs", uavs: null, types: null, bases: null, numbers: null, next: null,
  text: "", state: IN_USE, type: "", base: "", chosen: null, problem: null,
});
let edit = null; // { tab, row or null, etag, form, began, key }
let map = null;
let ground = null;

const kindNow = () => KINDS[store.state.tab];
const rowNow = ({ tab, id }) => store.state[tab]?.find((row) => row.id === id) ?? null;
const etagOf = (row) => ({ headers: { "If-Match": `"${row.revision}"` } });

const table = mountTable({ canPlan: page.canPlan, onChoose: (id) => choose(store.state.tab, id), onNew: startNew, onClear: clearFilter });
const panel = mountPanel({ canPlan: page.canPlan, acts: { back: close, edit: () => startEdit(chosenRow()), put, remove: takeOff, refresh: load, failed: tell, showUavs } });

function chosenRow() {
  return store.state.chosen && rowNow(store.state.chosen);
}

// what went wrong, and what then

function tell(error, again = load) {
  if (!(error instanceof ApiError)) throw error;
  store.update({ problem: { error, again } });
}

store.listen(["problem"], ({ problem }) => {
  byId("fleet-problem").replaceChildren(
    ...(problem
      ? [
          h(
            "div",
            { class: "notice critical", role: "alert" },
            icon(problem.error.isAway ? "cloud-off" : "circle-alert"),
            h(
              "p",
              {},
              `${problem.error.message} `,
              problem.error.isSignedOut ? h("a", { class: "text-button", href: signInAddress() }, t("Sign in")) : h("button", { type: "button", class: "text-button", onclick: () => (store.update({ problem: null }), problem.again()) }, t("Try again")),
            ),
          ),
        ]
      : []),
  );
});

// what is there

function uavsAddress() {
  const { text, state, type, base, tab } = store.state;
  const query = new URLSearchParams({ limit: PAGE });
  if (tab === "uavs" && text) query.set("text", text);
  for (const [name, value] of Object.entries({ state, type, base })) if (value) query.set(name, value);
  return `/uavs?${query}`;
}

let asked = 0;
async function load() {
  const mine = ++asked;
  try {
    const [uavs, types, bases] = await Promise.all([get(uavsAddress()), get("/uav-types?limit=1000"), get("/bases?limit=1000")]);
    if (mine !== asked) return;
    store.update({
      uavs: uavs.data.features.map(KINDS.uavs.read), next: uavs.data.next, numbers: uavs.data.numbers, types: types.data.results, bases: bases.data.results, problem: null,
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

const shownRows = ({ tab, text, ...state }) => (tab === "uavs" ? state.uavs : (state[tab]?.filter((row) => row.name.toLocaleLowerCase().includes(text.toLocaleLowerCase())) ?? null));

store.listen(["tab", "uavs", "types", "bases", "chosen", "text", "next"], (state) => {
  const { tab, text, chosen } = state;
  const isFiltered = Boolean(text || (tab === "uavs" && (state.state || state.type || state.base)));
  table.draw({ kind: KINDS[tab], rows: shownRows(state), chosenId: chosen?.tab === tab ? chosen.id : null, next: tab === "uavs" ? state.next : null, isFiltered, text });
});

store.listen(["tab"], ({ tab }) => {
  byId("of-uavs").hidden = tab !== "uavs";
  const words = document.getElementById("new-words");
  if (words) words.textContent = KINDS[tab].one;
});

// filters

byId("fleet-tabs").append(
  ...Object.values(KINDS).map(({ tab, words }) =>
    h("label", {}, h("input", { type: "radio", name: "fleet-tab", value: tab, checked: store.state.tab === tab, onchange: () => turnTo(tab) }), h("span", { class: "segment" }, words, h("span", { class: "count" }))),
  ),
);

store.listen(["numbers", "types", "bases"], ({ numbers, types, bases }) => {
  const counts = { uavs: numbers && numbers.active + numbers.maintenance, types: types?.length, bases: bases?.length };
  for (const input of byId("fleet-tabs").querySelectorAll("input")) input.parentElement.querySelector(".count").textContent = counts[input.value] ?? "";
});

function options(select, chosen, choices) {
  select.replaceChildren(...choices.map(([value, words]) => h("option", { value: `${value}`, selected: `${value}` === chosen }, words)));
}

store.listen(["numbers", "types", "bases", "state", "type", "base"], ({ numbers, types, bases, state, type, base }) => {
  const counted = (words, count) => (numbers ? `${words} (${count})` : words);
  const of = (name) => numbers?.[name] ?? 0;
  options(byId("fleet-state"), state, [
    [IN_USE, counted(t("All but retired"), of("active") + of("maintenance"))],
    ...Object.entries(STATES).map(([value, { words }]) => [value, counted(words, of(value))]),
    ["all", counted(t("All"), of("active") + of("maintenance") + of("retired"))],
  ]);
  options(byId("fleet-type"), type, [["", t("Any type")], ...(types ?? []).map((row) => [row.id, row.name])]);
  options(byId("fleet-base"), base, [["", t("Any base")], ...(bases ?? []).map((row) => [row.id, row.name])]);
});

for (const name of ["state", "type", "base"]) {
  byId(`fleet-${name}`).addEventListener("change", (event) => {
    store.update({ [name]: event.target.value });
    load();
  });
}

let typing = 0;
byId("fleet-text").addEventListener("input", (event) => {
  store.update({ text: event.target.value.trim() });
  clearTimeout(typing);
  if (store.state.tab === "uavs") typing = setTimeout(load, TYPING_MS);
});

function clearFilter() {
  byId("fleet-text").value = "";
  store.update({ text: "", state: IN_USE, type: "", base: "" });
  load();
  byId("fleet-text").focus();
}

function turnTo(tab) {
  close();
  store.update({ tab });
  remember();
  if (store.state.text) load();
}

function showUavs(tab, id) {
  close();
  byId("fleet-text").value = "";
  store.update({ tab: "uavs", text: "", state: "all", type: tab === "types" ? `${id}` : "", base: tab === "bases" ? `${id}` : "" });
  byId("fleet-tabs").querySelector("input[value=uavs]").checked = true;
  remember();
  load();
}

/** The address says what is looked at: it can be passed on. */
function remember() {
  const { tab, chosen } = store.state;
  const query = new URLSearchParams();
  if (tab !== "uavs") query.set("tab", tab);
  if (chosen) query.set("id", chosen.id);
  history.replaceState(history.state, "", `${location.pathname}${query.size ? `?${query}` : ""}`);
}

// map

async function showMap() {
  const isSeen = wide.matches || byId("fleet-body").dataset.open;
  if (!isSeen || store.state.uavs === null) return;
  if (!map) {
    const { createFleetMap } = await import("./fleet_map.js");
    map ??= createFleetMap({ page, rows: store.state, ground, onChoose: (tab, id) => (tab === store.state.tab ? choose(tab, id) : (turnTo(tab), (byId("fleet-tabs").querySelector(`input[value=${tab}]`).checked = true), choose(tab, id))) });
  }
  map.show(store.state, store.state.chosen);
}

store.listen(["uavs", "bases", "chosen"], () => void showMap());
wide.addEventListener("change", () => void showMap());

// look

function open() {
  byId("fleet-body").dataset.open = "true";
  byId("fleet-side").dataset.panel = "true";
}

async function choose(tab, id, { keepFocus = false } = {}) {
  if (!leaveEdit()) return;
  try {
    const { data } = await get(`${KINDS[tab].path}/${id}`);
    const row = KINDS[tab].read(data);
    const others = store.state[tab] ?? [];
    const isListed = others.some((known) => known.id === row.id);
    open();
    store.update({ [tab]: isListed ? others.map((known) => (known.id === row.id ? row : known)) : [...others, row], chosen: { tab, id: row.id }, problem: null });
    const title = panel.show(KINDS[tab], row);
    remember();
    await showMap();
    if (row.position) map?.look(row.position);
    if (!keepFocus) title.focus({ preventScroll: wide.matches });
    say(row.name);
  } catch (error) {
    if (error.status === 404) toast(t("It is no longer there."));
    else tell(error, () => choose(tab, id));
  }
}

function close() {
  if (!leaveEdit()) return;
  const id = store.state.chosen?.id;
  delete byId("fleet-body").dataset.open;
  delete byId("fleet-side").dataset.panel;
  panel.close();
  store.update({ chosen: null });
  remember();
  if (id) byId("fleet-rows").querySelector(`a[href$="id=${id}"]`)?.focus({ preventScroll: true });
}

// change

/** words(row) for the toast, back(row) what takes it back. */
async function act(what, again) {
  try {
    return await what();
  } catch (error) {
    if (error.status === 412) toast(error.message, { label: t("Look"), act: () => choose(store.state.tab, store.state.chosen.id) });
    else if (error.status === 409) toast(error.message);
    else tell(error, again);
    return null;
  }
}

async function put(state) {
  const row = chosenRow();
  const before = row.state;
  await act(async () => {
    const { data } = await patch(`/uavs/${row.id}`, { state }, etagOf(row));
    const changed = KINDS.uavs.read(data);
    const words = { active: t("{name} is in service.", row), maintenance: t("{name} is in maintenance.", row), retired: t("{name} is retired.", row) }[state];
    toast(words, { label: t("Undo"), act: () => act(async () => (await patch(`/uavs/${row.id}`, { state: before }, etagOf(changed)), await again(row.id))) });
    await again(row.id);
  }, () => put(state));
}

/** The list and what is chosen, as they are now. */
async function again(id) {
  await load();
  if (store.state.chosen?.id === id) await choose(store.state.tab, id, { keepFocus: true });
}

async function takeOff() {
  const { tab } = store.state;
  const row = chosenRow();
  const kind = KINDS[tab];
  await act(async () => {
    await remove(`${kind.path}/${row.id}`, etagOf(row));
    close();
    await load();
    toast(kind.deleted(row), { label: t("Undo"), act: () => act(async () => (await post(`${kind.path}/${row.id}/restore`), await load(), await choose(tab, row.id))) });
  }, takeOff);
}

// edit

function startNew() {
  if (!leaveEdit()) return;
  store.update({ chosen: null });
  startEdit(null);
}

async function startEdit(row, kept = null) {
  const { tab, types, bases, uavs } = store.state;
  open();
  await showMap();
  const began = row ? bodies[tab](row) : { ...BLANK[tab] };
  if ("position" in began && !began.position) began.position = (await placeOfNew(bases, uavs)) ?? [0, 0];
  const form = createForm({
    tab, body: { ...began, ...kept?.body, from_type: [] }, types: types ?? [], bases: bases ?? [], isNew: !row, onMove: (position) => map?.movePin(position), onSave: save, onCancel: cancel,
  });
  edit = { tab, row, form, began: row ? form0(began) : form.body(), etag: kept?.etag ?? (row && etagOf(row)), key: crypto.randomUUID?.() ?? `${Date.now()}-${Math.random()}` };
  panel.edit(row ? t("Edit {name}", { name: row.name }) : kindNow().one, form);
  if (began.position) {
    map?.place(kept?.body.position ?? began.position, (position) => form.setPlace(position));
    map?.look(kept?.body.position ?? began.position);
  }
  map?.show(store.state, store.state.chosen);
  form.first.focus({ preventScroll: wide.matches });
}

const form0 = (body) => {
  const { from_type: _, ...rest } = body;
  return rest;
};

/** Where a new one stands at first: the middle of the map. */
async function placeOfNew(bases, uavs) {
  if (map) return map.centre();
  return bases?.[0]?.position ?? uavs?.[0]?.position ?? (page.extent && [(page.extent[0] + page.extent[2]) / 2, (page.extent[1] + page.extent[3]) / 2]);
}

const isSame = (a, b) => JSON.stringify(a) === JSON.stringify(b);
const changesOf = () => {
  const body = edit.form.body();
  return Object.fromEntries(Object.entries(body).filter(([name, value]) => !isSame(value, edit.began[name])));
};

/** Drops the edit, with a way back where something was changed. False while it is being stored. */
function leaveEdit() {
  if (!edit) return true;
  if (edit.isSaving) return false;
  const { tab, row, form, etag } = edit;
  const changed = Object.keys(changesOf()).length > 0;
  const kept = { body: form.body(), etag };
  edit = null;
  map?.place(null);
  if (changed) {
    toast(t("Your edit is dropped."), {
      label: t("Undo"),
      async act() {
        if (store.state.tab !== tab) turnTo(tab);
        byId("fleet-tabs").querySelector(`input[value=${tab}]`).checked = true;
        store.update({ chosen: row && { tab, id: row.id } });
        await startEdit(row, kept);
      },
    });
  }
  return true;
}

function cancel() {
  const { row, tab } = edit;
  if (!leaveEdit()) return;
  if (row) choose(tab, row.id);
  else close();
}

async function save() {
  const { tab, row, form, etag, key } = edit;
  const kind = KINDS[tab];
  const changes = changesOf();
  if (row && !Object.keys(changes).length) {
    cancel();
    return;
  }
  form.clear();
  edit.isSaving = true;
  form.busy(true);
  try {
    const { data } = row ? await patch(`${kind.path}/${row.id}`, changes, etag) : await post(kind.path, withoutNull(form.body()), { headers: { "Idempotency-Key": key } });
    edit = null;
    map?.place(null);
    toast(t("Saved."));
    await load();
    await choose(tab, data.id);
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    edit.isSaving = false;
    if (error.status < 500 && error.status) edit.key = crypto.randomUUID?.() ?? `${Date.now()}-${Math.random()}`;
    if (error.status === 412 && error.details?.current) settle(error.details, kind);
    else form.tell(error.isAway ? t("The server cannot be reached. What you typed stays here.") : error.message, error.details);
  } finally {
    form.busy(false);
  }
}

/** What a new row does not say is left to the server. */
const withoutNull = (body) => Object.fromEntries(Object.entries(body).filter(([, value]) => value !== null));

function settle({ current, changed_by }, kind) {
  const now = kind.read(current);
  const theirs = bodies[kind.tab](now);
  const { form, began } = edit;
  form.ask(
    conflictNotice({
      who: changed_by, seen: began, theirs, form,
      onTheirs() {
        edit = null;
        map?.place(null);
        load().then(() => choose(kind.tab, now.id));
      },
      onMine() {
        edit.etag = etagOf(now);
        save();
      },
    }),
  );
}

addEventListener("beforeunload", (event) => {
  if (edit && Object.keys(changesOf()).length) event.preventDefault();
});

document.getElementById("new-row")?.addEventListener("click", startNew);
byId("fleet-more").addEventListener("click", loadMore);

startChrome({
  bindings: [
    { keys: ["/"], words: t("Find in the fleet"), act: () => byId("fleet-text").focus() },
    { keys: ["j"], words: t("Next in the list"), act: () => table.step(1) },
    { keys: ["k"], words: t("Previous in the list"), act: () => table.step(-1) },
    { keys: ["c"], words: t("Add one"), act: () => (page.canPlan ? startNew() : false) },
    { keys: ["e"], words: t("Edit"), act: () => (chosenRow() && !edit && page.canPlan ? void startEdit(chosenRow()) : false) },
    { keys: ["mod+s"], words: t("Save"), whileTyping: true, act: () => (edit ? edit.form.element.requestSubmit() : false) },
    { keys: ["escape"], words: t("A step back"), whileTyping: true, act: () => (edit ? cancel() : store.state.chosen ? close() : false) },
  ],
});

async function start() {
  ground = await get("/ground").then(({ data }) => data, () => null);
  await load();
  if (/^\d+$/.test(address.get("id") ?? "")) await choose(store.state.tab, Number(address.get("id")), { keepFocus: true });
  document.documentElement.dataset.loaded = "true";
}

start();
