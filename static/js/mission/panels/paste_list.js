/** A dialog that takes a list of references, says which assets they mean, and adds those. */

import { ApiError } from "../../api.js";
import { h, icon } from "../../dom.js";
import { open } from "../../page/keyboard.js";
import { t, tn } from "../../text.js";
import { lookUp, MOST_REFS, refsIn, rowsToAdd } from "../list_reading.js";
import { nameOf, targetOfRow } from "../selection.js";

const KINDS = () => [
  ["", t("Anything")],
  ["tower", t("Towers")],
  ["line", t("Lines")],
  ["railway", t("Railways")],
  ["bridge", t("Bridges")],
];
const LONGEST_FILE = 2_000_000;

export function askForList(actions) {
  const dialog = h("dialog", { class: "paste-list", "aria-labelledby": "paste-title" });
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
  const file = h("input", {
    type: "file",
    accept: ".txt,.csv,text/plain,text/csv",
    class: "unseen",
    id: "paste-file",
    "aria-label": t("Take the list from a file"),
  });
  const wrong = h("p", { class: "field-error", role: "alert" });
  const go = h("button", { class: "button primary" }, t("Look them up"));
  const asking = new AbortController();

  async function ask(event) {
    event.preventDefault();
    const refs = refsIn(words.value);
    if (!refs.length || refs.length > MOST_REFS) {
      wrong.textContent = refs.length
        ? t("At most {most} references at once; these are {count}.", { most: MOST_REFS, count: refs.length })
        : t("Paste at least one reference.");
      words.focus();
      return;
    }
    wrong.textContent = "";
    go.setAttribute("aria-busy", "true");
    go.textContent = t("Looking…");
    try {
      answer(await lookUp(refs, kind.value ? [kind.value] : [], asking.signal));
    } catch (error) {
      if (error.name === "AbortError") return;
      wrong.textContent = error instanceof ApiError ? error.message : t("The list could not be looked up.");
    } finally {
      go.removeAttribute("aria-busy");
      go.textContent = t("Look them up");
    }
  }

  const form = h(
    "form",
    { onsubmit: ask },
    h("h2", { id: "paste-title" }, t("Paste a list")),
    h(
      "div",
      { class: "field" },
      h("label", { for: "paste-words" }, t("References, names or OSM ids")),
      words,
      h("p", { class: "caption", id: "paste-hint" }, t("One a line, or parted by commas, semicolons or tabs.")),
    ),
    h(
      "div",
      { class: "paste-row" },
      h("div", { class: "field" }, h("label", { for: "paste-kind" }, t("They are")), kind),
      h("button", { type: "button", class: "button", onclick: () => file.click() }, icon("file"), t("From a file")),
      file,
    ),
    wrong,
    h(
      "div",
      { class: "acts" },
      h("button", { type: "button", class: "button", onclick: () => dialog.close() }, t("Cancel")),
      go,
    ),
  );
  file.addEventListener("change", async () => {
    const [chosen] = file.files;
    if (!chosen) return;
    if (chosen.size > LONGEST_FILE) wrong.textContent = t("This file is too large for a list.");
    else words.value = await chosen.text();
    file.value = "";
  });

  function answer(results) {
    const choices = new Map();
    const several = results.filter(({ match }) => match === "several");
    const none = results.filter(({ match }) => match === "none");
    const foundCount = results.length - several.length - none.length;
    const add = h("button", { type: "button", class: "button primary", onclick: addThem });
    const refresh = () => {
      const count = rowsToAdd(results, choices).length;
      add.textContent = count ? tn(count, "Add {count} target", "Add {count} targets") : t("Nothing to add");
      add.disabled = !count;
    };

    function addThem() {
      const rows = rowsToAdd(results, choices);
      dialog.close();
      actions.addMany(rows.map(targetOfRow), (added) => t("{added} from the list.", { added }));
    }

    const sentence = [
      foundCount > 0 && tn(foundCount, "{count} found", "{count} found"),
      several.length && tn(several.length, "{count} means several things", "{count} mean several things"),
      none.length && tn(none.length, "{count} is not known", "{count} are not known"),
    ]
      .filter(Boolean)
      .join(", ");
    dialog.replaceChildren(
      h(
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
          h(
            "button",
            { type: "button", class: "button", onclick: () => (dialog.replaceChildren(form), words.focus()) },
            t("Back to the list"),
          ),
          add,
        ),
      ),
    );
    refresh();
    dialog.querySelector("h2").focus();
  }

  dialog.addEventListener("close", () => asking.abort());
  dialog.append(form);
  open(dialog);
  words.focus();
}

/** One reference with several meanings: leave it out, take one, or all that are listed. */
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
