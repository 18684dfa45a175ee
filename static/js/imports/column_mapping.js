/** What the columns of an asset file become: each with samples of its values; the file is read again with the answer. */

import { h, icon } from "../dom.js";
import { t } from "../text.js";
import { countText } from "../units.js";

const KINDS = { tower: t("Towers"), line: t("Power lines"), railway: t("Railways"), bridge: t("Bridges") };
const BY_GEOMETRY = "by_geometry";
const BY_COLUMN = "column";
const MEANINGS = {
  key: t("Key: tells them apart"),
  kind: t("Kind of asset"),
  ref: t("Reference"),
  name: t("Name"),
  operator: t("Operator"),
  "voltage:V": t("Voltage in V"),
  "voltage:kV": t("Voltage in kV"),
  circuits: t("Circuits"),
  "height:m": t("Height in m"),
  "height:ft": t("Height in feet"),
  subtype: t("Type within its kind"),
};
const PLACES = { lon: t("Longitude, or x"), lat: t("Latitude, or y"), wkt: t("Geometry as WKT") };

/** "voltage:kV" → "voltage": a meaning that only one column can have. */
const roleOf = (meaning) => meaning.split(":")[0];

/** The meaning of each column by name, as a mapping of the API says it. */
export function meaningsOf({ kind, columns = {}, units = {}, geometry = {} }) {
  const found = {};
  for (const [role, name] of Object.entries(columns)) {
    if (role === "voltage" || role === "height")
      found[name] ??= `${role}:${units[role] ?? (role === "voltage" ? "V" : "m")}`;
    else found[name] ??= role;
  }
  for (const [role, name] of Object.entries(geometry)) found[name] = role;
  if (kind?.column) found[kind.column] = "kind";
  return found;
}

/** The same backwards. `kind`: one of the kinds, "by_geometry", or "column" with what its values mean. */
export function mappingOf(meanings, kind, kindValues) {
  const mapping = { kind: kind || null, columns: {}, units: {}, geometry: {} };
  for (const [name, meaning] of Object.entries(meanings)) {
    const role = roleOf(meaning);
    if (meaning === "kind") {
      if (kind === BY_COLUMN) mapping.kind = { column: name, values: kindValues };
    } else if (role in PLACES) mapping.geometry[role] = name;
    else if (meaning) {
      mapping.columns[role] = name;
      const unit = meaning.split(":")[1];
      if (unit) mapping.units[role] = unit;
    }
  }
  if (mapping.kind === BY_COLUMN) mapping.kind = null;
  return mapping;
}

/** Each role once: what another column had of it is taken from that one. */
export function withMeaning(meanings, name, meaning) {
  const rest = Object.entries(meanings).filter(
    ([other, known]) => other !== name && (!meaning || roleOf(known) !== roleOf(meaning)),
  );
  return meaning ? { ...Object.fromEntries(rest), [name]: meaning } : Object.fromEntries(rest);
}

let count = 0;

/** readAgain(parameters) has the file read with this mapping. */
export function columnMapping({ summary, parameters, state }, readAgain) {
  if (state !== "ready") return null;
  const id = `columns-${(count += 1)}`;
  const stated = Object.keys(summary.mapping ?? {}).length ? summary.mapping : (summary.suggested_mapping ?? {});
  const isTable = summary.format === "csv";
  let meanings = meaningsOf(stated);
  const kindValues = { ...(stated.kind?.values ?? {}) };
  const option = ([value, words]) => h("option", { value }, words);
  const field = (words, control, hint) =>
    h(
      "div",
      { class: "field" },
      h("label", { for: control.id }, words),
      control,
      hint && h("span", { class: "caption" }, hint),
    );

  const kind = h(
    "select",
    { class: "input", id: `${id}-kind` },
    [
      ["", t("Choose")],
      [BY_GEOMETRY, t("Points towers, lines power lines, areas bridges")],
      ...Object.entries(KINDS),
      [BY_COLUMN, t("What a column says")],
    ].map(option),
  );
  kind.value = stated.kind?.column ? BY_COLUMN : (stated.kind ?? "");
  const values = h("div", { class: "kind-values" });
  const choices = new Map();

  function drawValues() {
    const name = Object.keys(meanings).find((known) => meanings[known] === "kind");
    const column = kind.value === BY_COLUMN && summary.columns.find((known) => known.name === name);
    if (kind.value === BY_COLUMN && !column)
      return values.replaceChildren(h("p", { class: "caption" }, t("Say below which column has the kind.")));
    values.replaceChildren(
      ...Object.entries((column && column.values) || {}).map(([value, rows], place) => {
        const choice = h(
          "select",
          { class: "input", id: `${id}-value-${place}` },
          [["", t("Left out")], ...Object.entries(KINDS)].map(option),
        );
        choice.value = kindValues[value] ?? "";
        kindValues[value] = choice.value;
        choice.addEventListener("change", () => (kindValues[value] = choice.value));
        return h(
          "div",
          { class: "column-row" },
          h(
            "div",
            { class: "column-name" },
            h("label", { for: choice.id }, value),
            h("span", { class: "caption" }, countText(rows, "row")),
          ),
          choice,
        );
      }),
    );
  }

  function show() {
    for (const [name, choice] of choices) choice.value = meanings[name] ?? "";
    drawValues();
  }

  kind.addEventListener("change", () => {
    if (kind.value !== BY_COLUMN)
      meanings = Object.fromEntries(Object.entries(meanings).filter(([, meaning]) => meaning !== "kind"));
    show();
  });

  const rows = summary.columns.map((column, place) => {
    const can = Object.entries(MEANINGS).filter(([meaning]) => meaning !== "kind" || column.values);
    const choice = h(
      "select",
      { class: "input", id: `${id}-${place}`, "aria-describedby": `${id}-${place}-samples` },
      [["", t("Kept as a tag")], ...can, ...(isTable ? Object.entries(PLACES) : [])].map(option),
    );
    choices.set(column.name, choice);
    choice.addEventListener("change", () => {
      meanings = withMeaning(meanings, column.name, choice.value);
      if (choice.value === "kind") kind.value = BY_COLUMN;
      show();
    });
    const samples = (column.samples ?? []).map(String).join(" · ") || t("always empty");
    return h(
      "div",
      { class: "column-row" },
      h(
        "div",
        { class: "column-name" },
        h("label", { for: choice.id }, column.name),
        h("span", { class: "caption", id: `${id}-${place}-samples`, title: samples }, samples),
      ),
      choice,
    );
  });

  const system = h("input", {
    class: "input",
    id: `${id}-crs`,
    placeholder: summary.crs || "EPSG:4326",
    value: parameters.crs ?? "",
    maxlength: "40",
  });
  const layer = h(
    "select",
    { class: "input", id: `${id}-layer` },
    (summary.layers ?? []).map((name) => option([name, name])),
  );
  layer.value = summary.layer ?? "";
  const form = h(
    "form",
    { class: "column-form", "aria-label": t("What the columns are") },
    (summary.layers ?? []).length > 1 && field(t("Layer"), layer),
    field(t("These are"), kind),
    values,
    h("p", { class: "field-label" }, t("Columns")),
    rows,
    field(t("Coordinate system"), system, t("Only where the file does not say it.")),
    h(
      "div",
      { class: "row-acts" },
      h(
        "button",
        { type: "submit", class: summary.needs_mapping ? "button primary" : "button" },
        icon("eye", "small"),
        t("Show what would change"),
      ),
    ),
  );
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    const mapping = mappingOf(meanings, kind.value, kindValues);
    if (!isTable) delete mapping.geometry;
    const crs = system.value.trim();
    readAgain({
      ...mapping,
      ...(crs || parameters.crs ? { crs: crs || null } : {}),
      ...(layer.options.length > 1 ? { layer: layer.value } : {}),
    });
  });
  show();
  return h(
    "details",
    { class: "import-facts", open: Boolean(summary.needs_mapping) },
    h("summary", {}, t("What the columns are")),
    form,
  );
}
