/** The facts of an asset as fields. */

import { h } from "../dom.js";
import { t } from "../text.js";
import { MAX_KV, voltsOf } from "./voltages.js";

/** @import { AssetDetailFeature, AssetDetailProperties } from "../api_types.d.ts" */
/** @import { Facts, RecordForm } from "../ground/types.d.ts" */

/** @type {Record<string, [string, string][]>} */
const SUBTYPES = {
  tower: [
    ["tower", t("Tower")],
    ["pole", t("Pole")],
    ["portal", t("Portal")],
  ],
  line: [
    ["line", t("Line")],
    ["minor_line", t("Minor line")],
    ["cable", t("Cable")],
  ],
  railway: [
    ["rail", t("Railway")],
    ["light_rail", t("Light rail")],
    ["tram", t("Tramway")],
    ["subway", t("Subway")],
  ],
  bridge: [["area", t("Bridge")]],
};

/** @param {string} id @param {string} words @param {HTMLElement} input @param {string} [unit] */
const field = (id, words, input, unit) =>
  h(
    "div",
    { class: "field" },
    h("label", { for: id }, words),
    unit ? h("div", { class: "with-unit" }, input, h("span", { class: "unit" }, unit)) : input,
  );
/** @param {string} id @param {string | null | undefined} value @param {number} [longest] */
const text = (id, value, longest = 255) =>
  h("input", {
    class: "input",
    id,
    type: "text",
    maxlength: longest,
    value: value ?? "",
    autocomplete: "off",
    spellcheck: "false",
  });
/** @param {string} id @param {number | null | undefined} value @param {object} rest */
const number = (id, value, rest) => h("input", { class: "input", id, type: "number", value: value ?? "", ...rest });

/** @param {HTMLInputElement} input */
const numberOrNull = (input) => (input.value === "" ? null : Number(input.value));

/**
 * @param {AssetDetailFeature | null} feature null for a new one
 * @param {string} kind
 * @param {Facts | null} kept values of an edit that is resumed
 * @returns {RecordForm}
 */
export function assetForm(feature, kind, kept) {
  /** @type {Partial<AssetDetailProperties>} */
  const facts = { ...feature?.properties, ...kept };
  const isPower = kind === "tower" || kind === "line";
  const subtypes = SUBTYPES[kind];
  const isOther = facts.subtype && !subtypes.some(([value]) => value === facts.subtype);
  const subtype = h(
    "select",
    { class: "input", id: "asset-subtype" },
    [...subtypes, ...(isOther ? [[facts.subtype, facts.subtype]] : [])].map(([value, words]) =>
      h("option", { value, selected: value === (facts.subtype || subtypes[0][0]) }, words),
    ),
  );
  const ref = text("asset-ref", facts.ref);
  const name = text("asset-name", facts.name);
  const operator = text("asset-operator", facts.operator);
  const voltages = text("asset-voltages", (facts.voltages_v ?? []).map((volts) => volts / 1000).join(", "), 60);
  const checkVoltages = () =>
    voltages.setCustomValidity(
      voltsOf(voltages.value) ? "" : t("Write kilovolts up to {most}, such as 110, 20.", { most: MAX_KV }),
    );
  voltages.addEventListener("input", checkVoltages);
  const circuits = number("asset-circuits", facts.circuits, { min: 1, max: 100, step: 1 });
  const height = number("asset-height", facts.height_m, { min: 0.1, max: 1000, step: "any" });
  const flyable = h("input", {
    class: "check",
    id: "asset-flyable",
    type: "checkbox",
    checked: facts.is_flyable ?? true,
  });
  const element = h(
    "form",
    { class: "record-form", onsubmit: (event) => event.preventDefault() },
    field("asset-subtype", t("Type"), subtype),
    h("div", { class: "pair" }, field("asset-ref", t("Ref"), ref), field("asset-name", t("Name"), name)),
    field("asset-operator", t("Operator"), operator),
    isPower &&
      h(
        "div",
        { class: "pair" },
        field("asset-voltages", t("Voltages, highest first"), voltages, "kV"),
        kind === "line"
          ? field("asset-circuits", t("Circuits"), circuits)
          : field("asset-height", t("Height above ground"), height, "m"),
      ),
    !isPower && field("asset-height", t("Height above ground"), height, "m"),
    h("label", { class: "switch-line" }, flyable, t("Used for routing")),
  );
  return {
    element,
    read() {
      /** @type {Facts} */
      const read = {
        subtype: subtype.value,
        ref: ref.value.trim(),
        name: name.value.trim(),
        operator: operator.value.trim(),
        is_flyable: flyable.checked,
      };
      if (isPower) read.voltages_v = voltsOf(voltages.value) ?? [];
      if (kind === "line") read.circuits = numberOrNull(circuits);
      else read.height_m = numberOrNull(height);
      return read;
    },
  };
}
