/** The list of missions: find, sort, open, rename, duplicate, delete and bring back. */

import { ApiError, get, patch, post, signInAddress } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { readPage, startChrome } from "../page/chrome.js";
import { toast } from "../page/toast.js";
import { createStore } from "../store.js";
import { t, tn } from "../text.js";
import { numberText } from "../units.js";
import { askedOf, countOfFields, isFiltered, NOTHING, nextOrder, PAGE_SIZE, requestOf, searchOf } from "./asked.js";
import { missionRow, STATES } from "./rows.js";

const COLUMNS = [
  { name: "", words: t("Drawing"), isUnseen: true },
  { name: "name", words: t("Mission") },
  { name: "state", words: t("State") },
  { name: "targets", words: t("Targets") },
  { name: "uavs", words: t("UAVs"), class: "uavs" },
  { name: "distance", words: t("Distance"), class: "number distance" },
  { name: "time", words: t("Time"), class: "number time" },
  { name: "changed", words: t("Changed"), class: "changed" },
  { name: "", words: t("More"), isUnseen: true },
];
const ORDERS = {
  "-changed": t("Last changed"),
  changed: t("First changed"),
  name: t("Name, A to Z"),
  "-name": t("Name, Z to A"),
  author: t("Author"),
  "-author": t("Author, Z to A"),
  state: t("State"),
  "-state": t("State, last first"),
  "-targets": t("Most targets"),
  targets: t("Fewest targets"),
  "-uavs": t("Most UAVs"),
  uavs: t("Fewest UAVs"),
  "-distance": t("Longest distance"),
  distance: t("Shortest distance"),
  "-time": t("Longest time"),
  time: t("Shortest time"),
};
const CHANGED = {
  "": t("at any time"),
  1: t("today"),
  7: t("in the last 7 days"),
  30: t("in the last 30 days"),
  between: t("between two days"),
};
const TYPING_MS = 250;

const page = readPage();
const parameters = new URLSearchParams(location.search);
const justDeleted = parameters.get("gone");
const store = createStore({
  asked: askedOf(location.search),
  missions: null,
  next: null,
  total: 0,
  byState: {},
  pages: [],
  chosen: new Set(),
  filters: { authors: [], uavs: [] },
  problem: null,
  isBusy: false,
});
const filter = byId("filter");

startChrome({ bindings: [{ keys: ["/"], words: t("Find a mission"), act: () => filter.focus() }] });

function tell(error, title) {
  if (!(error instanceof ApiError)) throw error;
  const isOut = error.isSignedOut;
  store.update({
    problem: isOut
      ? { title: t("You are signed out."), text: t("Sign in to go on."), isOut }
      : { title, text: error.message },
  });
}

// asking

let asking = null;

/** The page that an address of the API gives; of two at once the later one counts. */
async function load(address = requestOf(store.state.asked), pages = []) {
  asking?.abort();
  const mine = (asking = new AbortController());
  store.update({ isBusy: true });
  try {
    const { data } = await get(address, { signal: mine.signal });
    if (!data.results.length && pages.length) {
      await load(pages.at(-1), pages.slice(0, -1)); // the last one of the page is gone
      return;
    }
    store.update({
      missions: data.results,
      next: data.next,
      total: data.total,
      byState: data.by_state,
      pages,
      address,
      chosen: new Set(),
      problem: null,
    });
  } catch (error) {
    if (error.name !== "AbortError") tell(error, t("Not loaded."));
  } finally {
    if (asking === mine) store.update({ isBusy: false });
  }
}

const again = () => load(store.state.address, store.state.pages);

function ask(change) {
  const asked = { ...store.state.asked, ...change };
  store.update({ asked });
  history.replaceState(null, "", `/${searchOf(asked)}`);
  return load();
}

function clearFilters() {
  filter.focus();
  return ask({ ...NOTHING, order: store.state.asked.order });
}

async function loadFilters() {
  try {
    store.update({ filters: (await get("/missions/filters")).data });
  } catch (error) {
    tell(error, t("Not loaded."));
  }
}

// doing

async function rename(mission, name) {
  try {
    const { data } = await patch(
      `/missions/${mission.id}`,
      { name },
      { headers: { "If-Match": `"${mission.revision}"` } },
    );
    await again();
    toast(t("“{before}” is now “{name}”.", { before: mission.name, name: data.name }), {
      label: t("Undo"),
      act: () => rename({ ...mission, name: data.name, revision: data.revision }, mission.name),
    });
  } catch (error) {
    if (error.status !== 412) return tell(error, t("Not renamed."));
    await again();
    tell(new ApiError(t("Somebody has changed the mission since; this is how it is now.")), t("Not renamed."));
  }
}

async function duplicate(mission) {
  try {
    const { data } = await post(
      `/missions/${mission.id}/duplicate`,
      {},
      { headers: { "Idempotency-Key": crypto.randomUUID?.() ?? `${Date.now()}-${Math.random()}` } },
    );
    await again();
    toast(t("“{name}” is there.", { name: data.name }), {
      label: t("Open"),
      act: () => void (location.href = `/missions/${data.id}`),
    });
  } catch (error) {
    tell(error, t("Not duplicated."));
  }
}

/** Deletes or brings back; says how many, and why not where something is refused. */
async function doTo(missions, path, words, undo) {
  try {
    const { data } = await post(`/missions/${path}`, { missions: missions.map(({ id }) => id) });
    await again();
    const done = missions.filter(({ id }) => data.done.includes(id));
    if (done.length)
      toast(
        done.length === 1 ? words.one(done[0].name) : words.many(done.length),
        undo && { label: t("Undo"), act: () => undo(done) },
      );
    if (data.refused.length) {
      const [first] = data.refused;
      const name = missions.find(({ id }) => id === first.id)?.name ?? "";
      tell(
        new ApiError(`“${name}”: ${first.message}`),
        tn(data.refused.length, "{count} mission stays as it is.", "{count} missions stay as they are."),
      );
    }
  } catch (error) {
    tell(error, words.failed);
  }
}

const DELETED = {
  one: (name) => t("“{name}” is deleted.", { name }),
  many: (count) => tn(count, "{count} mission is deleted.", "{count} missions are deleted."),
  failed: t("Not deleted."),
};
const BACK = {
  one: (name) => t("“{name}” is back.", { name }),
  many: (count) => tn(count, "{count} mission is back.", "{count} missions are back."),
  failed: t("Not brought back."),
};
const removeAll = (missions) => doTo(missions, "delete", DELETED, bringBack);
const bringBack = (missions) => doTo(missions, "restore", BACK, null);

async function copyAddress(mission) {
  const address = `${location.origin}/missions/${mission.id}`;
  try {
    await navigator.clipboard.writeText(address);
    toast(t("The address of “{name}” is copied.", { name: mission.name }));
  } catch {
    toast(address); // without the clipboard: there to be marked and copied
  }
}

function choose(ids, isChosen) {
  const chosen = new Set(store.state.chosen);
  for (const id of ids) isChosen ? chosen.add(id) : chosen.delete(id);
  store.update({ chosen });
}

// drawing

function drawHeads({ asked, missions, chosen }) {
  const all = missions?.length > 0 && missions.every(({ id }) => chosen.has(id));
  const box =
    page.canPlan &&
    h(
      "th",
      { scope: "col", class: "choice" },
      h(
        "label",
        {},
        h("input", {
          type: "checkbox",
          class: "check",
          checked: all,
          "aria-label": t("Choose all on this page"),
          onchange: (event) =>
            choose(
              missions.map(({ id }) => id),
              event.target.checked,
            ),
        }),
      ),
    );
  const heads = COLUMNS.map(({ name, words, isUnseen, class: own }) => {
    if (isUnseen) return h("th", { scope: "col" }, h("span", { class: "unseen" }, words));
    const direction =
      asked.order.replace("-", "") !== name ? "none" : asked.order.startsWith("-") ? "descending" : "ascending";
    return h(
      "th",
      { scope: "col", class: own, "aria-sort": direction },
      h(
        "button",
        {
          type: "button",
          class: "sort",
          dataset: { column: name },
          onclick: () => ask({ order: nextOrder(asked.order, name) }),
        },
        words,
        direction !== "none" && icon(direction === "ascending" ? "chevron-up" : "chevron-down", "small"),
      ),
    );
  });
  const focused = document.activeElement?.dataset?.column;
  byId("heads").replaceChildren(...[box, ...heads].filter(Boolean));
  if (focused) byId("heads").querySelector(`[data-column=${focused}]`)?.focus();
}

function drawRows({ missions, chosen }) {
  if (missions === null) return;
  byId("rows").replaceChildren(
    ...missions.map((mission) =>
      missionRow(mission, {
        canPlan: page.canPlan,
        acts: {
          isChosen: chosen.has(mission.id),
          choose: (isChosen) => choose([mission.id], isChosen),
          rename: (name) => rename(mission, name),
          duplicate: () => duplicate(mission),
          remove: () => removeAll([mission]),
          restore: () => bringBack([mission]),
          copyAddress: () => copyAddress(mission),
        },
      }),
    ),
  );
}

/** What is ticked, without a new drawing of the rows: the tick keeps its focus. */
function drawChosen({ missions, chosen, asked }) {
  for (const row of byId("rows").children) {
    const box = row.querySelector(".choice input");
    if (box) box.checked = chosen.has(row.dataset.id);
    row.classList.toggle("chosen", chosen.has(row.dataset.id));
  }
  const picked = (missions ?? []).filter(({ id }) => chosen.has(id));
  const bar = byId("chosen-bar");
  bar.hidden = picked.length === 0;
  const act = asked.deleted
    ? h(
        "button",
        { type: "button", class: "button", onclick: () => bringBack(picked) },
        icon("archive-restore", "small"),
        t("Bring back"),
      )
    : h(
        "button",
        { type: "button", class: "button danger", onclick: () => removeAll(picked) },
        icon("trash-2", "small"),
        t("Delete"),
      );
  bar.replaceChildren(
    h("strong", { role: "status" }, tn(picked.length, "{count} mission chosen", "{count} missions chosen")),
    act,
    h(
      "button",
      {
        type: "button",
        class: "button quiet",
        onclick: () =>
          choose(
            picked.map(({ id }) => id),
            false,
          ),
      },
      t("Choose none"),
    ),
  );
}

function drawRest({ missions, next, total, pages, asked, problem, isBusy }) {
  byId("problem").replaceChildren(
    ...(problem
      ? [
          h(
            "div",
            { class: "notice critical", role: "alert" },
            icon("circle-alert"),
            h(
              "p",
              {},
              h("strong", {}, problem.title),
              ` ${problem.text} `,
              problem.isOut
                ? h("a", { class: "text-button", href: signInAddress() }, t("Sign in"))
                : missions === null &&
                    h("button", { type: "button", class: "text-button", onclick: () => load() }, t("Load again")),
            ),
          ),
        ]
      : []),
  );
  byId("missions").setAttribute("aria-busy", String(isBusy));
  byId("missions-loading").hidden = missions !== null || !isBusy;
  if (missions === null) return;
  byId("missions").hidden = missions.length === 0;
  byId("missions-empty").hidden = missions.length > 0;
  const isNone = !missions.length && !isFiltered(asked);
  for (const part of document.querySelectorAll(".filters, .more-filters"))
    part.hidden = isNone && !store.state.filters.authors.length && !asked.deleted;
  if (isNone) {
    empty(
      [h("strong", {}, t("No missions yet")), h("span", {}, t("Pick what to inspect and plan the first one."))],
      page.canPlan && h("a", { class: "button", href: "/missions/new" }, t("New mission")),
    );
  } else if (!missions.length) {
    const what = asked.text.trim()
      ? t("No mission matches “{text}”", { text: asked.text.trim() })
      : asked.deleted
        ? t("No mission is deleted")
        : t("No mission is like that");
    empty(
      [h("strong", {}, what)],
      h("button", { type: "button", class: "button", onclick: clearFilters }, t("Clear the filters")),
    );
  }
  byId("pager").hidden = missions.length === 0;
  const first = pages.length * PAGE_SIZE + 1;
  byId("how-many").textContent = t("{first} to {last} of {total}", {
    first: numberText(first),
    last: numberText(first + missions.length - 1),
    total: numberText(total),
  });
  byId("page-before").disabled = !pages.length;
  byId("page-after").disabled = next === null;
  document.querySelector(".pager-buttons").hidden = !pages.length && next === null;
}

function empty(words, action) {
  byId("missions-empty").replaceChildren(icon("clipboard-list", "large"), ...words, action || "");
}

/** All, then each state that occurs, with how many. */
function drawStates({ byState, asked }) {
  const total = Object.values(byState).reduce((sum, count) => sum + count, 0);
  const choices = [
    ["", t("All"), total],
    ...Object.entries(STATES).map(([value, words]) => [value, words, byState[value] ?? 0]),
  ];
  const fieldset = byId("states");
  const hadFocus = fieldset.contains(document.activeElement);
  fieldset.replaceChildren(
    fieldset.querySelector("legend"),
    ...choices
      .filter(([value, , count]) => count > 0 || value === "" || value === asked.state)
      .map(([value, words, count]) =>
        h(
          "label",
          {},
          h("input", {
            type: "radio",
            name: "state",
            value,
            checked: asked.state === value,
            onchange: () => ask({ state: value }),
          }),
          h("span", { class: "segment" }, words, h("span", { class: "count" }, numberText(count))),
        ),
      ),
  );
  if (hadFocus) fieldset.querySelector("input:checked")?.focus();
}

function options(select, choices, value) {
  select.replaceChildren(...choices.map(([own, words]) => h("option", { value: own }, words)));
  select.value = value;
}

function drawFields({ asked, filters }) {
  if (filter.value !== asked.text && document.activeElement !== filter) filter.value = asked.text;
  const counted = ({ name, missions }) => `${name} (${numberText(missions)})`;
  options(byId("order"), Object.entries(ORDERS), asked.order);
  options(
    byId("author"),
    [["", t("anybody")], ...filters.authors.map((author) => [author.name, counted(author)])],
    asked.author,
  );
  options(byId("uav"), [["", t("any")], ...filters.uavs.map((uav) => [String(uav.id), counted(uav)])], asked.uav);
  options(
    byId("changed"),
    ["", "1", "7", "30", "between"].map((value) => [value, CHANGED[value]]),
    asked.changed,
  );
  byId("days").hidden = asked.changed !== "between";
  byId("from-day").value = asked.from;
  byId("to-day").value = asked.to;
  byId("stale").checked = asked.stale;
  byId("deleted").checked = asked.deleted;
  const count = countOfFields(asked);
  byId("filter-count").textContent = count ? numberText(count) : "";
  if (count) byId("more-filters").open = true;
}

// listening

let typing = 0;
filter.addEventListener("input", () => {
  clearTimeout(typing);
  typing = setTimeout(() => ask({ text: filter.value }), TYPING_MS);
});
filter.addEventListener("keydown", (event) => {
  if (event.key !== "Escape") return;
  filter.value = "";
  clearTimeout(typing);
  ask({ text: "" });
});
for (const [id, name] of Object.entries({
  order: "order",
  author: "author",
  uav: "uav",
  changed: "changed",
  "from-day": "from",
  "to-day": "to",
}))
  byId(id).addEventListener("change", (event) => ask({ [name]: event.target.value }));
for (const name of ["stale", "deleted"])
  byId(name).addEventListener("change", (event) => ask({ [name]: event.target.checked }));
byId("clear-filters").addEventListener("click", () => {
  filter.value = "";
  clearFilters();
});
byId("page-after").addEventListener("click", () => load(store.state.next, [...store.state.pages, store.state.address]));
byId("page-before").addEventListener("click", () => load(store.state.pages.at(-1), store.state.pages.slice(0, -1)));

store.listen(["asked", "missions", "chosen"], drawHeads);
store.listen(["missions"], drawRows);
store.listen(["missions", "chosen", "asked"], drawChosen);
store.listen(["missions", "next", "total", "asked", "problem", "isBusy", "filters"], drawRest);
store.listen(["byState", "asked"], drawStates);
store.listen(["asked", "filters"], drawFields);

Promise.all([load(), loadFilters()]).then(() => {
  document.documentElement.dataset.loaded = "true";
  if (!justDeleted) return;
  toast(t("“{name}” is deleted.", { name: parameters.get("was") ?? "" }), {
    label: t("Undo"),
    act: () => bringBack([{ id: justDeleted, name: parameters.get("was") ?? "" }]),
  });
  history.replaceState(null, "", "/");
});
