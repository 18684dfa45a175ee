/** Fields of the fleet's forms. Each has a label, a value as the API takes it, and a place for what is wrong with it. */

import { h, icon } from "../dom.js";
import { t } from "../text.js";
import { numberText } from "../units.js";

let made = 0;

/** What a field is: { name, label, element, input, read(), tell(fault) }. */
function fieldOf(name, label, input, read, { unit = "", hint = "" } = {}) {
  input.id = `fleet-field-${++made}`;
  const fault = h("p", { class: "field-error", id: `${input.id}-fault`, hidden: true });
  const help = hint && h("p", { class: "caption", id: `${input.id}-hint` }, hint);
  const described = [help && help.id, fault.id].filter(Boolean).join(" ");
  input.setAttribute("aria-describedby", described);
  const element = h(
    "div",
    { class: "field" },
    h("label", { for: input.id }, label),
    unit ? h("div", { class: "with-unit" }, input, h("span", { class: "unit" }, unit)) : input,
    help,
    fault,
  );
  const tell = (words) => {
    fault.hidden = !words;
    fault.replaceChildren(...(words ? [icon("circle-alert", "small"), words] : []));
    if (words) input.setAttribute("aria-invalid", "true");
    else input.removeAttribute("aria-invalid");
  };
  // Said beside the field and in the page's language, not in a bubble of the browser's.
  input.addEventListener("invalid", (event) => {
    event.preventDefault();
    tell(faultWords(input));
    if ([...input.form.elements].find(({ validity }) => validity?.valid === false) === input) input.focus();
  });
  input.addEventListener("input", () => input.validity.valid && tell(""));
  return { name, label, element, input, read, tell };
}

function faultWords({ validity, min, max }) {
  if (validity.badInput) return t("A number is wanted here.");
  if (validity.rangeUnderflow) return t("At least {least}.", { least: numberText(Number(min), digitsOf(min)) });
  if (validity.rangeOverflow) return t("At most {most}.", { most: numberText(Number(max), digitsOf(max)) });
  if (validity.stepMismatch) return t("A whole number is wanted here.");
  return t("Something is wanted here.");
}

const digitsOf = (figure) => (figure.split(".")[1] ?? "").length;

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

/** factor: how much of the stored unit one of the shown unit is. An empty field is null; what counts then stands in it in grey: `usual`. */
export function numberField(
  name,
  label,
  value,
  { factor = 1, digits = 3, required = false, min, max, step = "any", usual = null, ...how } = {},
) {
  const shownOf = (stored) =>
    stored === null || stored === undefined ? "" : Number((stored / factor).toFixed(digits));
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
    return input.valueAsNumber === shown ? value : input.valueAsNumber * factor; // what was not touched stays to the last digit
  };
  return { ...fieldOf(name, label, input, read, how), usual: (stored) => (input.placeholder = shownOf(stored)) };
}

/** choices: [[value, words]]; values are texts, "" is null where `isNumber`. */
export function choiceField(name, label, value, choices, { isNumber = false, ...how } = {}) {
  const input = h(
    "select",
    { class: "input" },
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

/** On or off, with what it means beside it. */
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
  const tell = (words) => {
    fault.hidden = !words;
    fault.replaceChildren(...(words ? [icon("circle-alert", "small"), words] : []));
  };
  return { name, label, element, input, read: () => input.checked, tell };
}
