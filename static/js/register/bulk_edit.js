/** The dialog that corrects one fact of many rows of a register, and the way back. */

import { ApiError, post } from "../api.js";
import { h, setChildren } from "../dom.js";
import { toast } from "../page/toast.js";
import { t } from "../text.js";
import { numberText } from "../units.js";

/** @import { Answer } from "../api.js" */
/** @import { BulkEditOutput, BulkUndoOutput } from "../api_types.d.ts" */
/** @import { BulkEdit, BulkFact, Marked } from "./types.d.ts" */

const MAX_BULK = 5_000;
const CONFLICT = 409;

/**
 * Ask which fact gets which value, and change it. Resolves to whether rows changed, by this user or by others meanwhile.
 *
 * @template Row
 * @param {Marked<Row>} marked
 * @param {BulkEdit<Row>} edit
 * @returns {Promise<boolean>}
 */
export async function editMarked(marked, edit) {
  if (marked.count > MAX_BULK) {
    toast(edit.words.tooMany(numberText(MAX_BULK)));
    return false;
  }
  const values = await askFact(marked.count, edit);
  if (!values) return false;
  const query = marked.rows ? "" : `?${new URLSearchParams(marked.query)}`;
  const body = marked.rows ? { ...edit.chosen(marked.rows), values } : { expected: marked.count, values };
  try {
    const { data } = /** @type {Answer<BulkEditOutput>} */ (await post(`${edit.path}${query}`, body));
    toast(
      edit.words.changed(data.changed),
      data.changed ? { label: t("Undo"), act: () => undo(data.entries, edit) } : null,
    );
    return data.changed > 0;
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    toast(error.message);
    return error.status === CONFLICT;
  }
}

/** @param {number[]} entries @param {BulkEdit<any>} edit */
async function undo(entries, { path, words, reload }) {
  try {
    const { data } = /** @type {Answer<BulkUndoOutput>} */ (await post(`${path}/undo`, { entries }));
    toast([words.undone(data.undone), data.kept && words.kept(data.kept)].filter(Boolean).join(" "));
    await reload();
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    toast(error.message);
  }
}

/** @param {number} count @param {BulkEdit<any>} edit @returns {Promise<Record<string, unknown> | null>} */
function askFact(count, { facts, words, note }) {
  return new Promise((resolve) => {
    /** @type {ReturnType<BulkFact["field"]>} */
    let field;
    const choice = h(
      "select",
      { class: "input", id: "bulk-fact" },
      Object.entries(facts).map(([value, fact]) => h("option", { value }, fact.words)),
    );
    const place = h("div", { class: "record-form" });
    const fault = h("p", { class: "caption", role: "alert" });
    const act = words.change(count);
    const draw = () => {
      field = facts[choice.value].field();
      fault.textContent = "";
      setChildren(place, field.element);
    };
    choice.addEventListener("change", draw);
    draw();
    const form = h(
      "form",
      { method: "dialog" },
      h("div", { class: "field" }, h("label", { for: "bulk-fact" }, t("Fact to change")), choice),
      place,
      h("p", { class: "caption" }, note),
      fault,
      h(
        "div",
        { class: "acts" },
        h("button", { type: "button", class: "button", onclick: () => dialog.close() }, t("Cancel")),
        h("button", { type: "submit", class: "button primary" }, act),
      ),
    );
    form.addEventListener("submit", (event) => {
      if (field.read() !== undefined) return dialog.close("go");
      event.preventDefault();
      fault.textContent = facts[choice.value].fault ?? t("This is no value of this fact.");
      place.querySelector("input")?.focus();
    });
    /** @type {HTMLDialogElement} */
    const dialog = h("dialog", { "aria-labelledby": "bulk-title" }, h("h2", { id: "bulk-title" }, act), form);
    dialog.addEventListener("close", () => {
      resolve(dialog.returnValue === "go" ? { [choice.value]: field.read() } : null);
      dialog.remove();
    });
    document.body.append(dialog);
    dialog.showModal();
    choice.focus();
  });
}
