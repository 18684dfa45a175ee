/** The dialog of a source of zones that is fetched by itself: made, changed, ended. */

import { ApiError, patch, post, remove } from "../api.js";
import { h } from "../dom.js";
import { toast } from "../page/toast.js";
import { t } from "../text.js";

/** @import { ZoneSet, ZoneSubscription } from "../api_types.d.ts" */
/** @import { Child } from "../dom.js" */

/** @type {[string, string][]} */
const FORMATS = [
  ["", t("found out from the file")],
  ["ed269", "ED-269"],
  ["ed318", "ED-318"],
  ["openair", "OpenAir"],
  ["geojson", "GeoJSON"],
];

/** Open a dialog that is removed when it is closed. @param {string} title @param {...Child} content */
export function openDialog(title, ...content) {
  const dialog = h("dialog", { "aria-label": title }, h("h2", {}, title), content);
  dialog.addEventListener("close", () => dialog.remove());
  document.body.append(dialog);
  dialog.showModal();
  return dialog;
}

/**
 * @param {ZoneSet | null} set null for a new one
 * @param {object} on
 * @param {(act: () => Promise<unknown>, words: string) => unknown} on.attempt
 * @param {() => Promise<void>} on.reload
 */
export function askSubscription(set, { attempt, reload }) {
  const old = set?.subscription ?? null;
  const fields = fieldsOf(old);
  const fault = h("p", { class: "field-error", id: "subscription-fault", hidden: true });
  const close = () => dialog.close();
  const end = () => {
    dialog.close();
    attempt(() => remove(`/zone-subscriptions/${old?.id}`), t("No longer fetched. Its zones stay."));
  };
  const form = h(
    "form",
    {},
    !old && field(t("Name of the set"), fields.set),
    field(t("Address of the file"), fields.address),
    h("div", { class: "pair" }, field(t("Format"), fields.format), field(t("Every … hours"), fields.interval)),
    field(t("Licence"), fields.licence),
    field(t("Attribution"), fields.attribution),
    h(
      "p",
      { class: "caption" },
      t("What it brings is shown as a difference; nothing is replaced before somebody applies it."),
    ),
    fault,
    h(
      "div",
      { class: "acts" },
      old && h("button", { type: "button", class: "button danger", onclick: end }, t("Fetch no longer")),
      h("button", { type: "button", class: "button", onclick: close }, t("Cancel")),
      h("button", { type: "submit", class: "button primary" }, old ? t("Save") : t("Subscribe")),
    ),
  );
  /** @type {HTMLDialogElement} */
  const dialog = openDialog(set ? t("Source of {name}", { name: set.name }) : t("Subscribe to a zone source"), form);
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    try {
      await send(old, fields);
      dialog.close();
      toast(old ? t("Saved.") : t("Subscribed. It is fetched within a minute."));
      await reload();
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      fault.hidden = false;
      fault.textContent = error.message;
    }
  });
}

/** @param {string} words @param {HTMLElement} input */
const field = (words, input) => h("div", { class: "field" }, h("label", { for: input.id }, words), input);

/** @param {string} id @param {object} rest */
const inputOf = (id, rest) => h("input", { class: "input", id, autocomplete: "off", ...rest });

/** @param {ZoneSubscription | null} old */
function fieldsOf(old) {
  const address = { type: "url", required: true, placeholder: "https://", maxlength: 500, value: old?.address ?? "" };
  const hours = String(old?.interval_h ?? 24);
  const chosen = old?.source_format ?? "";
  return {
    set: inputOf("subscription-set", { required: true, maxlength: 200 }),
    address: inputOf("subscription-address", address),
    format: h(
      "select",
      { class: "input", id: "subscription-format" },
      FORMATS.map(([value, words]) => h("option", { value, selected: value === chosen }, words)),
    ),
    interval: inputOf("subscription-interval", { type: "number", min: 1, max: 8760, required: true, value: hours }),
    licence: inputOf("subscription-licence", { maxlength: 200, value: old?.licence ?? "" }),
    attribution: inputOf("subscription-attribution", { maxlength: 300, value: old?.attribution ?? "" }),
  };
}

/** @param {ZoneSubscription | null} old @param {ReturnType<typeof fieldsOf>} fields */
async function send(old, fields) {
  const body = {
    address: fields.address.value.trim(),
    source_format: fields.format.value,
    interval_h: Number(fields.interval.value),
    licence: fields.licence.value.trim(),
    attribution: fields.attribution.value.trim(),
  };
  if (old) await patch(`/zone-subscriptions/${old.id}`, body);
  else await post("/zone-subscriptions", { set_name: fields.set.value.trim(), ...body });
}
