/** The form of where alerts begin, for a type of UAV or for one mission. */

import { ApiError, get, put } from "../api.js";
import { h } from "../dom.js";
import { numberField } from "../page/fields.js";
import { open } from "../page/keyboard.js";
import { toast } from "../page/toast.js";
import { t } from "../text.js";
import { numberText } from "../units.js";
import { boundsIn, GROUPS, wrongWayRound } from "./words.js";

/** @import { Answer } from "../api.js" */
/** @import { AlertLimits } from "../api_types.d.ts" */
/** @import { Figures, Limit } from "./words.js" */

/** @typedef {ReturnType<typeof numberField>} NumberField */

/**
 * Opens the form. Rejects with ApiError.
 *
 * @param {object} options
 * @param {string} options.address of the limits in the API
 * @param {string} options.title
 * @param {string} options.hint
 * @param {(stated: Figures) => void} [options.onSaved] after each change that was kept
 */
export async function openAlertLimits({ address, title, hint, onSaved }) {
  const { data } = /** @type {Answer<AlertLimits>} */ (await get(address));
  const groups = GROUPS.map((group) => ({
    words: group.title,
    fields: group.limits.map((limit) => fieldOf(limit, data)),
  }));
  const fields = new Map(groups.flatMap((group) => group.fields).map((field) => [field.name, field]));
  const wrong = h("p", { class: "field-error", role: "alert", hidden: true });
  const save = h("button", { class: "button primary" }, t("Save"));
  const form = h(
    "form",
    {},
    h("p", { class: "caption" }, hint),
    groups.map(({ words, fields: own }) =>
      h(
        "fieldset",
        { class: "limit-group" },
        h("legend", {}, words),
        own.map((field) => field.element),
      ),
    ),
    wrong,
    h(
      "div",
      { class: "acts" },
      h(
        "button",
        {
          type: "button",
          class: "button quiet",
          onclick: () => {
            for (const { input, notify } of fields.values()) {
              input.value = "";
              notify("");
            }
          },
        },
        t("Reset to defaults"),
      ),
      h("button", { type: "button", class: "button", onclick: () => void dialog.close() }, t("Cancel")),
      save,
    ),
  );
  const dialog = h(
    "dialog",
    { class: "alert-limits", "aria-labelledby": "limits-title" },
    h("h2", { id: "limits-title" }, title),
    form,
  );

  /** @param {string} words */
  function announce(words) {
    wrong.hidden = !words;
    wrong.textContent = words;
  }

  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    announce("");
    /** @type {Figures} */
    const stated = {};
    for (const [name, field] of fields) {
      field.notify("");
      const value = field.read();
      if (value !== null) stated[name] = value;
    }
    if (showWrongOrder(fields, stated, data.usual)) return;
    save.setAttribute("aria-busy", "true");
    try {
      const { data: kept } = /** @type {Answer<AlertLimits>} */ (await put(address, stated));
      dialog.close();
      toast(t("Thresholds saved."));
      onSaved?.(kept.stated);
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      const [place] = Object.keys(error.details ?? {});
      fields.get(place)?.notify(t("The server does not take this figure."));
      announce(error.isAway ? t("The server cannot be reached. What you typed stays here.") : error.message);
    } finally {
      save.removeAttribute("aria-busy");
    }
  });
  open(dialog);
  groups[0].fields[0].input.focus();
}

/** @param {Limit} limit @param {AlertLimits} known */
const fieldOf = ({ name, label, unit, factor }, { stated, usual, bounds }) =>
  numberField(name, label, stated[name], {
    factor,
    unit,
    digits: 1,
    usual: usual[name],
    ...boundsIn(bounds[name], factor),
  });

/**
 * Mark the fields of pairs in the wrong order. Returns whether there are any.
 *
 * @param {Map<string, NumberField>} fields
 * @param {Figures} stated
 * @param {Figures} usual
 */
function showWrongOrder(fields, stated, usual) {
  const faults = wrongWayRound(stated, usual);
  for (const [upper, lower] of faults)
    fields.get(upper)?.notify(
      t("Not below “{other}” ({figure}). Raise this one, or lower the other.", {
        other: fields.get(lower)?.label ?? lower,
        figure: numberText((stated[lower] ?? usual[lower]) / (FACTORS.get(lower) ?? 1), 0),
      }),
    );
  if (faults.length) fields.get(faults[0][0])?.input.focus();
  return faults.length > 0;
}

const FACTORS = new Map(GROUPS.flatMap(({ limits }) => limits.map(({ name, factor }) => [name, factor])));
