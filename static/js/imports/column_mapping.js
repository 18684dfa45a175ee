/** What the columns of an asset file become: each with samples of its values; the file is read again with the answer. */

import { h, icon } from "../dom.js";

const FIELD_WORDS = {
  kind: "Kind of asset",
  subtype: "Type in its kind",
  name: "Name",
  ref: "Reference",
  operator: "Operator",
  voltage_v: "Voltage in V",
  voltage_kv: "Voltage in kV",
  voltage: "Voltage",
  circuits: "Circuits",
  height_m: "Height in m",
  height: "Height",
  key: "Key, to know it again",
};
const KIND_WORDS = { tower: "Towers", line: "Lines", railway: "Railways", bridge: "Bridges" };
const wordsOf = (field) => FIELD_WORDS[field] ?? field.replaceAll("_", " ").replace(/^./, (letter) => letter.toUpperCase());
let count = 0;

/** proposal.summary: { columns: [{ name, samples, becomes }], fields: [names], kinds: [...] }. readAgain({ columns, kind }). */
export function columnMapping(proposal, readAgain) {
  const id = `columns-${(count += 1)}`;
  const { columns, fields = Object.keys(FIELD_WORDS) } = proposal.summary;
  const kind = h("select", { class: "input", id: `${id}-kind` }, h("option", { value: "" }, "As a column says"), Object.entries(KIND_WORDS).map(([value, words]) => h("option", { value }, words)));
  kind.value = proposal.parameters.kind ?? proposal.summary.kind ?? "";
  const choices = columns.map((column, place) => {
    const choice = h("select", { class: "input", id: `${id}-${place}`, "aria-describedby": `${id}-${place}-samples` }, h("option", { value: "" }, "Kept as a tag"), fields.map((field) => h("option", { value: field }, wordsOf(field))));
    choice.value = column.becomes ?? "";
    return { column, choice };
  });
  const form = h(
    "form",
    { class: "column-form" },
    h("div", { class: "field" }, h("label", { for: `${id}-kind` }, "These are"), kind),
    choices.map(({ column, choice }, place) =>
      h(
        "div",
        { class: "column-row" },
        h("div", { class: "column-name" }, h("label", { for: choice.id }, column.name), h("span", { class: "caption", id: `${id}-${place}-samples` }, (column.samples ?? []).map(String).join(" · ") || "always empty")),
        choice,
      ),
    ),
    h("div", { class: "row-acts" }, h("button", { type: "submit", class: "button" }, icon("rotate-ccw", "small"), "Read again with these columns")),
  );
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    readAgain({ kind: kind.value || null, columns: Object.fromEntries(choices.filter(({ choice }) => choice.value).map(({ column, choice }) => [column.name, choice.value])) });
  });
  const isDecided = proposal.state !== "ready" && proposal.state !== "refused";
  if (isDecided) return null;
  return h("details", { class: "import-facts", open: true }, h("summary", {}, "What the columns are"), form);
}
