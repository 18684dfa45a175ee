/** The list of missions: find, sort, open, rename, duplicate, delete and bring back. */

import { signInAddress } from "../api.js";
import { byId, find, h, icon } from "../dom.js";
import { MISSION_STATES } from "../domain/planned_state.js";
import { readPage, startChrome } from "../page/chrome.js";
import { toast } from "../page/toast.js";
import { t, tn } from "../text.js";
import { numberText } from "../units.js";
import { copyAddress, createActs } from "./acts.js";
import { countOfFields, isFiltered, nextOrder, PAGE_SIZE } from "./asked.js";
import { showCampaigns } from "./campaigns.js";
import { createDemo } from "./demo.js";
import { createList } from "./list.js";
import { missionRow } from "./rows.js";
import { isTourSeen, startTour } from "./tour.js";

/** @import { TextName } from "./asked.js" */
/** @import { ListState } from "./list.js" */

/** @type {{ name: string, words: string, class?: string, isUnseen?: boolean }[]} */
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
/** @type {[string, string][]} */
const CHANGED = [
  ["", t("at any time")],
  ["1", t("today")],
  ["7", t("in the last 7 days")],
  ["30", t("in the last 30 days")],
  ["between", t("between two days")],
];
const TYPING_MS = 250;

/** @type {{ canPlan: boolean, canCurate: boolean, role: string, userId: number }} */
const page = readPage();
const isAdministrator = page.role === "administrator";
const parameters = new URLSearchParams(location.search);
const justDeleted = parameters.get("gone");
const list = createList();
const { store, load, ask, choose } = list;
const { rename, duplicate, removeAll, bringBack } = createActs(list);
const demo = createDemo({ reload: list.reload, showProblem: list.showProblem, canChange: isAdministrator });
const filter = byId("filter", HTMLInputElement);

startChrome({ bindings: [{ keys: ["/"], words: t("Find a mission"), act: () => filter.focus() }] });

function clearFilters() {
  filter.focus();
  return list.clearFilters();
}

// drawing

/** @param {ListState} state */
function headOfChoices({ missions, chosen }) {
  const ids = (missions ?? []).map(({ id }) => id);
  const box = h("input", {
    type: "checkbox",
    class: "check",
    checked: ids.length > 0 && ids.every((id) => chosen.has(id)),
    "aria-label": t("Choose all on this page"),
  });
  box.addEventListener("change", () => choose(ids, box.checked));
  return h("th", { scope: "col", class: "choice" }, h("label", {}, box));
}

/** @param {ListState} state */
function drawHeads(state) {
  const { asked } = state;
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
  const focused = document.activeElement instanceof HTMLElement ? document.activeElement.dataset.column : "";
  byId("heads").replaceChildren(...(page.canPlan ? [headOfChoices(state)] : []), ...heads);
  if (focused) find(byId("heads"), `[data-column=${focused}]`, HTMLElement).focus();
}

/** @param {ListState} state */
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

/** Show the chosen missions without redrawing the rows: the check box keeps its focus. @param {ListState} state */
function drawChosen({ missions, chosen, asked }) {
  for (const row of /** @type {HTMLCollectionOf<HTMLElement>} */ (byId("rows").children)) {
    const isChosen = chosen.has(row.dataset.id ?? "");
    const box = /** @type {HTMLInputElement | null} */ (row.querySelector(".choice input"));
    if (box) box.checked = isChosen;
    row.classList.toggle("chosen", isChosen);
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

/** @param {ListState} state */
function drawProblem({ problem, missions }) {
  if (!problem) {
    byId("problem").replaceChildren();
    return;
  }
  const { title, text, isOut } = problem;
  const wayOut = isOut
    ? h("a", { class: "text-button", href: signInAddress() }, t("Sign in"))
    : missions === null &&
      h("button", { type: "button", class: "text-button", onclick: () => load() }, t("Load again"));
  byId("problem").replaceChildren(
    h(
      "div",
      { class: "notice critical", role: "alert" },
      icon("circle-alert"),
      h("p", {}, h("strong", {}, title), ` ${text} `, wayOut),
    ),
  );
}

/** @param {ListState} state */
function drawRest({ missions, next, total, pages, asked, filters, deletedCount, isBusy }) {
  byId("missions").setAttribute("aria-busy", String(isBusy));
  byId("missions-loading").hidden = missions !== null || !isBusy;
  if (missions === null) return;
  byId("missions").hidden = missions.length === 0;
  byId("missions-empty").hidden = missions.length > 0;
  const isNone = !missions.length && !isFiltered(asked);
  for (const part of /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll(".filters, .more-filters")))
    part.hidden = isNone && !filters.authors.length && !deletedCount;
  if (isNone) {
    drawFirst();
  } else if (!missions.length) {
    const what = asked.text.trim()
      ? t("No mission matches “{text}”", { text: asked.text.trim() })
      : asked.deleted
        ? t("No mission is deleted")
        : t("No mission is like that");
    drawEmpty(
      h("strong", {}, what),
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
  byId("page-before", HTMLButtonElement).disabled = !pages.length;
  byId("page-after", HTMLButtonElement).disabled = next === null;
  find(document, ".pager-buttons", HTMLElement).hidden = !pages.length && next === null;
}

/** The first steps of an installation without missions. */
function drawFirst() {
  drawEmpty(
    h("strong", {}, t("No missions yet")),
    h("span", {}, t("Pick what to inspect and plan the first one.")),
    h(
      "div",
      { class: "first-steps" },
      page.canPlan && h("a", { class: "button", href: "/missions/new" }, icon("plus", "small"), t("New mission")),
      isAdministrator &&
        demo.known()?.can_be_made &&
        h(
          "button",
          { type: "button", class: "button", onclick: demo.make },
          icon("play", "small"),
          t("Show demo missions"),
        ),
      page.canCurate &&
        h("a", { class: "button", href: "/imports" }, icon("upload", "small"), t("Import your network")),
      isAdministrator && h("a", { class: "button", href: "/uavs" }, icon("radio", "small"), t("Connect a UAV")),
    ),
  );
}

/** @param {...(HTMLElement | false)} parts */
function drawEmpty(...parts) {
  byId("missions-empty").replaceChildren(icon("clipboard-list", "large"), ...parts.filter((part) => part !== false));
}

const DELETED = "deleted"; // beside the states of missions

/** Filters by state: all, then each state that occurs, then deleted ones, with counts. @param {ListState} state */
function drawStates({ byState, deletedCount, asked }) {
  const total = Object.values(byState).reduce((sum, count) => sum + count, 0);
  const chosen = asked.deleted ? DELETED : asked.state;
  const choices = [
    { value: "", words: t("All"), count: asked.deleted && !total ? null : total }, // not known on a page of deleted ones alone
    ...Object.entries(MISSION_STATES).map(([value, words]) => ({ value, words, count: byState[value] ?? 0 })),
    { value: DELETED, words: t("Deleted"), count: deletedCount },
  ];
  const fieldset = byId("states");
  const hadFocus = fieldset.contains(document.activeElement);
  fieldset.replaceChildren(
    find(fieldset, "legend"),
    ...choices
      .filter(({ value, count }) => count || value === "" || value === chosen)
      .map(({ value, words, count }) =>
        h(
          "label",
          {},
          h("input", {
            type: "radio",
            name: "state",
            value,
            checked: value === chosen,
            onchange: () => ask({ state: value === DELETED ? "" : value, deleted: value === DELETED }),
          }),
          h("span", { class: "segment" }, words, count !== null && h("span", { class: "count" }, numberText(count))),
        ),
      ),
  );
  if (hadFocus) /** @type {HTMLElement | null} */ (fieldset.querySelector("input:checked"))?.focus();
}

/** @param {string} id of the select @param {(readonly [string, string])[]} choices @param {string} value */
function fillSelect(id, choices, value) {
  const select = byId(id, HTMLSelectElement);
  select.replaceChildren(...choices.map(([own, words]) => h("option", { value: own }, words)));
  select.value = value;
}

/** @param {ListState} state */
function drawFields({ asked, filters }) {
  if (filter.value !== asked.text && document.activeElement !== filter) filter.value = asked.text;
  fillSelect("order", Object.entries(ORDERS), asked.order);
  fillSelect(
    "author",
    [["", t("anybody")], ...filters.authors.map(({ name, missions }) => counted(name, name, missions))],
    asked.author,
  );
  fillSelect(
    "uav",
    [["", t("any")], ...filters.uavs.map(({ id, name, missions }) => counted(String(id), name, missions))],
    asked.uav,
  );
  fillSelect("changed", CHANGED, asked.changed);
  byId("days").hidden = asked.changed !== "between";
  byId("from-day", HTMLInputElement).value = asked.from;
  byId("to-day", HTMLInputElement).value = asked.to;
  byId("stale", HTMLInputElement).checked = asked.stale;
  const count = countOfFields(asked);
  byId("filter-count").textContent = count ? numberText(count) : "";
  if (count) byId("more-filters", HTMLDetailsElement).open = true;
}

/** @param {string} value @param {string} name @param {number} missions @returns {[string, string]} */
const counted = (value, name, missions) => [value, `${name} (${numberText(missions)})`];

// listening

/** @type {ReturnType<typeof setTimeout> | undefined} */
let typing;
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
/** @type {Record<string, TextName>} */
const FIELDS = {
  order: "order",
  author: "author",
  uav: "uav",
  changed: "changed",
  "from-day": "from",
  "to-day": "to",
};
for (const [id, name] of Object.entries(FIELDS)) {
  const field = /** @type {HTMLInputElement | HTMLSelectElement} */ (byId(id));
  field.addEventListener("change", () => ask({ [name]: field.value }));
}
const stale = byId("stale", HTMLInputElement);
stale.addEventListener("change", () => ask({ stale: stale.checked }));
byId("clear-filters").addEventListener("click", () => {
  filter.value = "";
  clearFilters();
});
byId("page-after").addEventListener("click", () =>
  load(store.state.next ?? undefined, [...store.state.pages, store.state.address]),
);
byId("page-before").addEventListener("click", () => load(store.state.pages.at(-1), store.state.pages.slice(0, -1)));

store.listen(["asked", "missions", "chosen"], drawHeads);
store.listen(["missions"], drawRows);
store.listen(["missions", "chosen", "asked"], drawChosen);
store.listen(["missions", "problem"], drawProblem);
store.listen(["missions", "next", "total", "asked", "isBusy", "filters", "deletedCount"], drawRest);
store.listen(["byState", "deletedCount", "asked"], drawStates);
store.listen(["asked", "filters"], drawFields);

demo.listen(() => drawRest(store.state));
showCampaigns().catch(() => {}); // the list of missions says what is wrong
Promise.all([load(), list.loadFilters(), demo.load()]).then(() => {
  document.documentElement.dataset.loaded = "true";
  const isAsked = parameters.has("tour");
  if (isAsked || (demo.known()?.missions && !isTourSeen(page.userId)))
    startTour({ userId: page.userId, takesFocus: isAsked });
  if (isAsked) history.replaceState(null, "", "/");
  if (!justDeleted) return;
  toast(t("“{name}” is deleted.", { name: parameters.get("was") ?? "" }), {
    label: t("Undo"),
    act: () => bringBack([{ id: justDeleted, name: parameters.get("was") ?? "" }]),
  });
  history.replaceState(null, "", "/");
});
