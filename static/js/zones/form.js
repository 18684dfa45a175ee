/** The facts of a zone as fields. */

import { h } from "../dom.js";
import { limitField } from "../domain/zone_heights.js";
import { t } from "../text.js";
import { scheduleEditor } from "./schedule_editor.js";

/** @import { ZoneDetailFeature, ZoneDetailProperties } from "../api_types.d.ts" */
/** @import { Facts, RecordForm } from "../ground/types.d.ts" */

const RESTRICTIONS = ["PROHIBITED", "REQ_AUTHORISATION", "CONDITIONAL", "NO_RESTRICTION"];
/** @param {string} id @param {string} words @param {HTMLElement} input */
const field = (id, words, input) => h("div", { class: "field" }, h("label", { for: id }, words), input);

/**
 * @param {ZoneDetailFeature | null} feature null for a new one
 * @param {string} _choice
 * @param {Facts | null} kept values of an edit that is resumed
 * @returns {RecordForm}
 */
export function zoneForm(feature, _choice, kept) {
  /** @type {Partial<ZoneDetailProperties>} */
  const facts = { ...feature?.properties, ...kept };
  const name = h("input", {
    class: "input",
    id: "zone-name",
    type: "text",
    maxlength: 255,
    required: true,
    value: facts.name ?? "",
    autocomplete: "off",
  });
  const restriction = h("input", {
    class: "input",
    id: "zone-restriction",
    type: "text",
    maxlength: 100,
    list: "restrictions",
    value: facts.restriction ?? "",
    autocomplete: "off",
  });
  const reason = h("input", {
    class: "input",
    id: "zone-reason",
    type: "text",
    maxlength: 255,
    value: facts.reason ?? "",
    autocomplete: "off",
  });
  const lower = limitField("lower", t("Lower limit"), facts.lower_limit ?? null);
  const upper = limitField("upper", t("Upper limit"), facts.upper_limit ?? null);
  const times = scheduleEditor(facts.schedule ?? null);
  return {
    element: h(
      "form",
      { class: "record-form", onsubmit: (event) => event.preventDefault() },
      field("zone-name", t("Name"), name),
      h(
        "div",
        { class: "pair" },
        field("zone-restriction", t("Restriction"), restriction),
        field("zone-reason", t("Reason"), reason),
      ),
      h(
        "datalist",
        { id: "restrictions" },
        RESTRICTIONS.map((value) => h("option", { value })),
      ),
      upper.element,
      lower.element,
      times.element,
    ),
    read: () => ({
      name: name.value.trim(),
      restriction: restriction.value.trim(),
      reason: reason.value.trim(),
      lower_limit: lower.read(),
      upper_limit: upper.read(),
      schedule: times.read(),
    }),
  };
}
