/** Fields of the fleet's forms. Each has a label, a value as the API takes it, and a place for what is wrong with it. */

import { h, icon } from "../dom.js";

let made = 0;

/** What a field is: { name, label, element, read(), tell(fault) }. */
function fieldOf(name, label, input, read, { unit = "", hint = "" } = {}) {
  input.id = `fleet-field-${++made}`;
  const fault = h("p", { class: "field-error", id: `${input.id}-fault`, hidden: true });
  const help = hint && h("p", { class: "caption", id: `${input.id}-hint` }, hint);
  const described = [help && help.id, fault.id].filter(Boolean).join(" ");
  input.setAttribute("aria-describedby", described);
  const element = h("div", { class: "field" }, h("label", { for: input.id }, label), unit ? h("div", { class: "with-unit" }, input, h("span", { class: "unit" }, unit)) : input, help, fault);
  return {
    name,
    label,
    element,
    input,
    read,
    tell(words) {
      fault.hidden = !words;
      fault.replaceChildren(...(words ? [icon("circle-alert", "small"), words] : []));
      if (words) input.setAttribute("aria-invalid", "true");
      else input.removeAttribute("aria-invalid");
    },
  };
}

export function textField(name, label, value, { required = false, maxlength = 100, ...how } = {}) {
  const input = h("input", { class: "input", type: "text", required, maxlength, autocomplete: "off", spellcheck: "false", value: value ?? "" });
  return fieldOf(name, label, input, () => input.value.trim(), how);
}

/** factor: how much of the stored unit one of the shown unit is. An empty field is null. */
export function numberField(name, label, value, { factor = 1, digits = 3, required = false, min, max, step = "any", ...how } = {}) {
  const shown = value === null || value === undefined ? "" : Number((value / factor).toFixed(digits));
  const input = h("input", { class: "input", type: "number", inputmode: "decimal", step, min, max, required, value: shown });
  const read = () => {
    if (!Number.isFinite(input.valueAsNumber)) return null;
    return input.valueAsNumber === shown ? value : input.valueAsNumber * factor; // what was not touched stays to the last digit
  };
  return fieldOf(name, label, input, read, how);
}

/** choices: [[value, words]]; values are texts, "" is null where `isNumber`. */
export function choiceField(name, label, value, choices, { isNumber = false, ...how } = {}) {
  const input = h("select", { class: "input" }, choices.map(([choice, words]) => h("option", { value: `${choice}`, selected: `${choice}` === `${value ?? ""}` }, words)));
  return fieldOf(name, label, input, () => (isNumber ? (input.value === "" ? null : Number(input.value)) : input.value), how);
}
