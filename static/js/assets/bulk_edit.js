/** The dialog that corrects one fact of many assets, and the way back. */

import { ApiError, post } from "../api.js";
import { h, setChildren } from "../dom.js";
import { toast } from "../page/toast.js";
import { t, tn } from "../text.js";
import { numberText } from "../units.js";
import { MAX_KV, voltsOf } from "./voltages.js";

/** @import { Answer } from "../api.js" */
/** @import { BulkEditOutput, BulkUndoOutput } from "../api_types.d.ts" */
/** @import { Marked } from "../register/types.d.ts" */

const MAX_BULK = 5_000;
/** @type {Record<string, string>} */
const FACTS = {
  operator: t("Operator"),
  voltages_v: t("Voltages"),
  circuits: t("Circuits"),
  height_m: t("Height above ground"),
  is_flyable: t("Used for routing"),
};

/**
 * @typedef {object} Fact
 * @property {HTMLElement} control
 * @property {string} [unit]
 * @property {() => unknown} read undefined where what is written is no value
 */

/** @param {string} name @returns {Fact} */
function factControl(name) {
  if (name === "is_flyable") {
    const select = h(
      "select",
      { class: "input" },
      h("option", { value: "true" }, t("yes")),
      h("option", { value: "false" }, t("no")),
    );
    return { control: select, read: () => select.value === "true" };
  }
  if (name === "circuits" || name === "height_m") {
    const isHeight = name === "height_m";
    const number = h("input", {
      class: "input",
      type: "number",
      min: isHeight ? 0.1 : 1,
      max: isHeight ? 1000 : 100,
      step: isHeight ? "any" : 1,
    });
    const read = () => (number.validity.valid ? (number.value === "" ? null : number.valueAsNumber) : undefined);
    return { control: number, unit: isHeight ? "m" : "", read };
  }
  const text = h("input", { class: "input", type: "text", maxlength: 255 });
  if (name === "operator") return { control: text, read: () => text.value.trim() };
  text.placeholder = "110, 20";
  return { control: text, unit: "kV", read: () => voltsOf(text.value) ?? undefined };
}

/**
 * Ask which fact gets which value, and change it. Resolves to whether assets changed.
 *
 * @param {Marked} marked
 * @param {() => unknown} reload after an undo
 * @returns {Promise<boolean>}
 */
export async function editMarked(marked, reload) {
  if (marked.count > MAX_BULK) {
    toast(t("At most {most} assets at once: narrow the filters.", { most: numberText(MAX_BULK) }));
    return false;
  }
  const values = await askFact(marked.count);
  if (!values) return false;
  const query = marked.ids ? "" : `?${new URLSearchParams(marked.query)}`;
  const body = marked.ids ? { ids: marked.ids, values } : { expected: marked.count, values };
  try {
    const { data } = /** @type {Answer<BulkEditOutput>} */ (await post(`/assets/edits${query}`, body));
    const words = tn(data.changed, "{count} asset changed.", "{count} assets changed.", {
      count: numberText(data.changed),
    });
    toast(words, data.changed ? { label: t("Undo"), act: () => undo(data.entries, reload) } : null);
    return data.changed > 0;
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    toast(error.message);
    return false;
  }
}

/** @param {number[]} entries @param {() => unknown} reload */
async function undo(entries, reload) {
  try {
    const { data } = /** @type {Answer<BulkUndoOutput>} */ (await post("/assets/edits/undo", { entries }));
    const kept = data.kept
      ? ` ${tn(data.kept, "{count} was changed since and stays.", "{count} were changed since and stay.")}`
      : "";
    toast(
      tn(data.undone, "{count} asset is as before.", "{count} assets are as before.", {
        count: numberText(data.undone),
      }) + kept,
    );
    await reload();
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    toast(error.message);
  }
}

/** @param {number} count @returns {Promise<Record<string, unknown> | null>} */
function askFact(count) {
  return new Promise((resolve) => {
    /** @type {Fact} */
    let fact;
    const choice = h(
      "select",
      { class: "input", id: "bulk-fact" },
      Object.entries(FACTS).map(([value, words]) => h("option", { value }, words)),
    );
    const place = h("div", { class: "field" });
    const fault = h("p", { class: "caption", role: "alert" });
    const act = tn(count, "Change {count} asset", "Change {count} assets", { count: numberText(count) });
    const draw = () => {
      fact = factControl(choice.value);
      fact.control.id = "bulk-value";
      fault.textContent = "";
      setChildren(
        place,
        h("label", { for: "bulk-value" }, fact.unit ? `${t("New value")} [${fact.unit}]` : t("New value")),
        fact.control,
      );
    };
    choice.addEventListener("change", draw);
    draw();
    const form = h(
      "form",
      { method: "dialog" },
      h("div", { class: "field" }, h("label", { for: "bulk-fact" }, t("Fact to change")), choice),
      place,
      h(
        "p",
        { class: "caption" },
        t("A blank value means not stated. Later imports leave these assets alone, and each keeps its history."),
      ),
      fault,
      h(
        "div",
        { class: "acts" },
        h("button", { type: "button", class: "button", onclick: () => dialog.close() }, t("Cancel")),
        h("button", { type: "submit", class: "button primary" }, act),
      ),
    );
    form.addEventListener("submit", (event) => {
      const value = fact.read();
      if (value !== undefined) return dialog.close("go");
      event.preventDefault();
      fault.textContent =
        choice.value === "voltages_v"
          ? t("Write kilovolts up to {most}, such as 110, 20.", { most: MAX_KV })
          : t("This is no value of this fact.");
      fact.control.focus();
    });
    /** @type {HTMLDialogElement} */
    const dialog = h("dialog", { "aria-labelledby": "bulk-title" }, h("h2", { id: "bulk-title" }, act), form);
    dialog.addEventListener("close", () => {
      resolve(dialog.returnValue === "go" ? { [choice.value]: fact.read() } : null);
      dialog.remove();
    });
    document.body.append(dialog);
    dialog.showModal();
    choice.focus();
  });
}
