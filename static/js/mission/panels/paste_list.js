/** A dialog that takes a list of references, shows the assets found, and adds those. */

import { ApiError } from "../../api.js";
import { find, h, icon } from "../../dom.js";
import { open } from "../../page/keyboard.js";
import { t, tn } from "../../text.js";
import { coordinateText, numberText } from "../../units.js";
import { nameOf, targetOfRow } from "../selection.js";
import { listIn, lookUp, MAX_REFS, placesToAdd, rowsToAdd, targetOfPlace } from "../targets/list_reading.js";

/** @import { AssetKind, LookupResult } from "../../api_types.d.ts" */
/** @import { List } from "../targets/list_reading.js" */
/** @import { Entry } from "../targets/file_reading.js" */
/** @import { MissionActions } from "../types.d.ts" */

/** @returns {["" | AssetKind, string][]} */
const KINDS = () => [
  ["", t("Anything")],
  ["tower", t("Towers")],
  ["line", t("Lines")],
  ["railway", t("Railways")],
  ["bridge", t("Bridges")],
];
const MAX_LISTED = 50;
const MAX_FILE_LINES = 2_000_000;

/** @typedef {ReturnType<typeof rowsToAdd>[number]} Row */

/** @param {Row} row */
const targetOf = ({ external_id, ...row }) => ({ ...targetOfRow(row), ...(external_id ? { external_id } : {}) });

/** @param {MissionActions} actions */
export function askForList(actions) {
  const dialog = h("dialog", { class: "paste-list", "aria-labelledby": "paste-title" });
  const asking = new AbortController();
  const { form, words } = createForm({ showAnswer, signal: asking.signal, close: () => dialog.close() });

  /** @param {LookupResult[]} results @param {List} list */
  function showAnswer(results, list) {
    const content = answer(results, list, {
      add(rows, places) {
        dialog.close();
        actions.addMany([...rows.map(targetOf), ...places.map(targetOfPlace)], (added) =>
          t("{added} from the list.", { added }),
        );
      },
      back() {
        dialog.replaceChildren(form);
        words.focus();
      },
    });
    dialog.replaceChildren(content);
    find(dialog, "h2", HTMLElement).focus();
  }

  dialog.addEventListener("close", () => asking.abort());
  dialog.append(form);
  open(dialog);
  words.focus();
}

/**
 * The form that takes the list.
 *
 * @param {{ showAnswer: (results: LookupResult[], list: List) => void, signal: AbortSignal, close: () => void }} how
 */
function createForm({ showAnswer, signal, close }) {
  const words = h("textarea", {
    class: "input",
    id: "paste-words",
    rows: "9",
    spellcheck: "false",
    autocomplete: "off",
    placeholder: "T-1041\nT-1042\nw23456789",
    "aria-describedby": "paste-hint",
  });
  const kind = h(
    "select",
    { class: "input", id: "paste-kind" },
    KINDS().map(([value, name]) => h("option", { value }, name)),
  );
  const wrong = h("p", { class: "field-error", role: "alert" });
  const file = fileInput(words, wrong);
  const go = h("button", { class: "button primary" }, t("Look them up"));

  async function ask() {
    const list = listIn(words.value);
    const { refs } = list;
    const count = Math.max(refs.length, list.places.length);
    if (!count || count > MAX_REFS) {
      wrong.textContent = count
        ? t("At most {most} references at once; these are {count}.", {
            most: numberText(MAX_REFS),
            count: numberText(count),
          })
        : list.format
          ? t("No point and no name was found: this is no {format} of places.", { format: list.format })
          : t("Paste at least one reference.");
      words.focus();
      return;
    }
    wrong.textContent = "";
    go.setAttribute("aria-busy", "true");
    go.textContent = t("Looking…");
    try {
      showAnswer(await lookUp(refs, kind.value ? [/** @type {AssetKind} */ (kind.value)] : [], signal), list);
    } catch (error) {
      if (error instanceof DOMException && error.name === "AbortError") return;
      wrong.textContent = error instanceof ApiError ? error.message : t("The list could not be looked up.");
    } finally {
      go.removeAttribute("aria-busy");
      go.textContent = t("Look them up");
    }
  }

  const form = h(
    "form",
    {},
    h("h2", { id: "paste-title" }, t("Paste a list")),
    h(
      "div",
      { class: "field" },
      h("label", { for: "paste-words" }, t("References, names or OSM ids")),
      words,
      h(
        "p",
        { class: "caption", id: "paste-hint" },
        t("One per line, or separated by commas, semicolons or tabs."),
        " ",
        t("With a first line “ref;external_id” it is a table, and targets get these ids."),
        " ",
        t("GeoJSON, KML and tables with columns lat and lon are read, too."),
      ),
    ),
    h(
      "div",
      { class: "paste-row" },
      h("div", { class: "field" }, h("label", { for: "paste-kind" }, t("Type")), kind),
      h("button", { type: "button", class: "button", onclick: () => file.click() }, icon("file"), t("From a file")),
      file,
    ),
    wrong,
    h("div", { class: "acts" }, h("button", { type: "button", class: "button", onclick: close }, t("Cancel")), go),
  );
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    void ask();
  });
  return { form, words };
}

/** The list out of a file. @param {HTMLTextAreaElement} words @param {HTMLElement} wrong */
function fileInput(words, wrong) {
  const input = h("input", {
    type: "file",
    accept: ".txt,.csv,.geojson,.json,.kml,text/plain,text/csv",
    class: "unseen",
    id: "paste-file",
    "aria-label": t("Take the list from a file"),
  });
  input.addEventListener("change", async () => {
    const chosen = input.files?.[0];
    if (!chosen) return;
    if (chosen.size > MAX_FILE_LINES) wrong.textContent = t("This file is too large for a list.");
    else words.value = await chosen.text();
    input.value = "";
  });
  return input;
}

/**
 * Counts of references that were found, are ambiguous, are known by their coordinates alone, or are unknown.
 *
 * @param {number} found
 * @param {number} several
 * @param {number} places
 * @param {number} none
 */
const sentenceOf = (found, several, places, none) =>
  [
    found > 0 && tn(found, "{count} found", "{count} found"),
    several > 0 && tn(several, "{count} means several things", "{count} mean several things"),
    places > 0 && tn(places, "{count} by coordinates", "{count} by coordinates"),
    none > 0 && tn(none, "{count} not found", "{count} not found"),
  ]
    .filter(Boolean)
    .join(", ");

/**
 * What the references mean; of those with several meanings one is chosen.
 *
 * @param {LookupResult[]} results
 * @param {List} list
 * @param {{ add: (rows: Row[], places: Entry[]) => void, back: () => void }} acts
 */
function answer(results, { externalIds, places: given, left }, { add, back }) {
  /** @type {Map<string, string>} */
  const choices = new Map();
  const several = results.filter(({ match }) => match === "several");
  const places = placesToAdd(given, results);
  const placed = new Set(places.map(({ ref }) => ref));
  const none = results.filter(({ ref, match }) => match === "none" && !placed.has(ref));
  const tick = h("input", { type: "checkbox", class: "check", checked: true });
  const wanted = () => (tick.checked ? places : []);
  const addButton = h("button", { type: "button", class: "button primary" });
  addButton.addEventListener("click", () => add(rowsToAdd(results, choices, externalIds), wanted()));
  const refresh = () => {
    const count = rowsToAdd(results, choices).length + wanted().length;
    addButton.textContent = count ? tn(count, "Add {count} target", "Add {count} targets") : t("Nothing to add");
    addButton.disabled = !count;
  };
  tick.addEventListener("change", refresh);
  refresh();
  const found = results.filter(({ match }) => match === "found").length;
  const sentence = sentenceOf(found, several.length, places.length, none.length);
  return h(
    "div",
    { class: "stack" },
    h("h2", { id: "paste-title", tabindex: "-1" }, `${sentence}.`),
    several.length > 0 &&
      h(
        "section",
        { "aria-label": t("Several meanings") },
        h("h3", {}, t("Which is meant?")),
        several.map((result) => choiceOf(result, choices, refresh)),
      ),
    places.length > 0 && placesPart(places, tick),
    left > 0 &&
      h(
        "p",
        { class: "caption" },
        tn(
          left,
          "{count} shape without a name is left out: points and names are read.",
          "{count} shapes without a name are left out: points and names are read.",
        ),
      ),
    none.length > 0 &&
      h(
        "section",
        { "aria-label": t("Not known") },
        h("h3", {}, t("Not in the data")),
        h("p", { class: "paste-unknown", tabindex: "0" }, none.map(({ ref }) => ref).join(", ")),
      ),
    h(
      "div",
      { class: "acts" },
      h("button", { type: "button", class: "button", onclick: back }, t("Back to the list")),
      addButton,
    ),
  );
}

/** Places that are no assets of the data. @param {Entry[]} places @param {HTMLInputElement} tick */
const placesPart = (places, tick) =>
  h(
    "section",
    { "aria-label": t("By coordinates") },
    h("h3", {}, t("Not in the data, but with coordinates")),
    h(
      "p",
      { class: "paste-unknown", tabindex: "0" },
      places
        .slice(0, MAX_LISTED)
        .map(({ ref, position }) => [ref, position && coordinateText(position)].filter(Boolean).join(" "))
        .join("; "),
      places.length > MAX_LISTED && " …",
    ),
    h("label", { class: "paste-places" }, tick, h("span", {}, t("Add them as places"))),
  );

/**
 * A reference with several matches: skip it, choose one, or all that are listed.
 *
 * @param {LookupResult} result
 * @param {Map<string, string>} choices
 * @param {() => void} refresh
 */
function choiceOf({ ref, count, assets }, choices, refresh) {
  const name =
    count > assets.length
      ? t("The first {count} of {all}", { count: assets.length, all: count })
      : tn(count, "All {count}", "All {count}");
  const select = h(
    "select",
    { class: "input" },
    h("option", { value: "" }, t("Leave out")),
    h("option", { value: "all" }, name),
    assets.map((asset) => h("option", { value: String(asset.id) }, nameOf(asset))),
  );
  select.addEventListener("change", () => {
    choices.set(ref, select.value);
    refresh();
  });
  return h("label", { class: "paste-choice" }, h("span", {}, ref), select);
}
