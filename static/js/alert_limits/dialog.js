/** The form of where alerts begin, for a type of UAV or for one mission. */

import { ApiError, get, put } from "../api.js";
import { h } from "../dom.js";
import { numberField } from "../page/fields.js";
import { open } from "../page/keyboard.js";
import { toast } from "../page/toast.js";
import { t } from "../text.js";
import { numberText } from "../units.js";
import { boundsIn, GROUPS, wrongWayRound } from "./words.js";

/** address: of the limits in the API; title and hint in words. onSaved(stated) after each change that was kept. Rejects with ApiError. */
export async function openAlertLimits({ address, title, hint, onSaved = () => {} }) {
  const { data } = await get(address);
  const fieldOf = ({ name, label, unit, factor }) => [
    name,
    numberField(name, label, data.stated[name], {
      factor,
      unit,
      digits: 1,
      usual: data.usual[name],
      ...boundsIn(data.bounds[name], factor),
    }),
  ];
  const groups = GROUPS.map(({ title: words, limits }) => ({ words, fields: limits.map(fieldOf) }));
  const fields = new Map(groups.flatMap((group) => group.fields));
  const labelOf = (name) => fields.get(name).label;
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
        own.map(([, field]) => field.element),
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
          onclick: () => fields.forEach(({ input, tell }) => ((input.value = ""), tell(""))),
        },
        t("All as usual"),
      ),
      h("button", { type: "button", class: "button", onclick: () => dialog.close() }, t("Cancel")),
      save,
    ),
  );
  const dialog = h(
    "dialog",
    { class: "alert-limits", "aria-labelledby": "limits-title" },
    h("h2", { id: "limits-title" }, title),
    form,
  );

  function say(words) {
    wrong.hidden = !words;
    wrong.textContent = words;
  }

  function tellWrongWay(stated) {
    const faults = wrongWayRound(stated, data.usual);
    for (const [upper, lower] of faults)
      fields.get(upper).tell(
        t("Not below “{other}” ({figure}). Raise this one, or lower the other.", {
          other: labelOf(lower),
          figure: numberText((stated[lower] ?? data.usual[lower]) / factorOf(lower), 0),
        }),
      );
    if (faults.length) fields.get(faults[0][0]).input.focus();
    return faults.length > 0;
  }

  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    say("");
    fields.forEach(({ tell }) => tell(""));
    const stated = Object.fromEntries(
      [...fields].map(([name, field]) => [name, field.read()]).filter(([, value]) => value !== null),
    );
    if (tellWrongWay(stated)) return;
    save.setAttribute("aria-busy", "true");
    try {
      const { data: kept } = await put(address, stated);
      dialog.close();
      toast(t("Saved. Alerts begin there from now on."));
      onSaved(kept.stated);
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      const [place] = Object.keys(error.details ?? {});
      if (fields.has(place)) fields.get(place).tell(t("The server does not take this figure."));
      say(error.isAway ? t("The server cannot be reached. What you typed stays here.") : error.message);
    } finally {
      save.removeAttribute("aria-busy");
    }
  });
  open(dialog);
  fields.values().next().value.input.focus();
}

const FACTORS = new Map(GROUPS.flatMap(({ limits }) => limits.map(({ name, factor }) => [name, factor])));
const factorOf = (name) => FACTORS.get(name);
