/** The list of findings: filter, change the state, look again, export. */

import { ApiError, get, patch } from "../api.js";
import { byId, h, icon, setChildren } from "../dom.js";
import { readPage, startChrome } from "../page/chrome.js";
import { toast } from "../page/toast.js";
import { exportLink, lookAgain, severityMark } from "../photos/findings_list.js";
import { FINDING_STATES, SEVERITIES } from "../photos/words.js";
import { t, tn } from "../text.js";
import { calendarDay, dayText, whenText } from "../units.js";

/** @import { Answer } from "../api.js" */
/** @import { CategoryList, InspectionFinding, InspectionFindingPage } from "../api_types.d.ts" */

const PAGE = 50;
const UNSETTLED = "open,work_ordered,done";
const WAITING = "open,work_ordered"; // for work, so that they may be overdue
/** @type {[string, string][]} */
const STATES = [
  [UNSETTLED, t("Not settled")],
  ["open", FINDING_STATES.open],
  ["work_ordered", FINDING_STATES.work_ordered],
  ["done", FINDING_STATES.done],
  ["verified", FINDING_STATES.verified],
  ["", t("All")],
];
const BY_USERS = ["open", "work_ordered", "done", "rejected"];

/** @type {{ canPlan: boolean }} */
const page = readPage();
const asked = new URLSearchParams(location.search);
/** @type {InspectionFinding[]} */
let findings = [];
/** @type {string | null} */
let next = null;
/** @type {Set<string>} */
const chosen = new Set();
let turn = 0; // counts the lists that were asked for: a late answer of an earlier one is dropped

const severity = byId("finding-severity", HTMLSelectElement);
const category = byId("finding-category", HTMLSelectElement);
const overdue = byId("finding-overdue", HTMLInputElement);

const shownStates = () => asked.get("state") ?? UNSETTLED;
const isOverdue = (/** @type {InspectionFinding} */ { due_on: due, state }) =>
  due !== null && WAITING.includes(state) && due < today();

/** In the user's time zone, as the API writes days. */
const today = () => calendarDay(new Date());

/** The filters as the API takes them. */
function query() {
  const wanted = new URLSearchParams();
  const states = overdue.checked ? WAITING : shownStates();
  for (const [name, value] of Object.entries({
    state: states,
    severity: severity.value,
    category: category.value,
    due_before: overdue.checked ? today() : "",
  }))
    if (value) wanted.set(name, value);
  return wanted.toString();
}

/** @param {Record<string, string | null>} change of the page's address */
function ask(change) {
  for (const [name, value] of Object.entries(change)) {
    if (value === null) asked.delete(name);
    else asked.set(name, value);
  }
  history.replaceState(null, "", asked.size ? `?${asked}` : location.pathname);
  chosen.clear();
  drawFilters();
  return load();
}

async function load({ more = false } = {}) {
  const own = ++turn;
  const button = byId("findings-more", HTMLButtonElement);
  button.disabled = true;
  try {
    const address = more && next ? next : `/findings?${query()}&limit=${PAGE}`;
    const { data } = /** @type {Answer<InspectionFindingPage>} */ (await get(address));
    if (own !== turn) return;
    findings = more ? [...findings, ...data.results] : data.results;
    next = data.next;
    byId("findings-problem").replaceChildren();
    draw();
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    if (own === turn) drawProblem(error);
  } finally {
    if (own === turn) {
      byId("findings-loading").hidden = true;
      button.disabled = false;
    }
  }
}

/** @param {ApiError} error */
function drawProblem(error) {
  const again = h("button", { type: "button", class: "text-button", onclick: () => load() }, t("Load again"));
  const text = h("p", {}, h("strong", {}, t("Not loaded.")), ` ${error.message} `, again);
  byId("findings-problem").replaceChildren(
    h("div", { class: "notice critical", role: "alert" }, icon("circle-alert"), text),
  );
}

function drawFilters() {
  const states = byId("finding-states");
  const hadFocus = states.contains(document.activeElement);
  setChildren(
    states,
    states.querySelector("legend"),
    STATES.map(([value, words]) =>
      h(
        "label",
        {},
        h("input", {
          type: "radio",
          name: "finding-state",
          checked: shownStates() === value,
          disabled: overdue.checked,
          onchange: () => ask({ state: value }),
        }),
        h("span", { class: "segment" }, words),
      ),
    ),
  );
  if (hadFocus) /** @type {HTMLElement | null} */ (states.querySelector("input:checked"))?.focus();
}

function draw() {
  const isNone = findings.length === 0;
  byId("findings").hidden = isNone;
  byId("findings-empty").hidden = !isNone;
  byId("findings-end").hidden = isNone;
  byId("findings-more").hidden = next === null;
  const isFiltered = Boolean(severity.value || category.value || overdue.checked || asked.get("state"));
  setChildren(
    byId("findings-empty"),
    icon("circle-check"),
    h("strong", {}, isFiltered ? t("No finding matches these filters.") : t("No finding is left to settle.")),
    isFiltered
      ? h("button", { type: "button", class: "button", onclick: clearFilters }, t("Clear the filters"))
      : h("span", {}, t("Findings are made when photos of a mission or an asset are reviewed.")),
  );
  setChildren(
    byId("finding-heads"),
    page.canPlan && h("th", { scope: "col", class: "choice" }, h("span", { class: "unseen" }, t("Choose"))),
    h("th", { scope: "col" }, t("Severity")),
    h("th", { scope: "col" }, t("Finding")),
    h("th", { scope: "col" }, t("Asset")),
    h("th", { scope: "col" }, t("State")),
    h("th", { scope: "col" }, t("Due")),
    h("th", { scope: "col", class: "seen" }, t("Last seen")),
  );
  setChildren(byId("finding-rows"), findings.map(row));
  setChildren(
    byId("finding-files"),
    t("Export:"),
    exportLink("csv", "CSV", query()),
    exportLink("geojson", "GeoJSON", query()),
  );
  drawChosen();
}

/** @param {InspectionFinding} finding */
function row(finding) {
  const photo = finding.evidence[0]?.medium;
  const of = finding.mission ? `mission=${finding.mission}&` : finding.asset ? `asset=${finding.asset}&` : "";
  const facts = [`#${finding.number}`, finding.work_reference, finding.note].filter(Boolean).join(" · ");
  const box = h("input", {
    type: "checkbox",
    class: "check",
    checked: chosen.has(finding.id),
    "aria-label": t("Choose finding {number}", { number: finding.number }),
  });
  box.addEventListener("change", () => choose(finding.id, box.checked));
  return h(
    "tr",
    { dataset: { id: finding.id }, class: chosen.has(finding.id) && "chosen" },
    page.canPlan && h("td", { class: "choice" }, h("label", {}, box)),
    h("td", { class: "worst" }, severityMark(finding.severity)),
    h(
      "td",
      { class: "what" },
      photo
        ? h("a", { href: `/review?${of}medium=${photo}` }, finding.category_name)
        : h("strong", {}, finding.category_name),
      h("small", {}, facts),
    ),
    h(
      "td",
      { class: "asset", translate: "no" },
      finding.asset === null
        ? finding.asset_label
        : h("a", { href: `/assets?id=${finding.asset}` }, finding.asset_label || `#${finding.asset}`),
    ),
    h("td", { class: "state" }, page.canPlan ? stateSelect(finding) : FINDING_STATES[finding.state]),
    h("td", { class: "day", dataset: { name: t("Due") } }, finding.due_on && dueText(finding)),
    h("td", { class: "day seen", dataset: { name: t("Last seen") } }, whenText(finding.last_seen_at)),
  );
}

/** @param {InspectionFinding} finding */
function dueText(finding) {
  const day = dayText(/** @type {string} */ (finding.due_on));
  return isOverdue(finding)
    ? h("span", { class: "overdue" }, icon("clock-alert", "small"), t("overdue since {day}", { day }))
    : day;
}

/** @param {InspectionFinding} finding */
function stateSelect(finding) {
  const names = BY_USERS.includes(finding.state) ? BY_USERS : [finding.state, "open"];
  const select = h(
    "select",
    { class: "input", "aria-label": t("State of finding {number}", { number: finding.number }) },
    names.map((name) => h("option", { value: name, selected: name === finding.state }, FINDING_STATES[name])),
  );
  select.addEventListener("change", () => setState(finding, select));
  return select;
}

/** @param {InspectionFinding} finding @param {HTMLSelectElement} select */
async function setState(finding, select) {
  const before = finding.state;
  select.disabled = true;
  try {
    await change(finding, select.value);
    toast(t("Finding {number}: {state}", { number: finding.number, state: FINDING_STATES[select.value] }), {
      label: t("Undo"),
      act: () => undo(finding.id, before),
    });
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    toast(error.message);
    await load();
  } finally {
    select.disabled = false;
  }
}

/** @param {InspectionFinding} finding @param {string} state */
async function change(finding, state) {
  const { data } = /** @type {Answer<InspectionFinding>} */ (
    await patch(`/findings/${finding.id}`, { state }, { headers: { "If-Match": `"${finding.revision}"` } })
  );
  findings = findings.map((one) => (one.id === finding.id ? { ...one, ...data } : one));
  draw();
}

/** @param {string} id @param {string} state */
async function undo(id, state) {
  const finding = findings.find((one) => one.id === id);
  try {
    if (finding) await change(finding, state);
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    toast(error.message);
  }
}

/** @param {string} id @param {boolean} isChosen */
function choose(id, isChosen) {
  if (isChosen) chosen.add(id);
  else chosen.delete(id);
  drawChosen();
}

function drawChosen() {
  const picked = findings.filter(({ id }) => chosen.has(id));
  for (const element of /** @type {HTMLCollectionOf<HTMLElement>} */ (byId("finding-rows").children))
    element.classList.toggle("chosen", chosen.has(element.dataset.id ?? ""));
  const bar = byId("chosen-bar");
  bar.hidden = picked.length === 0;
  const none = () => {
    chosen.clear();
    draw();
  };
  setChildren(
    bar,
    h("strong", { role: "status" }, tn(picked.length, "{count} finding chosen", "{count} findings chosen")),
    lookAgain(picked),
    h("button", { type: "button", class: "button quiet", onclick: none }, t("Choose none")),
  );
}

function clearFilters() {
  severity.value = category.value = "";
  overdue.checked = false;
  return ask({ state: null, severity: null, category: null, overdue: null });
}

async function start() {
  const { data } = /** @type {Answer<CategoryList>} */ (await get("/finding-categories"));
  const option = (/** @type {string} */ value, /** @type {string} */ words) => h("option", { value }, words);
  setChildren(
    severity,
    option("", t("All severities")),
    Object.entries(SEVERITIES).map(([value, words]) => option(value, `${value} ${words}`)),
  );
  setChildren(
    category,
    option("", t("All categories")),
    data.categories.map(({ code, name }) => option(code, name)),
  );
  severity.value = asked.get("severity") ?? "";
  category.value = asked.get("category") ?? "";
  overdue.checked = asked.has("overdue");
  drawFilters();
  await load();
}

severity.addEventListener("change", () => ask({ severity: severity.value || null }));
category.addEventListener("change", () => ask({ category: category.value || null }));
overdue.addEventListener("change", () => ask({ overdue: overdue.checked ? "" : null }));
byId("findings-more").addEventListener("click", () => load({ more: true }));
startChrome({ bindings: [] });
try {
  await start();
} catch (error) {
  if (!(error instanceof ApiError)) throw error;
  byId("findings-loading").hidden = true;
  drawProblem(error);
}
document.documentElement.dataset.loaded = "true";
