/** Filters of the register of assets beside kind and text: voltage, operator, line, region and last inspection. */

import { get } from "../api.js";
import { byId, h, setChildren } from "../dom.js";
import { filterField, withCount } from "../register/filters.js";
import { t } from "../text.js";
import { voltageText } from "../units.js";

/** @import { Answer } from "../api.js" */
/** @import { AssetCounts, AssetFeature } from "../api_types.d.ts" */
/** @import { Region } from "../map/types.d.ts" */

const TYPING_MS = 250;
const DAY_MS = 86_400_000;
/** Choices of the last inspection, as parameters of the API. @type {[string, string, () => Record<string, string>][]} */
const INSPECTED = [
  ["", t("Any time"), () => ({})],
  ["never", t("Never"), () => ({ inspected: "false" })],
  ["year", t("More than a year ago"), () => ({ inspected_before: dayBefore(365) })],
  ["recent", t("In the last 12 months"), () => ({ inspected_from: dayBefore(365) })],
  ["month", t("In the last 30 days"), () => ({ inspected_from: dayBefore(30) })],
];

/** @param {number} days @returns {string} the date, in UTC */
const dayBefore = (days) => new Date(Date.now() - days * DAY_MS).toISOString().slice(0, 10);

/** @param {Record<string, string>} words values to words @param {string} chosen */
const options = (words, chosen) =>
  Object.entries(words).map(([value, label]) => h("option", { value, selected: value === chosen }, label));

/**
 * Mount the filters. `change` is called after each change by the user.
 *
 * @param {Region[]} regions
 * @param {() => unknown} change
 */
export function mountFilters(regions, change) {
  const voltage = h("select", { class: "input", id: "filter-voltage", onchange: change });
  const operator = h("select", { class: "input", id: "filter-operator", onchange: change });
  const region = h("select", { class: "input", id: "filter-region", onchange: change });
  const inspected = h("select", { class: "input", id: "filter-inspected", onchange: change });
  const line = mountLineFilter(change);
  setChildren(
    region,
    h("option", { value: "" }, t("All regions")),
    regions.map(({ id, name }) => h("option", { value: id, translate: "no" }, name)),
  );
  setChildren(inspected, ...INSPECTED.map(([value, words]) => h("option", { value }, words)));
  const fields = [
    filterField(t("Voltage"), voltage),
    filterField(t("Operator"), operator),
    filterField(t("On the line"), line.input, line.choices),
    regions.length > 1 ? filterField(t("Region"), region) : null,
    filterField(t("Last inspection"), inspected),
  ];
  const clear = h("button", { type: "button", class: "text-button", onclick: () => reset() }, t("Clear the filters"));
  setChildren(byId("asset-filters"), ...fields, clear);
  byId("filter-fold", HTMLDetailsElement).open = !matchMedia("(max-width: 720px)").matches; // a phone has its list below
  counted({ total: 0, kinds: {}, voltages: [], operators: [] });

  function reset() {
    for (const select of [voltage, operator, region, inspected]) select.value = "";
    line.choose(null);
    change();
  }

  /** Show the values that assets have, with their counts. @param {AssetCounts} counts */
  function counted({ voltages, operators }) {
    const chosen = { voltage: voltage.value, operator: operator.value };
    /** @type {[string, string][]} */
    const volts = voltages.map((one) => [
      String(one.voltage_v),
      withCount(voltageText(one.voltage_v / 1000), one.count),
    ]);
    /** @type {[string, string][]} */
    const names = operators.map((one) => [one.operator, withCount(one.operator, one.count)]);
    const kept = (/** @type {string} */ value, /** @type {string} */ words) => (value ? { [value]: words } : {});
    const voltageWords = chosen.voltage ? voltageText(Number(chosen.voltage) / 1000) : "";
    setChildren(
      voltage,
      h("option", { value: "" }, t("All voltages")),
      // highest first: keys of an object that are numbers would be sorted upwards
      (volts.some(([value]) => value === chosen.voltage) || !chosen.voltage
        ? volts
        : [[chosen.voltage, voltageWords], ...volts]
      ).map(([value, words]) => h("option", { value, selected: value === chosen.voltage }, words)),
    );
    setChildren(
      operator,
      h("option", { value: "" }, t("All operators")),
      options(
        { ...kept(chosen.operator, withCount(chosen.operator, 0)), ...Object.fromEntries(names) },
        chosen.operator,
      ),
    );
  }

  return {
    counted,
    /** @returns {Record<string, string>} */
    narrowed: () => ({
      voltage_v: voltage.value,
      operator: operator.value,
      line: line.id(),
      region: region.value,
      ...INSPECTED.find(([value]) => value === inspected.value)?.[2](),
    }),
    /** Narrow the register to the supports of a line. @param {number} id @param {string} label */
    chooseLine(id, label) {
      line.choose({ id, label });
      change();
    },
  };
}

/** A line is found by its name, reference or operator, and chosen from the proposals. @param {() => unknown} change */
function mountLineFilter(change) {
  const choices = h("datalist", { id: "filter-line-choices" });
  const input = h("input", {
    class: "input",
    id: "filter-line",
    type: "search",
    list: "filter-line-choices",
    maxlength: 100,
    autocomplete: "off",
    placeholder: t("Ref, name or operator"),
  });
  /** Ids of proposed lines by their words. @type {Map<string, number>} */
  const known = new Map();
  /** @type {number | null} */
  let chosen = null;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;
  input.addEventListener("input", () => {
    const id = known.get(input.value) ?? null;
    if (id !== chosen) {
      chosen = id;
      change();
    }
    clearTimeout(timer);
    if (id === null && input.value.trim()) timer = setTimeout(propose, TYPING_MS);
  });

  async function propose() {
    const query = new URLSearchParams({ kind: "line", text: input.value.trim(), limit: "12" });
    const { data } = /** @type {Answer<{ features: AssetFeature[] }>} */ (await get(`/assets?${query}`));
    known.clear();
    for (const { id, properties } of data.features) {
      const words = [properties.label, properties.detail].filter(Boolean).join(" · ");
      known.set(known.has(words) ? `${words} · ${id}` : words, id);
    }
    setChildren(choices, ...[...known.keys()].map((value) => h("option", { value })));
  }

  return {
    input,
    choices,
    id: () => (chosen === null ? "" : String(chosen)),
    /** @param {{ id: number, label: string } | null} line */
    choose(line) {
      chosen = line?.id ?? null;
      input.value = line?.label ?? "";
      if (line) known.set(line.label, line.id);
    },
  };
}
