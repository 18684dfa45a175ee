/** The page "Assets": search, view, draw, correct. */

import { byId, h, segments, term } from "../dom.js";
import { mountRecordPage } from "../ground/record_page.js";
import { t, tn } from "../text.js";
import { coordinateText, exactHeightText, lengthText, voltageText, whenText } from "../units.js";
import { assetForm } from "./form.js";

/** @import { AssetDetailFeature, AssetDetailProperties, AssetFeature } from "../api_types.d.ts" */
/** @import { ShapeKind } from "../draw/types.d.ts" */
/** @import { RecordFeature, RecordKind } from "../ground/types.d.ts" */

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
let kind = ""; // that the list is narrowed to
/** @type {(keyof AssetDetailProperties)[]} */
const FACTS = ["subtype", "name", "ref", "operator", "voltages_v", "circuits", "height_m", "is_flyable"];
/** @param {AssetDetailFeature} feature */
const factsOf = ({ properties, geometry }) => ({
  ...Object.fromEntries(FACTS.map((name) => [name, properties[name]])),
  geometry,
});

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
  row: ({ properties }) => ({
    icon: properties.kind,
    name: properties.label,
    detail: properties.detail || NAMES[properties.kind],
    chip: properties.is_flyable ? "" : t("not flown"),
  }),
  narrowed: () => ({ kind }),
  noneFound: t("Other words, another kind, or a larger part of the map may have it."),
  noneYet: {
    words: t("No assets yet."),
    begin: t("Import an OpenStreetMap file, or download the visible area from OpenStreetMap."),
  },
};
const records = mountRecordPage(ASSETS);

byId("asset-kinds").append(
  ...segments("kind", [["", t("All")], ...KINDS], "", (value) => {
    kind = value;
    records.load();
  }),
);
records.start();
