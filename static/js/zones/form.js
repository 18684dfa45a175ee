/** The facts of a zone as fields. */

import { h } from "../dom.js";
import { limitField } from "../domain/zone_heights.js";
import { plainWords } from "../map/tips.js";
import { t } from "../text.js";
import { scheduleEditor } from "./schedule_editor.js";

/** @import { Limit, ZoneDetailFeature, ZoneDetailProperties } from "../api_types.d.ts" */
/** @import { Facts, RecordForm } from "../ground/types.d.ts" */

/** Of ED-269; ED-318 has USPACE as well, and spells REQ_AUTHORIZATION. */
const RESTRICTIONS = ["PROHIBITED", "REQ_AUTHORISATION", "CONDITIONAL", "NO_RESTRICTION", "USPACE"];
/** Of ED-269 and ED-318; DAR is of ED-318 alone, FOREIGN_TERRITORY of ED-269. */
const REASONS = [
  "AIR_TRAFFIC",
  "SENSITIVE",
  "PRIVACY",
  "POPULATION",
  "NATURE",
  "NOISE",
  "FOREIGN_TERRITORY",
  "EMERGENCY",
  "DAR",
  "OTHER",
];
/** @type {[string, Limit | null][]} upper limits, from the ground */
const QUICK_HEIGHTS = [
  [t("Ground to 50 m"), { value_m: 50, reference: "AGL" }],
  [t("Ground to 120 m"), { value_m: 120, reference: "AGL" }],
  [t("Ground, no upper end"), null],
];
const GROUND = /** @type {Limit} */ ({ value_m: 0, reference: "AGL" });

/** @param {string} id @param {string} words @param {HTMLElement} input */
const field = (id, words, input) => h("div", { class: "field" }, h("label", { for: id }, words), input);

/**
 * @param {ZoneDetailFeature | null} feature null for a new one
 * @param {string} _choice
 * @param {Facts | null} kept values of an edit that is resumed
 * @param {{ element: HTMLElement, read: () => unknown }} [times] in place of the editor of the schedule
 * @returns {RecordForm}
 */
export function zoneForm(feature, _choice, kept, times) {
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
  const restriction = restrictionField(facts.restriction ?? "");
  const reason = reasonField(facts.reason ?? "");
  const lower = limitField("lower", t("Lower limit"), facts.lower_limit ?? null);
  const upper = limitField("upper", t("Upper limit"), facts.upper_limit ?? null);
  const when = times ?? scheduleEditor(facts.schedule ?? null);
  return {
    element: h(
      "form",
      { class: "record-form", onsubmit: (event) => event.preventDefault() },
      field("zone-name", t("Name"), name),
      restriction.element,
      reason.element,
      h(
        "div",
        { class: "quick-heights", role: "group", "aria-label": t("Heights in one step") },
        QUICK_HEIGHTS.map(([words, limit]) => {
          const set = () => {
            lower.set(GROUND);
            upper.set(limit);
          };
          return h("button", { type: "button", class: "text-button", onclick: set }, words);
        }),
      ),
      upper.element,
      lower.element,
      when.element,
    ),
    read: () => ({
      name: name.value.trim(),
      restriction: restriction.read(),
      reason: reason.read(),
      lower_limit: lower.read(),
      upper_limit: upper.read(),
      schedule: when.read(),
    }),
  };
}

/**
 * What a stored restriction chooses in the list: its own code, that of the other standard, or itself where it is of neither.
 *
 * @param {string} value
 */
export function restrictionChoices(value) {
  const spelt = value === "REQ_AUTHORIZATION" ? "REQ_AUTHORISATION" : value;
  const others = spelt && !RESTRICTIONS.includes(spelt) ? [spelt] : [];
  return { chosen: spelt, values: [...RESTRICTIONS, ...others] };
}

/** What planning makes of a restriction. @param {string} value */
export function restrictionHint(value) {
  if (value === "") return t("Not stated: plans keep clear of it, as of a prohibited zone.");
  return value === "NO_RESTRICTION"
    ? t("Plans keep clear of it all the same: delete it where you may fly.")
    : t("Plans keep clear of it.");
}

/** @param {string} value @param {string} [id] */
export function restrictionField(value, id = "zone-restriction") {
  const { chosen, values } = restrictionChoices(value);
  const input = h(
    "select",
    { class: "input", id, "aria-describedby": `${id}-hint` },
    ["", ...values].map((code) =>
      h("option", { value: code, selected: code === chosen }, code ? plainWords(code) : t("not stated")),
    ),
  );
  const hint = h("p", { class: "caption", id: `${id}-hint` }, restrictionHint(chosen));
  input.addEventListener("input", () => {
    hint.textContent = restrictionHint(input.value);
  });
  const element = h("div", {}, field(id, t("Restriction"), input), hint);
  return { element, read: () => (input.value === chosen ? value : input.value) };
}

/** The reasons of a stored text, and what of it is of neither standard. @param {string} text */
export function reasonsOf(text) {
  const parts = text.split(",").map((part) => part.trim());
  const codes = parts.filter((part) => REASONS.includes(part));
  return { codes, other: parts.filter((part) => part && !REASONS.includes(part)).join(", ") };
}

/** @param {string} text */
export function reasonField(text) {
  const { codes, other } = reasonsOf(text);
  const boxes = REASONS.map((code) => ({
    code,
    box: h("input", { class: "check", type: "checkbox", checked: codes.includes(code) }),
  }));
  const element = h(
    "fieldset",
    { class: "zone-reasons" },
    h("legend", {}, t("Reason")),
    boxes.map(({ code, box }) => h("label", {}, box, h("span", {}, plainWords(code)))),
    other && h("p", { class: "caption" }, t("As the source states it: {reason}", { reason: other })),
  );
  const read = () => {
    const now = boxes.filter(({ box }) => box.checked).map(({ code }) => code);
    const isSame = now.length === codes.length && now.every((code) => codes.includes(code));
    return isSame ? text : [...now, other].filter(Boolean).join(", ");
  };
  return { element, read };
}
