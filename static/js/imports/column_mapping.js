/** What the columns of an asset file become: each with samples of its values; the file is read again with the answer. */

import { h, icon, setChildren } from "../dom.js";
import { t, tn } from "../text.js";

/** @import { Column, Mapping, Parameters, Proposal } from "./types.d.ts" */

/** @type {Record<string, string>} */
const KINDS = { tower: t("Towers"), line: t("Power lines"), railway: t("Railways"), bridge: t("Bridges") };
/** The meaning of each column, by its name. @typedef {Record<string, string>} Meanings */

const BY_GEOMETRY = "by_geometry";
const BY_COLUMN = "column";
/** @type {Record<string, string>} */
const MEANINGS = {
  key: t("Key: tells them apart"),
  kind: t("Kind of asset"),
  external_id: t("External id: your own, of each asset"),
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
/** @type {Record<string, string>} */
const PLACES = { lon: t("Longitude, or x"), lat: t("Latitude, or y"), wkt: t("Geometry as WKT") };

/** "voltage:kV" → "voltage": a meaning that only one column can have. @param {string} meaning */
const roleOf = (meaning) => meaning.split(":")[0];

/** The meaning of each column by name, from a mapping of the API. @param {Mapping} mapping */
export function meaningsOf({ kind, columns = {}, units = {}, geometry = {} }) {
  /** @type {Meanings} */
  const found = {};
  for (const [role, name] of Object.entries(columns)) {
    if (role === "voltage" || role === "height")
      found[name] ??= `${role}:${units[role] ?? (role === "voltage" ? "V" : "m")}`;
    else found[name] ??= role;
  }
  for (const [role, name] of Object.entries(geometry)) found[name] = role;
  if (typeof kind === "object" && kind?.column) found[kind.column] = "kind";
  return found;
}

/**
 * The same backwards. `kind`: one of the kinds, "by_geometry", or "column" with what its values mean.
 *
 * @param {Meanings} meanings
 * @param {string} kind
 * @param {Record<string, string>} kindValues
 * @returns {Required<Mapping>}
 */
export function mappingOf(meanings, kind, kindValues) {
  /** @type {Required<Mapping>} */
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

/**
 * Assign a meaning. Each is used once: a column that had it loses it.
 *
 * @param {Meanings} meanings
 * @param {string} name
 * @param {string} meaning
 * @returns {Meanings}
 */
export function withMeaning(meanings, name, meaning) {
  const rest = Object.entries(meanings).filter(
    ([other, known]) => other !== name && (!meaning || roleOf(known) !== roleOf(meaning)),
  );
  return meaning ? { ...Object.fromEntries(rest), [name]: meaning } : Object.fromEntries(rest);
}

let made = 0;

/**
 * A form for the mapping; readAgain(parameters) reads the file again with it. Null while no decision is possible.
 *
 * @param {Proposal} proposal
 * @param {(parameters: Parameters) => void} readAgain
 */
export const columnMapping = (proposal, readAgain) =>
  proposal.state === "ready" ? new ColumnMapping(proposal, readAgain).element : null;

/** @param {readonly [string, string]} choice */
const option = ([value, words]) => h("option", { value }, words);

/** @param {string} words @param {HTMLElement} control @param {string} [hint] */
const field = (words, control, hint) =>
  h(
    "div",
    { class: "field" },
    h("label", { for: control.id }, words),
    control,
    hint && h("span", { class: "caption" }, hint),
  );

/**
 * A row: a name with a caption, and the control of its choice.
 * @param {string} name @param {HTMLElement} caption @param {HTMLElement} choice
 */
const columnRow = (name, caption, choice) =>
  h(
    "div",
    { class: "column-row" },
    h("div", { class: "column-name" }, h("label", { for: choice.id }, name), caption),
    choice,
  );

class ColumnMapping {
  #summary;
  #parameters;
  #readAgain;
  #id;
  #isTable;
  /** @type {Meanings} */
  #meanings;
  /** What the values of the column of kinds mean. @type {Record<string, string>} */
  #kindValues;
  #kind;
  #system;
  #layer;
  #values = h("div", { class: "kind-values" });
  /** By column. @type {Map<string, HTMLSelectElement>} */
  #choices = new Map();

  /** @param {Proposal} proposal @param {(parameters: Parameters) => void} readAgain */
  constructor({ summary, parameters }, readAgain) {
    made += 1;
    this.#id = `columns-${made}`;
    this.#summary = summary;
    this.#parameters = parameters;
    this.#readAgain = readAgain;
    this.#isTable = summary.format === "csv";
    const stated = summary.mapping && Object.keys(summary.mapping).length ? summary.mapping : summary.suggested_mapping;
    const { kind } = stated ?? {};
    this.#meanings = meaningsOf(stated ?? {});
    this.#kindValues = typeof kind === "object" ? { ...kind?.values } : {};
    this.#kind = this.#kindChoice(typeof kind === "string" ? kind : kind?.column ? BY_COLUMN : "");
    this.#system = h("input", {
      class: "input",
      id: `${this.#id}-crs`,
      placeholder: summary.crs || "EPSG:4326",
      value: parameters.crs ?? "",
      maxlength: "40",
    });
    const layers = summary.layers ?? [];
    this.#layer = h(
      "select",
      { class: "input", id: `${this.#id}-layer` },
      layers.map((name) => option([name, name])),
    );
    this.#layer.value = summary.layer ?? "";
    this.element = h(
      "details",
      { class: "import-facts", open: Boolean(summary.needs_mapping) },
      h("summary", {}, t("What the columns are")),
      this.#form(),
    );
    this.#show();
  }

  #form() {
    const { columns = [], layers = [], needs_mapping } = this.#summary;
    const look = needs_mapping ? "button primary" : "button";
    const rows = columns.map((column, place) => this.#columnRow(column, place));
    const form = h(
      "form",
      { class: "column-form", "aria-label": t("What the columns are") },
      layers.length > 1 && field(t("Layer"), this.#layer),
      field(t("These are"), this.#kind),
      this.#values,
      h("p", { class: "field-label" }, t("Columns")),
      rows,
      field(t("Coordinate system"), this.#system, t("Only where the file does not say it.")),
      h(
        "div",
        { class: "row-acts" },
        h("button", { type: "submit", class: look }, icon("eye", "small"), t("Show what would change")),
      ),
    );
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.#readAgain(this.#read());
    });
    return form;
  }

  /** @param {string} chosen */
  #kindChoice(chosen) {
    /** @type {[string, string][]} */
    const choices = [
      ["", t("Choose")],
      [BY_GEOMETRY, t("Points towers, lines power lines, areas bridges")],
      ...Object.entries(KINDS),
      [BY_COLUMN, t("What a column says")],
    ];
    const choice = h("select", { class: "input", id: `${this.#id}-kind` }, choices.map(option));
    choice.value = chosen;
    choice.addEventListener("change", () => {
      const others = Object.entries(this.#meanings).filter(([, meaning]) => meaning !== "kind");
      if (choice.value !== BY_COLUMN) this.#meanings = Object.fromEntries(others);
      this.#show();
    });
    return choice;
  }

  /** @param {Column} column @param {number} place */
  #columnRow(column, place) {
    const id = `${this.#id}-${place}`;
    const can = Object.entries(MEANINGS).filter(([meaning]) => meaning !== "kind" || column.values);
    const places = this.#isTable ? Object.entries(PLACES) : [];
    /** @type {[string, string][]} */
    const meanings = [["", t("Kept as a tag")], ...can, ...places];
    const look = { class: "input", id, "aria-describedby": `${id}-samples` };
    const choice = h("select", look, meanings.map(option));
    this.#choices.set(column.name, choice);
    choice.addEventListener("change", () => {
      this.#meanings = withMeaning(this.#meanings, column.name, choice.value);
      if (choice.value === "kind") this.#kind.value = BY_COLUMN;
      this.#show();
    });
    const none = column.is_withheld ? t("ids of another organisation") : t("always empty");
    const samples = (column.samples ?? []).map(String).join(" · ") || none;
    const caption = h("span", { class: "caption", id: `${id}-samples`, title: samples }, samples);
    return columnRow(column.name, caption, choice);
  }

  #show() {
    for (const [name, choice] of this.#choices) choice.value = this.#meanings[name] ?? "";
    this.#drawValues();
  }

  /** Draw the meaning of each value of a column that states the kind. */
  #drawValues() {
    if (this.#kind.value !== BY_COLUMN) {
      this.#values.replaceChildren();
      return;
    }
    const name = Object.keys(this.#meanings).find((known) => this.#meanings[known] === "kind");
    const column = (this.#summary.columns ?? []).find((known) => known.name === name);
    const question = h("p", { class: "caption" }, t("Say below which column has the kind."));
    const values = Object.entries(column?.values ?? {});
    setChildren(
      this.#values,
      column ? values.map(([value, rows], place) => this.#valueRow(value, rows, place)) : question,
    );
  }

  /** @param {string} value @param {number} rows that have it @param {number} place */
  #valueRow(value, rows, place) {
    const choice = h(
      "select",
      { class: "input", id: `${this.#id}-value-${place}` },
      option(["", t("Left out")]),
      Object.entries(KINDS).map(option),
    );
    const kindValues = this.#kindValues;
    choice.value = kindValues[value] ?? "";
    kindValues[value] = choice.value;
    choice.addEventListener("change", () => {
      kindValues[value] = choice.value;
    });
    return columnRow(value, h("span", { class: "caption" }, tn(rows, "{count} row", "{count} rows")), choice);
  }

  #read() {
    const { geometry, ...mapping } = mappingOf(this.#meanings, this.#kind.value, this.#kindValues);
    const crs = this.#system.value.trim();
    return {
      ...mapping,
      ...(this.#isTable ? { geometry } : {}),
      ...(crs || this.#parameters.crs ? { crs: crs || null } : {}),
      ...(this.#layer.options.length > 1 ? { layer: this.#layer.value } : {}),
    };
  }
}
