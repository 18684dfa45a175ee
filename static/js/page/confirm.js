/** A question before an act that moves a UAV or binds a mission: what will happen, what then stays undone, and buttons that name the act. */

import { h, icon } from "../dom.js";
import { t } from "../text.js";
import { open } from "./keyboard.js";

/** @import { Question, QuestionChoices, QuestionField } from "../domain/command_questions.js" */

const EDGE_PX = 12;

/**
 * Ask for confirmation. Resolves to the values filled in; null where the user cancels. `safer` of the answer is the alternative act.
 *
 * @param {Question} question
 * @returns {Promise<Record<string, any> | null>}
 */
export function confirmAct(question) {
  const {
    title,
    field = null,
    option = null,
    choices = null,
    checks = [],
    isBack,
    image,
    opener,
    later,
    overtaken,
  } = question;
  return new Promise((resolve) => {
    const fields = [field, option].flatMap((one) => (one ? [{ ...one, input: fieldInput(one) }] : []));
    const group = choices && choiceGroup(choices);
    const lines = h("div", { id: "confirm-lines", class: "confirm-lines", "aria-live": "polite" });
    const acts = createActs(question, (value) => dialog.close(value));
    const form = h(
      "form",
      { method: "dialog" },
      lines,
      group,
      fields.map(({ input, label }) => h("div", { class: "field" }, h("label", { for: input.id }, label), input)),
      checks.map(checkLine),
      acts.element,
    );
    /** @type {HTMLDialogElement} */
    const dialog = h(
      "dialog",
      { class: "confirm", "aria-labelledby": "confirm-title", "aria-describedby": "confirm-lines" },
      h("h2", { id: "confirm-title" }, image && icon(image), title),
      form,
    );
    /** @param {Pick<Question, "lines" | "act" | "safer">} shown */
    function show(shown) {
      const said = shown.lines.filter((line) => line);
      lines.replaceChildren(...said.map((line) => (line instanceof Element ? line : h("p", {}, line))));
      acts.show(shown);
    }
    show(question);
    dialog.addEventListener("close", () => {
      if (dialog.returnValue !== "go" && dialog.returnValue !== "safer") return resolve(null);
      const reported = new FormData(form);
      resolve({
        ...Object.fromEntries(fields.map(({ name, input }) => [name, filledIn(input)])),
        ...(choices && { [choices.name]: reported.get(choices.name) }),
        ...Object.fromEntries(checks.map(({ name }) => [name, reported.has(name)])),
        ...(dialog.returnValue === "safer" && { safer: acts.safer() }),
      });
    });
    open(dialog);
    if (opener) growFrom(dialog, opener);
    const first = group?.querySelector("input");
    if (first) {
      acts.block(t("Choose whom it is for first."));
      group?.addEventListener("change", () => acts.block(""));
    }
    const needed = fields.find(({ isNeeded }) => isNeeded)?.input;
    (first ?? needed ?? (isBack ? acts.first() : acts.out)).focus();
    let isOver = false;
    later?.then((found) => dialog.open && !isOver && show(found));
    overtaken?.then((why) => {
      if (!dialog.open) return;
      isOver = true;
      lines.replaceChildren(h("p", {}, why));
      for (const part of form.querySelectorAll("fieldset, .field, .confirm-check")) part.remove();
      acts.end();
    });
  });
}

/**
 * The buttons: cancel, the act, and a safer alternative, which may arrive later.
 *
 * @param {Question} question
 * @param {(value: string) => void} close
 */
function createActs({ keep = t("Cancel"), hint = "", isDanger }, close) {
  const out = h("button", { class: "button", value: "out", type: "button", onclick: () => close("out") }, keep);
  /** @param {Event} event */
  const goes = ({ currentTarget }) => /** @type {HTMLButtonElement} */ (currentTarget).type === "button" && close("go");
  const go = h("button", { value: "go", onclick: goes });
  const better = h("button", { class: "button primary", value: "safer" });
  const element = h("div", { class: "acts" }, out, go);
  /** @type {Question["safer"]} */
  let safer = null;
  let why = "";

  function draw() {
    for (const button of [go, better]) {
      button.disabled = why !== "";
      button.title = why || hint;
    }
  }
  return {
    element,
    out,
    first: () => (safer ? better : go),
    safer: () => safer,
    /** End: no act is left. */
    end() {
      for (const button of [go, better]) button.remove();
      out.textContent = t("Close");
      out.focus();
    },
    /** @param {string} reason "" where they can be pressed */
    block(reason) {
      why = reason;
      draw();
    },
    /** @param {Pick<Question, "act" | "safer">} shown */
    show(shown) {
      const hadFocus = document.activeElement === go;
      safer = shown.safer ?? null;
      go.textContent = shown.act;
      go.className = `button ${isDanger ? "danger filled" : safer ? "" : "primary"}`;
      go.type = safer ? "button" : "submit"; // Enter triggers the first submit button: not the act where there is a safer one
      better.remove();
      if (safer) {
        better.textContent = safer.words;
        element.append(better);
        if (hadFocus) better.focus();
      }
      draw();
    },
  };
}

/** @param {NonNullable<Question["checks"]>[number]} check */
const checkLine = ({ name, words, isNeeded = false }) =>
  h(
    "label",
    { class: "confirm-check" },
    h("input", { type: "checkbox", name, checked: !isNeeded, required: isNeeded }),
    h("span", {}, words),
  );

/** @param {HTMLInputElement} input */
const filledIn = (input) => (input.type === "number" ? input.valueAsNumber : input.value.trim());

/** @param {QuestionField} field */
function fieldInput(field) {
  return h("input", {
    class: "input",
    id: `confirm-${field.name}`,
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

/** Radio buttons without a default: Enter has no effect before one is chosen. @param {QuestionChoices} choices */
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
 * Place the dialog above its button where there is room, within the window; a phone shows it in the middle.
 *
 * @param {HTMLDialogElement} dialog
 * @param {HTMLElement} opener
 */
function growFrom(dialog, opener) {
  if (matchMedia("(max-width: 720px)").matches) return;
  const box = opener.getBoundingClientRect();
  const middle = box.left + box.width / 2;
  const left = Math.min(Math.max(EDGE_PX, middle - dialog.offsetWidth / 2), innerWidth - dialog.offsetWidth - EDGE_PX);
  // the lower edge is fixed when text is added: the buttons stay in the window
  const room = box.top - 2 * EDGE_PX;
  const isAbove = room >= dialog.offsetHeight || room >= innerHeight / 2;
  Object.assign(dialog.style, {
    margin: "0",
    left: `${left}px`,
    top: isAbove ? "auto" : `${EDGE_PX}px`,
    bottom: isAbove ? `${innerHeight - box.top + EDGE_PX}px` : "auto",
    maxHeight: `${isAbove ? room : innerHeight - 2 * EDGE_PX}px`,
    overflowY: "auto",
    transformOrigin: `${middle - left}px 100%`,
  });
  dialog.classList.add("grown");
}
