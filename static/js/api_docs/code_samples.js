/** Samples of code: one language for all of the page, and a button that copies. */

import { h, icon, segments, setChildren } from "../dom.js";
import { copyText } from "../page/clipboard.js";
import { announce, toast } from "../page/toast.js";
import { t } from "../text.js";

const KEPT_AS = "spanwise.api-language";
/** @type {[string, string][]} */
const LANGUAGES = [
  ["curl", "curl"],
  ["python", "Python"],
];

let count = 0;

/** Show the language that this browser had last. */
export function restoreLanguage() {
  let language = null;
  try {
    language = localStorage.getItem(KEPT_AS);
  } catch {
    /* storage is closed: curl */
  }
  showLanguage(language === "python" ? "python" : "curl");
}

/** @param {string} language */
function showLanguage(language) {
  document.documentElement.dataset.codeLanguage = language;
  /** @type {NodeListOf<HTMLInputElement>} */
  const choices = document.querySelectorAll(".api-sample input[type=radio]");
  for (const choice of choices) choice.checked = choice.value === language;
}

/** @param {string} language */
function choose(language) {
  try {
    localStorage.setItem(KEPT_AS, language);
  } catch {
    /* storage is closed: until the page is left */
  }
  showLanguage(language);
}

/** Put the choice of language and the copy button over a sample. @param {HTMLElement} sample with a `pre` for each language */
export function addSampleTools(sample) {
  const texts = /** @type {HTMLElement[]} */ ([...sample.querySelectorAll("pre")]);
  const copy = h("button", { type: "button", class: "button quiet" }, icon("copy", "small"), t("Copy"));
  copy.addEventListener("click", async () => {
    const [text] = texts.filter((each) => each.checkVisibility());
    if (await copyText(text.textContent ?? "")) {
      toast(t("Copied."));
      return;
    }
    getSelection()?.selectAllChildren(text);
    announce(t("It is selected. Copy it with Ctrl+C."));
  });
  const chosen = document.documentElement.dataset.codeLanguage ?? "curl";
  count += 1;
  const choice =
    texts.length > 1
      ? h(
          "fieldset",
          { class: "segments line" },
          h("legend", { class: "unseen" }, t("Language of the example")),
          segments(`sample-${count}`, LANGUAGES, chosen, choose),
        )
      : h("span", { class: "caption" }, "Python");
  sample.prepend(h("div", { class: "api-sample-tools" }, choice, copy));
}

/** A sample in both languages. @param {{ curl: string, python: string }} texts */
export function codeSample({ curl, python }) {
  const sample = h("div", { class: "api-sample" });
  setChildren(
    sample,
    h("pre", { dataset: { language: "curl" } }, h("code", {}, curl)),
    h("pre", { dataset: { language: "python" } }, h("code", {}, python)),
  );
  addSampleTools(sample);
  return sample;
}
