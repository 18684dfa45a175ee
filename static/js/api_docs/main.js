/** The page of the API: the filter, the details of an operation as soon as it is opened, and links to one. */

import { ApiError, get } from "../api.js";
import { byId, find, h, icon } from "../dom.js";
import { startChrome } from "../page/chrome.js";
import { t, tn } from "../text.js";
import { addSampleTools, restoreLanguage } from "./code_samples.js";
import { operationDetails } from "./operation.js";

/** @import { Api } from "./schema.js" */

const reference = byId("reference");
const headings = /** @type {HTMLElement[]} */ ([...reference.querySelectorAll(".api-heading")]);
const groups = /** @type {HTMLDetailsElement[]} */ ([...reference.querySelectorAll(".api-group")]);
const rows = /** @type {HTMLElement[]} */ ([...reference.querySelectorAll(".api-operations > li")]);
const searched = new Map(rows.map((row) => [row, wordsOf(row)]));
const filter = byId("api-filter", HTMLInputElement);

/** @param {HTMLElement} row */
function wordsOf(row) {
  const group = row.closest(".api-group")?.querySelector(".api-group-title")?.textContent;
  return `${row.textContent} ${row.firstElementChild?.id} ${group}`.toLowerCase();
}

/** Those that were open before the filter opened others. @type {Set<HTMLDetailsElement> | null} */
let openBefore = null;

function applyFilter() {
  const words = filter.value.toLowerCase().split(/\s+/).filter(Boolean);
  const shown = new Set(rows.filter((row) => words.every((word) => searched.get(row)?.includes(word))));
  for (const row of rows) row.hidden = !shown.has(row);
  if (words.length) openBefore ??= new Set(groups.filter((group) => group.open));
  for (const group of groups) {
    const found = rows.filter((row) => shown.has(row) && group.contains(row)).length;
    const size = group.querySelectorAll(".api-operations > li").length;
    find(group, ".count").textContent = found < size ? `${found} / ${size}` : `${size}`;
    group.hidden = found === 0;
    if (openBefore) group.open = words.length ? !group.hidden : openBefore.has(group);
  }
  if (!words.length) openBefore = null;
  for (const heading of headings) heading.hidden = groups.every((group) => group.hidden || !heading.contains(group));
  byId("api-count").textContent = words.length
    ? tn(rows.length, "{found} of {count} operation", "{found} of {count} operations", { found: `${shown.size}` })
    : tn(rows.length, "{count} operation", "{count} operations");
  showNothingFound(shown.size === 0);
}

/** @param {boolean} isEmpty */
function showNothingFound(isEmpty) {
  const place = byId("api-nothing");
  place.hidden = !isEmpty;
  const clear = h("button", { type: "button", class: "button" }, t("Clear the filter"));
  clear.addEventListener("click", () => {
    filter.value = "";
    applyFilter();
    filter.focus();
  });
  place.replaceChildren(h("strong", {}, t("No operation matches “{text}”.", { text: filter.value.trim() })), clear);
}

/** @type {Promise<Api> | null} */
let document_ = null;

/** The OpenAPI document, requested once. @returns {Promise<Api>} */
function apiDocument() {
  document_ ??= get("/api/schema").then(({ data }) => /** @type {Api} */ (data));
  document_.catch(() => {
    document_ = null;
  });
  return document_;
}

/** @param {HTMLDetailsElement} operation */
async function showDetails(operation) {
  const place = find(operation, ".api-place", HTMLElement);
  if (place.childElementCount) return;
  place.replaceChildren(h("div", { class: "skeleton", role: "status", "aria-label": t("Loading…") }));
  try {
    const api = await apiDocument();
    const ways = Object.entries(api.paths).flatMap(([path, methods]) =>
      Object.entries(methods).map(([method, { operationId }]) => ({ path, method, operationId })),
    );
    const way = ways.find(({ operationId }) => operationId === operation.id);
    if (way) place.replaceChildren(operationDetails(api, way.path, way.method));
    else place.replaceChildren(h("p", { class: "notice warning" }, t("The API has changed. Load this page again.")));
  } catch (error) {
    if (!(error instanceof ApiError)) {
      place.replaceChildren();
      throw error;
    }
    const again = h("button", { type: "button", class: "text-button" }, t("Try again"));
    again.addEventListener("click", () => {
      place.replaceChildren();
      void showDetails(operation);
    });
    place.replaceChildren(
      h(
        "div",
        { class: "notice critical", role: "alert" },
        icon("circle-alert"),
        h("p", {}, `${error.message} `, again),
      ),
    );
  }
}

/** Open what the address names, and go there. */
function openNamed() {
  const named = document.getElementById(location.hash.slice(1)); // names of operations need no escapes
  if (!(named instanceof HTMLDetailsElement) || !reference.contains(named)) return;
  if (filter.value && named.closest("[hidden]")) {
    filter.value = "";
    applyFilter();
  }
  named.open = true;
  const group = /** @type {HTMLDetailsElement | null} */ (named.closest(".api-group"));
  if (group) group.open = true;
  named.scrollIntoView({ block: "start" });
  find(named, "summary", HTMLElement).focus({ preventScroll: true });
}

startChrome({ bindings: [{ keys: ["/"], words: t("Find an operation"), act: () => filter.focus() }] });
restoreLanguage();
for (const sample of document.querySelectorAll(".api-sample")) addSampleTools(/** @type {HTMLElement} */ (sample));
filter.addEventListener("input", applyFilter);
reference.addEventListener(
  "toggle",
  ({ target }) => {
    if (!(target instanceof HTMLDetailsElement) || !target.matches(".api-operation") || !target.open) return;
    if (location.hash !== `#${target.id}`) history.replaceState(null, "", `#${target.id}`);
    void showDetails(target);
  },
  true,
);
addEventListener("hashchange", openNamed);
applyFilter();
openNamed();
document.documentElement.dataset.loaded = "true";
