/** The page "Assets": search, view, draw, correct. */

import { byId, find, h, segments, term } from "../dom.js";
import { mountRecordPage } from "../ground/record_page.js";
import { countsText } from "../map/look/region_words.js";
import { loadMapLibrary } from "../map/maplibre.js";
import { readPage } from "../page/chrome.js";
import { editMarked } from "../register/bulk_edit.js";
import { t, tn } from "../text.js";
import {
  coordinateText,
  dateText,
  exactHeightText,
  lengthText,
  numberText,
  percentText,
  voltageText,
  whenText,
} from "../units.js";
import { closeViewPlan, viewPlanPart } from "../view_plan/panel.js";
import { assetEdit } from "./bulk_edit.js";
import { mountFilters } from "./filters.js";
import { assetForm } from "./form.js";
import { inspectionsPart, planButton, planInspection, resultsPart } from "./inspections.js";

/** @import { AssetCounts, AssetDetailFeature, AssetDetailProperties, AssetFeature } from "../api_types.d.ts" */
/** @import { ShapeKind } from "../draw/types.d.ts" */
/** @import { GroundPage, RecordFeature, RecordKind } from "../ground/types.d.ts" */
/** @import { Register } from "../register/types.d.ts" */

/** @type {[string, string][]} */
const KINDS = [
  ["tower", t("Towers")],
  ["line", t("Lines")],
  ["railway", t("Railways")],
  ["bridge", t("Bridges")],
];
/** @type {Record<string, string>} */
const NEW_NAMES = {
  tower: t("New power tower"),
  line: t("New power line"),
  railway: t("New railway"),
  bridge: t("New bridge"),
};
/** @type {Record<string, string>} */
const NAMES = { tower: t("Power tower"), line: t("Power line"), railway: t("Railway"), bridge: t("Bridge") };
/** @type {Record<string, ShapeKind>} */
const SHAPES = { tower: "point", line: "line", railway: "line", bridge: "area" };
const ALMOST_ALL = 0.999;
let kind = ""; // that the list is narrowed to
/** @type {(keyof AssetDetailProperties)[]} */
const FACTS = ["subtype", "name", "ref", "operator", "voltages_v", "circuits", "height_m", "is_flyable"];
/** @param {AssetDetailFeature} feature */
const factsOf = ({ properties, geometry }) => ({
  ...Object.fromEntries(FACTS.map((name) => [name, properties[name]])),
  geometry,
});

/** When it was inspected last, and how much of a line. @param {AssetFeature["properties"]} properties */
function inspectedText({ inspected_at: at, inspected_share: share }) {
  if (!at) return t("never");
  if (share === null || share >= ALMOST_ALL) return dateText(at);
  return t("{date}, {share} of its length", { date: dateText(at), share: percentText(Math.floor(share * 100)) });
}

/** @param {AssetDetailFeature} feature */
function sourceWords({ properties }) {
  const { source, osm, asset_set: set } = properties;
  if (osm) {
    const kind = osm[0] === "n" ? "node" : osm[0] === "w" ? "way" : "relation";
    return [
      h(
        "a",
        { href: `https://www.openstreetmap.org/${kind}/${osm.slice(1)}`, rel: "noreferrer", target: "_blank" },
        `OpenStreetMap ${kind} ${osm.slice(1)}`,
      ),
      source ? `, ${source.file_name}` : "",
    ];
  }
  return set ? [`${set}${source ? `, ${source.file_name}` : ""}`] : [t("Drawn in Spanwise")];
}

/** @param {AssetDetailFeature} feature */
function details(feature) {
  const { properties } = feature;
  const tags = Object.entries(properties.tags ?? {});
  return [
    h("p", { class: "caption" }, [NAMES[properties.kind], properties.detail].filter(Boolean).join(" · ")),
    properties.vanished_at &&
      h(
        "div",
        { class: "notice warning" },
        h(
          "p",
          {},
          h("strong", {}, `${t("Deleted.")} `),
          t("Since {when}; missions still know it.", { when: whenText(properties.vanished_at) }),
        ),
      ),
    properties.is_edited && h("p", { class: "caption" }, t("Edited by hand: imports leave it alone.")),
    h(
      "dl",
      { class: "facts" },
      term(t("Ref"), properties.ref),
      term(t("Name"), properties.name),
      term(t("Operator"), properties.operator),
      term(t("Voltages"), properties.voltages_v.map((volts) => voltageText(volts / 1000)).join(", ")),
      term(t("Circuits"), properties.circuits && String(properties.circuits)),
      term(
        t("Height"),
        properties.height_m && t("{height} above ground", { height: exactHeightText(properties.height_m) }),
      ),
      term(t("Length"), properties.length_m && lengthText(properties.length_m)),
      term(t("Last inspection"), properties.inspected_at && inspectedText(properties)),
      term(t("Network"), properties.is_flyable ? "" : t("Not used for routing")),
      term(t("Place"), coordinateText(properties.centre)),
      term(t("Source"), sourceWords(feature)),
      term(t("Licence"), properties.source?.licence),
      term(t("Attribution"), properties.source?.attribution),
      term(t("Fetched"), properties.source?.fetched_at && whenText(properties.source.fetched_at)),
      term(t("Changed"), whenText(properties.updated_at)),
    ),
    tags.length > 0 &&
      h(
        "details",
        { class: "draw-vertices" },
        h("summary", {}, tn(tags.length, "{count} tag of the source", "{count} tags of the source")),
        h(
          "dl",
          { class: "facts" },
          tags.map(([key, value]) => [h("dt", {}, h("code", {}, key)), h("dd", { translate: "no" }, String(value))]),
        ),
      ),
  ].filter((part) => part instanceof Node);
}

/** The way to the photos of a tower or a bridge. @param {AssetDetailFeature} feature */
const photosPart = ({ id, properties }) =>
  (properties.kind === "tower" || properties.kind === "bridge") &&
  !properties.vanished_at &&
  viewPlanPart({ id, kind: properties.kind }, records.map, {
    words: t("Plan an inspection with these photos"),
    act: (views) => planInspection(id, properties.label, { kind: "photo", views }),
  });

/** The towers of a line in the list. @param {number} id @param {string} label */
function showSupports(id, label) {
  kind = ""; // a line has towers, poles and portals
  find(document, "input[name=kind][value='']", HTMLInputElement).checked = true;
  records.back();
  filters.chooseLine(id, label);
}

/** @type {GroundPage} */
const page = readPage();
const regionNames = new Map((page.regions ?? []).map(({ id, name }) => [id, name]));
const filters = mountFilters(page.regions ?? [], () => records.load());

/** @type {Register<AssetFeature>} */
const REGISTER = {
  key: "assets",
  words: t("Assets"),
  order: "name",
  exports: "/assets/export",
  summary: "/assets/summary",
  canEdit: page.canCurate,
  name: ({ properties }) => properties.label,
  icon: ({ properties }) => properties.kind,
  columns: [
    { name: "label", words: t("Name"), sort: "name", cell: ({ properties }) => properties.label },
    { name: "kind", words: t("Kind"), sort: "kind", cell: ({ properties }) => NAMES[properties.kind] },
    {
      name: "voltage",
      words: t("Voltage"),
      sort: "voltage",
      isNumber: true,
      cell: ({ properties }) => properties.voltages_v.map((volts) => voltageText(volts / 1000)).join(", "),
    },
    { name: "operator", words: t("Operator"), sort: "operator", cell: ({ properties }) => properties.operator },
    { name: "line", words: t("Line"), cell: ({ properties }) => properties.line_label },
    {
      name: "inspected",
      words: t("Last inspection"),
      sort: "inspected",
      cell: ({ properties }) => inspectedText(properties),
    },
    { name: "detail", words: t("Details"), isOptional: true, cell: ({ properties }) => properties.detail },
    {
      name: "height",
      words: t("Height"),
      sort: "height",
      isNumber: true,
      isOptional: true,
      cell: ({ properties }) => (properties.height_m ? exactHeightText(properties.height_m) : ""),
    },
    {
      name: "length",
      words: t("Length"),
      sort: "length",
      isNumber: true,
      isOptional: true,
      cell: ({ properties }) => (properties.length_m ? lengthText(properties.length_m) : ""),
    },
    {
      name: "region",
      words: t("Region"),
      isOptional: true,
      cell: ({ properties }) => (properties.region && regionNames.get(properties.region)) || "",
    },
    {
      name: "routing",
      words: t("Used for routing"),
      isOptional: true,
      cell: ({ properties }) => (properties.is_flyable ? t("yes") : t("no")),
    },
    { name: "external", words: t("External ID"), isOptional: true, cell: ({ properties }) => properties.external_id },
    {
      name: "changed",
      words: t("Changed"),
      sort: "changed",
      isOptional: true,
      cell: ({ properties }) => whenText(properties.updated_at),
    },
  ],
  /** @param {AssetCounts} counts */
  counted(counts) {
    filters.counted(counts);
    byId("asset-counts").textContent = countsText(counts.kinds);
  },
  editWords: (count) => tn(count, "Edit {count} asset", "Edit {count} assets", { count: numberText(count) }),
  edit: (marked) =>
    editMarked(
      marked,
      assetEdit(() => records.reload()),
    ),
};

/** @type {RecordKind<AssetDetailFeature & RecordFeature, AssetFeature>} */
const ASSETS = {
  path: "/assets",
  key: "asset",
  findWords: t("Find an asset"),
  backWords: t("All assets"),
  pickKinds: ["tower", "line", "railway", "bridge"],
  newChoices: [
    { value: "tower", icon: "tower", words: t("Tower") },
    { value: "line", icon: "line", words: t("Power line") },
    { value: "railway", icon: "railway", words: t("Railway") },
    { value: "bridge", icon: "bridge", words: t("Bridge") },
  ],
  newTitle: (kind) => NEW_NAMES[kind],
  choiceOf: (feature) => feature.properties.kind,
  shapeKind: (kind) => SHAPES[kind],
  checkKind: (kind) => kind,
  fixedFacts: (kind) => ({ kind, tags: kind === "tower" ? { power: "tower" } : {} }),
  factsOf,
  factsOfBody: (body) => body,
  title: (feature) => feature.properties.label,
  details,
  form: assetForm,
  act: (feature) => (page.canPlan && feature.properties.is_flyable ? planButton(feature) : null),
  more: (feature) =>
    h("div", {}, photosPart(feature), resultsPart(feature, page), inspectionsPart(feature, showSupports, page)),
  closed: closeViewPlan,
  row: ({ properties }) => ({
    icon: properties.kind,
    name: properties.label,
    detail: properties.detail || NAMES[properties.kind],
    chip: properties.is_flyable ? "" : t("not flown"),
  }),
  narrowed: () => ({ kind, ...filters.narrowed() }),
  register: REGISTER,
  noneFound: t("Other words, another kind, or a larger part of the map may have it."),
  noneYet: {
    words: t("No assets yet."),
    begin: t("Import an OpenStreetMap file, or download the visible area from OpenStreetMap."),
  },
};
await loadMapLibrary();
const records = mountRecordPage(ASSETS);

byId("asset-kinds").append(
  ...segments("kind", [["", t("All")], ...KINDS], "", (value) => {
    kind = value;
    records.load();
  }),
);
records.start();
