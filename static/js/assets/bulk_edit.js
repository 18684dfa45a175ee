/** Facts of assets that can be corrected for many at once. */

import { h } from "../dom.js";
import { t, tn } from "../text.js";
import { numberText } from "../units.js";
import { MAX_KV, voltsOf } from "./voltages.js";

/** @import { AssetFeature } from "../api_types.d.ts" */
/** @import { BulkEdit, BulkFact } from "../register/types.d.ts" */

/** @param {HTMLElement} control @param {string} [unit] */
function newValue(control, unit) {
  control.id = "bulk-value";
  const words = unit ? `${t("New value")} [${unit}]` : t("New value");
  return h("div", { class: "field" }, h("label", { for: control.id }, words), control);
}

/** @param {{ min: number, max: number, step: number | "any" }} limits @param {string} [unit] @returns {BulkFact["field"]} */
const numberField = (limits, unit) => () => {
  const number = h("input", { class: "input", type: "number", ...limits });
  const read = () => (number.validity.valid ? (number.value === "" ? null : number.valueAsNumber) : undefined);
  return { element: newValue(number, unit), read };
};

/** @param {(text: string) => unknown} read @param {string} [unit] @param {string} [placeholder] @returns {BulkFact["field"]} */
const textField = (read, unit, placeholder) => () => {
  const text = h("input", { class: "input", type: "text", maxlength: 255, placeholder });
  return { element: newValue(text, unit), read: () => read(text.value.trim()) };
};

function yesOrNo() {
  const choices = [
    ["true", t("yes")],
    ["false", t("no")],
  ];
  const select = h(
    "select",
    { class: "input" },
    choices.map(([value, words]) => h("option", { value }, words)),
  );
  return { element: newValue(select), read: () => select.value === "true" };
}

/** @type {Record<string, BulkFact>} */
const FACTS = {
  operator: { words: t("Operator"), field: textField((text) => text) },
  voltages_v: {
    words: t("Voltages"),
    field: textField((text) => voltsOf(text) ?? undefined, "kV", "110, 20"),
    fault: t("Write kilovolts up to {most}, such as 110, 20.", { most: MAX_KV }),
  },
  circuits: { words: t("Circuits"), field: numberField({ min: 1, max: 100, step: 1 }) },
  height_m: { words: t("Height above ground"), field: numberField({ min: 0.1, max: 1000, step: "any" }, "m") },
  is_flyable: { words: t("Used for routing"), field: yesOrNo },
};

/** @param {() => unknown} reload @returns {BulkEdit<AssetFeature>} */
export const assetEdit = (reload) => ({
  path: "/assets/edits",
  facts: FACTS,
  chosen: (rows) => ({ ids: rows.map(({ id }) => id) }),
  note: t("A blank value means not stated. Later imports leave these assets alone, and each keeps its history."),
  words: {
    change: (count) => tn(count, "Change {count} asset", "Change {count} assets", { count: numberText(count) }),
    changed: (count) => tn(count, "{count} asset changed.", "{count} assets changed.", { count: numberText(count) }),
    undone: (count) =>
      tn(count, "{count} asset is as before.", "{count} assets are as before.", { count: numberText(count) }),
    kept: (count) => tn(count, "{count} was changed since and stays.", "{count} were changed since and stay."),
    tooMany: (most) => t("At most {most} assets at once: narrow the filters.", { most }),
  },
  reload,
});
