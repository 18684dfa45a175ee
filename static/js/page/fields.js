/** Fields of the fleet's forms. Each has a label, a value in the form of the API, and an element for its fault. */

import { h, icon } from "../dom.js";
import { t } from "../text.js";
import { numberText } from "../units.js";

/** @typedef {HTMLInputElement | HTMLSelectElement} Input */
/**
 * A field of a form.
 *
 * @template [Value=any]
 * @template {Input} [Control=Input]
 * @typedef {object} Field
 * @property {string} name
 * @property {string} label
 * @property {HTMLElement} element
 * @property {Control} input
 * @property {() => Value} read its value as the API takes it
 * @property {(fault: string) => void} notify shows its fault; "" clears it
 */
/** @typedef {{ unit?: string, hint?: string }} How */

let made = 0;

/**
 * @template Value
 * @template {Input} Control
 * @param {string} name
 * @param {string} label
 * @param {Control} input
 * @param {() => Value} read
 * @param {How} [how]
 * @returns {Field<Value, Control>}
 */
function fieldOf(name, label, input, read, { unit = "", hint = "" } = {}) {
  input.id = `fleet-field-${++made}`;
  const fault = h("p", { class: "field-error", id: `${input.id}-fault`, hidden: true });
  const help = hint && h("p", { class: "caption", id: `${input.id}-hint` }, hint);
  const described = [help ? help.id : "", fault.id].filter(Boolean).join(" ");
  input.setAttribute("aria-describedby", described);
  const element = h(
    "div",
    { class: "field" },
    h("label", { for: input.id }, label),
    unit ? h("div", { class: "with-unit" }, input, h("span", { class: "unit" }, unit)) : input,
    help,
    fault,
  );
  /** @param {string} words */
  const notify = (words) => {
    fault.hidden = !words;
    fault.replaceChildren(...(words ? [icon("circle-alert", "small"), words] : []));
    if (words) input.setAttribute("aria-invalid", "true");
    else input.removeAttribute("aria-invalid");
  };
  // Shown beside the field and in the page's language, instead of the browser's bubble.
  input.addEventListener("invalid", (event) => {
    event.preventDefault();
    notify(faultWords(input));
    const controls = /** @type {Input[]} */ ([...(input.form?.elements ?? [])]);
    if (controls.find(({ validity }) => validity?.valid === false) === input) input.focus();
  });
  input.addEventListener("input", () => input.validity.valid && notify(""));
  return { name, label, element, input, read, notify };
}

/** @param {Input} input */
function faultWords(input) {
  const { validity } = input;
  const { min, max } = input instanceof HTMLInputElement ? input : { min: "", max: "" };
  if (validity.badInput) return t("A number is wanted here.");
  if (validity.rangeUnderflow) return t("At least {least}.", { least: numberText(Number(min), digitsOf(min)) });
  if (validity.rangeOverflow) return t("At most {most}.", { most: numberText(Number(max), digitsOf(max)) });
  if (validity.stepMismatch) return t("A whole number is wanted here.");
  return t("Something is wanted here.");
}

/** @param {string} figure */
const digitsOf = (figure) => (figure.split(".")[1] ?? "").length;

/**
 * @param {string} name
 * @param {string} label
 * @param {string | null | undefined} value
 * @param {{ required?: boolean, maxlength?: number } & How} [options]
 */
export function textField(name, label, value, { required = false, maxlength = 100, ...how } = {}) {
  const input = h("input", {
    class: "input",
    type: "text",
    required,
    maxlength,
    autocomplete: "off",
    spellcheck: "false",
    value: value ?? "",
  });
  return fieldOf(name, label, input, () => input.value.trim(), how);
}

/**
 * @typedef {object} NumberHow
 * @property {number} [factor]
 * @property {number} [digits]
 * @property {boolean} [required]
 * @property {number} [min]
 * @property {number} [max]
 * @property {number | "any"} [step]
 * @property {number | null} [usual]
 */

/**
 * factor: size of one shown unit in stored units. An empty field is null; the value in effect, `usual`, is its placeholder.
 *
 * @param {string} name
 * @param {string} label
 * @param {number | null | undefined} value
 * @param {NumberHow & How} [options]
 */
export function numberField(
  name,
  label,
  value,
  { factor = 1, digits = 3, required = false, min, max, step = "any", usual = null, ...how } = {},
) {
  /** @param {number | null | undefined} stored */
  const shownOf = (stored) =>
    stored === null || stored === undefined ? "" : `${Number((stored / factor).toFixed(digits))}`;
  const shown = shownOf(value);
  const input = h("input", {
    class: "input",
    type: "number",
    inputmode: "decimal",
    step,
    min,
    max,
    required,
    value: shown,
    placeholder: shownOf(usual),
  });
  const read = () => {
    if (!Number.isFinite(input.valueAsNumber)) return null;
    return `${input.valueAsNumber}` === shown ? (value ?? null) : input.valueAsNumber * factor; // an untouched value keeps all its digits
  };
  return {
    ...fieldOf(name, label, input, read, how),
    /** @param {number | null | undefined} stored */
    usual(stored) {
      input.placeholder = shownOf(stored);
    },
  };
}

/**
 * choices: [[value, words]]; values are texts, "" is null where `isNumber`.
 *
 * @param {string} name
 * @param {string} label
 * @param {unknown} value
 * @param {readonly (readonly [string | number, string])[]} choices
 * @param {{ isNumber?: boolean, required?: boolean } & How} [options]
 */
export function choiceField(name, label, value, choices, { isNumber = false, required = false, ...how } = {}) {
  const input = h(
    "select",
    { class: "input", required },
    choices.map(([choice, words]) =>
      h("option", { value: `${choice}`, selected: `${choice}` === `${value ?? ""}` }, words),
    ),
  );
  return fieldOf(
    name,
    label,
    input,
    () => (isNumber ? (input.value === "" ? null : Number(input.value)) : input.value),
    how,
  );
}

/**
 * A switch with its explanation.
 *
 * @param {string} name
 * @param {string} label
 * @param {unknown} value
 * @param {{ hint?: string, disabled?: boolean }} [options]
 * @returns {Field<boolean, HTMLInputElement>}
 */
export function switchField(name, label, value, { hint = "", disabled = false } = {}) {
  const input = h("input", {
    class: "switch",
    type: "checkbox",
    role: "switch",
    id: `fleet-field-${++made}`,
    checked: Boolean(value),
    disabled,
  });
  const fault = h("p", { class: "field-error", id: `${input.id}-fault`, hidden: true });
  const help = h("small", { class: "caption", id: `${input.id}-hint` }, hint);
  input.setAttribute("aria-describedby", `${help.id} ${fault.id}`);
  const element = h(
    "div",
    { class: "field" },
    h("div", { class: "switch-row" }, h("div", {}, h("label", { for: input.id }, label), help), input),
    fault,
  );
  /** @param {string} words */
  const notify = (words) => {
    fault.hidden = !words;
    fault.replaceChildren(...(words ? [icon("circle-alert", "small"), words] : []));
  };
  return { name, label, element, input, read: () => input.checked, notify };
}
