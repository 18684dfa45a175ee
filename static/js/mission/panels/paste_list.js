/** A dialog that takes a list of references, shows the assets found, and adds those. */

import { ApiError } from "../../api.js";
import { find, h, icon } from "../../dom.js";
import { open } from "../../page/keyboard.js";
import { t, tn } from "../../text.js";
import { nameOf, targetOfRow } from "../selection.js";
import { listIn, lookUp, MAX_REFS, rowsToAdd } from "../targets/list_reading.js";

/** @import { AssetKind, LookupResult } from "../../api_types.d.ts" */
/** @import { MissionActions } from "../types.d.ts" */

/** @returns {["" | AssetKind, string][]} */
const KINDS = () => [
  ["", t("Anything")],
  ["tower", t("Towers")],
  ["line", t("Lines")],
  ["railway", t("Railways")],
  ["bridge", t("Bridges")],
];
const MAX_FILE_LINES = 2_000_000;

/** @typedef {ReturnType<typeof rowsToAdd>[number]} Row */

/** @param {Row} row */
const targetOf = ({ external_id, ...row }) => ({ ...targetOfRow(row), ...(external_id ? { external_id } : {}) });

/** @param {MissionActions} actions */
export function askForList(actions) {
  const dialog = h("dialog", { class: "paste-list", "aria-labelledby": "paste-title" });
  const asking = new AbortController();
  const { form, words } = createForm({ showAnswer, signal: asking.signal, close: () => dialog.close() });

  /** @param {LookupResult[]} results @param {Map<string, string>} externalIds */
  function showAnswer(results, externalIds) {
    const content = answer(results, externalIds, {
      add(rows) {
        dialog.close();
        actions.addMany(rows.map(targetOf), (added) => t("{added} from the list.", { added }));
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
 * @param {{ showAnswer: (results: LookupResult[], externalIds: Map<string, string>) => void, signal: AbortSignal, close: () => void }} how
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
    const { refs, externalIds } = listIn(words.value);
    if (!refs.length || refs.length > MAX_REFS) {
      wrong.textContent = refs.length
        ? t("At most {most} references at once; these are {count}.", { most: MAX_REFS, count: refs.length })
        : t("Paste at least one reference.");
      words.focus();
      return;
    }
    wrong.textContent = "";
    go.setAttribute("aria-busy", "true");
    go.textContent = t("Looking…");
    try {
      showAnswer(await lookUp(refs, kind.value ? [/** @type {AssetKind} */ (kind.value)] : [], signal), externalIds);
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
    accept: ".txt,.csv,text/plain,text/csv",
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
 * Counts of references that were found, are ambiguous, or are unknown.
 *
 * @param {number} found
 * @param {number} several
 * @param {number} none
 */
const sentenceOf = (found, several, none) =>
  [
    found > 0 && tn(found, "{count} found", "{count} found"),
    several > 0 && tn(several, "{count} means several things", "{count} mean several things"),
    none > 0 && tn(none, "{count} not found", "{count} not found"),
  ]
    .filter(Boolean)
    .join(", ");

/**
 * What the references mean; of those with several meanings one is chosen.
 *
 * @param {LookupResult[]} results
 * @param {Map<string, string>} externalIds
 * @param {{ add: (rows: Row[]) => void, back: () => void }} acts
 */
function answer(results, externalIds, { add, back }) {
  /** @type {Map<string, string>} */
  const choices = new Map();
  const several = results.filter(({ match }) => match === "several");
  const none = results.filter(({ match }) => match === "none");
  const addButton = h("button", { type: "button", class: "button primary" });
  addButton.addEventListener("click", () => add(rowsToAdd(results, choices, externalIds)));
  const refresh = () => {
    const count = rowsToAdd(results, choices).length;
    addButton.textContent = count ? tn(count, "Add {count} target", "Add {count} targets") : t("Nothing to add");
    addButton.disabled = !count;
  };
  refresh();
  const sentence = sentenceOf(results.length - several.length - none.length, several.length, none.length);
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
