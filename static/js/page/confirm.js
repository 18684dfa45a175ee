/** A question before an act that moves a UAV or binds a mission: what will happen, what then stays undone, and buttons that name the act. */

import { h, icon } from "../dom.js";
import { t } from "../text.js";
import { open } from "./keyboard.js";

/** @import { Question, QuestionChoices, QuestionField } from "../domain/command_questions.js" */

const EDGE_PX = 12;

/**
 * Asks, and resolves to what was filled in; null where the act is not to be done.
 *
 * @param {Question} question
 * @returns {Promise<Record<string, any> | null>}
 */
export function confirmAct(question) {
  const {
    title,
    lines,
    act,
    keep = t("Not yet"),
    field = null,
    choices = null,
    checks = [],
    safer = null,
    isDanger,
    isBack,
    image,
    opener,
  } = question;
  return new Promise((resolve) => {
    const input = field && fieldInput(field);
    const group = choices && choiceGroup(choices);
    const out = h(
      "button",
      { class: "button", value: "out", type: "button", onclick: () => dialog.close("out") },
      keep,
    );
    const rank = isDanger ? "danger filled" : safer ? "" : "primary";
    // Enter takes the first button that submits: not the act where there is a safer one.
    const straight = safer && { type: "button", onclick: () => dialog.close("go") };
    const go = h("button", { class: `button ${rank}`, value: "go", ...straight }, act);
    const better = safer && h("button", { class: "button primary", value: "safer" }, safer.words);
    const form = h(
      "form",
      { method: "dialog" },
      h(
        "div",
        { id: "confirm-lines", class: "confirm-lines" },
        lines.filter(Boolean).map((line) => h("p", {}, line)),
      ),
      group,
      input && h("div", { class: "field" }, h("label", { for: "confirm-field" }, field.label), input),
      checks.map(({ name, words }) =>
        h(
          "label",
          { class: "confirm-check" },
          h("input", { type: "checkbox", name, checked: true }),
          h("span", {}, words),
        ),
      ),
      h("div", { class: "acts" }, out, go, better),
    );
    /** @type {HTMLDialogElement} */
    const dialog = h(
      "dialog",
      { class: "confirm", "aria-labelledby": "confirm-title", "aria-describedby": "confirm-lines" },
      h("h2", { id: "confirm-title" }, image && icon(image), title),
      form,
    );
    dialog.addEventListener("close", () => {
      if (dialog.returnValue !== "go" && dialog.returnValue !== "safer") return resolve(null);
      const filled = input && { [field.name]: field.type === "number" ? input.valueAsNumber : input.value.trim() };
      const told = new FormData(form);
      resolve({
        ...filled,
        ...(choices && { [choices.name]: told.get(choices.name) }),
        ...Object.fromEntries(checks.map(({ name }) => [name, told.has(name)])),
        ...(dialog.returnValue === "safer" && { isSafer: true }),
      });
    });
    open(dialog);
    if (opener) growFrom(dialog, opener);
    const first = group?.querySelector("input");
    if (first) {
      const acts = [go, better].filter((button) => button !== null);
      for (const button of acts) {
        button.disabled = true;
        button.title = t("Choose whom it is for first.");
      }
      group?.addEventListener("change", () => {
        for (const button of acts) {
          button.disabled = false;
          button.removeAttribute("title");
        }
      });
    }
    (first ?? (input && field.isNeeded ? input : isBack ? (better ?? go) : out)).focus();
  });
}

/** @param {QuestionField} field */
function fieldInput(field) {
  return h("input", {
    class: "input",
    id: "confirm-field",
    name: field.name,
    type: field.type ?? "text",
    value: field.value ?? "",
    min: field.min,
    max: field.max,
    step: field.step,
    maxlength: field.type === "number" ? null : 300,
    required: field.isNeeded,
  });
}

/** Radios of which none is chosen: Enter does nothing before one is. @param {QuestionChoices} choices */
function choiceGroup({ name, legend, of }) {
  return h(
    "fieldset",
    { class: "confirm-choices" },
    h("legend", {}, legend),
    of.map(({ value, words, detail }) =>
      h(
        "label",
        {},
        h("input", { type: "radio", name, value, required: true }),
        h("span", {}, h("strong", {}, words), detail && h("small", {}, detail)),
      ),
    ),
  );
}

/**
 * Above its button where there is room, and never over the window's edge; a phone shows it in the middle.
 *
 * @param {HTMLDialogElement} dialog
 * @param {HTMLElement} opener
 */
function growFrom(dialog, opener) {
  if (matchMedia("(max-width: 720px)").matches) return;
  const box = opener.getBoundingClientRect();
  const middle = box.left + box.width / 2;
  const left = Math.min(Math.max(EDGE_PX, middle - dialog.offsetWidth / 2), innerWidth - dialog.offsetWidth - EDGE_PX);
  const above = box.top - dialog.offsetHeight - EDGE_PX;
  Object.assign(dialog.style, {
    margin: "0",
    left: `${left}px`,
    top: `${Math.max(EDGE_PX, above)}px`,
    transformOrigin: `${middle - left}px 100%`,
  });
  dialog.classList.add("grown");
}
