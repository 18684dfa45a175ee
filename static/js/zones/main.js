/** The page "No-fly zones": search, view, draw, correct; sets and their sources. */

import { byId, find, h, icon, segments, setChildren, term } from "../dom.js";
import { scheduleText } from "../domain/schedule_words.js";
import { bandDrawing, heightsText } from "../domain/zone_heights.js";
import { mountRecordPage } from "../ground/record_page.js";
import { plainWords } from "../map/tips.js";
import { t } from "../text.js";
import { coordinateText, lengthText, minutesAheadOfUtc, whenText, zoneText } from "../units.js";
import { restrictionHint, zoneForm } from "./form.js";
import { mountImportButton } from "./import_button.js";
import { weekDrawing } from "./schedule_editor.js";
import { mountSetsPanel, validityText } from "./sets_panel.js";

/** @import { Limit, ZoneDetailFeature, ZoneFeature, ZoneSet } from "../api_types.d.ts" */
/** @import { Facts, RecordFeature, RecordKind } from "../ground/types.d.ts" */

/** That the list is narrowed to. @type {ZoneSet | null} */
let zoneSet = null;

/** @param {ZoneDetailFeature} feature @returns {Facts} */
function factsOf({ properties, geometry }) {
  const { name, restriction, reason, schedule, circle, lower_limit: lower, upper_limit: upper } = properties;
  return {
    name,
    restriction,
    reason,
    schedule,
    circle,
    ...limitFacts("lower", lower),
    ...limitFacts("upper", upper),
    geometry,
  };
}

/** @param {"lower" | "upper"} side @param {Limit | null} limit @returns {Facts} */
const limitFacts = (side, limit) => ({
  [`${side}_limit_m`]: limit?.value_m ?? null,
  [`${side}_reference`]: limit?.reference ?? "",
});

/** Values of a request, under the names of facts. @param {Facts} body @returns {Facts} */
function factsOfBody({ lower_limit: lower, upper_limit: upper, ...rest }) {
  return {
    ...rest,
    ...(lower === undefined ? {} : limitFacts("lower", /** @type {Limit | null} */ (lower))),
    ...(upper === undefined ? {} : limitFacts("upper", /** @type {Limit | null} */ (upper))),
  };
}

/** @param {ZoneDetailFeature} feature */
function details({ properties }) {
  const { source } = properties;
  const isTimed = Boolean(properties.schedule?.length);
  return [
    h(
      "p",
      { class: "caption" },
      [properties.restriction && plainWords(properties.restriction), properties.reason && plainWords(properties.reason)]
        .filter(Boolean)
        .join(" · ") || t("Restriction not stated"),
    ),
    h("p", { class: "caption" }, restrictionHint(properties.restriction ?? "")),
    h(
      "div",
      { class: "band" },
      bandDrawing(properties),
      h(
        "div",
        {},
        h("p", {}, heightsText(properties)),
        h("p", {}, scheduleText(properties.schedule, { otherwise: properties.schedule_words })),
        isTimed && h("p", { class: "caption" }, t("Times in {zone}.", { zone: zoneText(new Date().toISOString()) })),
      ),
    ),
    ...(properties.schedule ?? [])
      .filter((period) => period.schedule?.length)
      .slice(0, 3)
      .map((period) => weekDrawing(period, minutesAheadOfUtc(Date.now()) / 60)),
    properties.is_edited && h("p", { class: "caption" }, t("Edited by hand: imports leave it alone.")),
    h(
      "dl",
      { class: "facts" },
      term(
        t("Circle"),
        properties.circle &&
          t("{radius} round {place}", {
            radius: lengthText(properties.circle.radius_m),
            place: coordinateText(properties.circle.centre),
          }),
      ),
      term(t("Identifier"), properties.identifier.startsWith("drawn-") ? "" : properties.identifier),
      term(t("Zone set"), properties.zone_set ?? t("Drawn in Spanwise")),
      term(t("File"), source?.file_name),
      term(t("Licence"), source ? source.licence || t("not stated") : ""),
      term(t("Attribution"), source?.attribution),
      term(t("Valid"), source ? validityText(source) || t("not stated") : ""),
      term(t("Address"), source?.source_address),
      term(t("Fetched"), source?.fetched_at && whenText(source.fetched_at)),
      term(t("Imported"), source?.imported_at && whenText(source.imported_at)),
      term(t("Changed"), whenText(properties.updated_at)),
    ),
    h("p", { class: "caption" }, t("Data as published by its source. Check the legal status before flying.")),
  ].filter((part) => part instanceof Node);
}

/** @type {RecordKind<ZoneDetailFeature & RecordFeature, ZoneFeature>} */
const ZONES = {
  path: "/zones",
  key: "zone",
  findWords: t("Find a zone"),
  backWords: t("All zones"),
  pickKinds: ["zone"],
  newChoices: [
    { value: "area", icon: "pentagon", words: t("Area") },
    { value: "circle", icon: "circle", words: t("Circle") },
  ],
  newTitle: () => t("New no-fly zone"),
  choiceOf: (feature) => (feature.properties.circle ? "circle" : "area"),
  shapeKind: (choice) => (choice === "circle" ? "circle" : "area"),
  checkKind: () => "zone",
  fixedFacts: () => ({}),
  factsOf,
  factsOfBody,
  title: (feature) => feature.properties.name,
  details,
  form: zoneForm,
  row: ({ properties }) => ({
    icon: "zone",
    name: properties.name,
    detail: heightsText(properties),
    chip: properties.schedule ? t("at times") : "",
  }),
  narrowed: () => ({ zone_set: zoneSet ? String(zoneSet.id) : "" }),
  noneFound: t("Other words, or a larger part of the map may have it."),
  noneYet: {
    words: t("No zones yet."),
    begin: t("Draw one, or bring in an ED-269, ED-318, OpenAir or GeoJSON file."),
  },
};
const records = mountRecordPage(ZONES);

/** Shows which set the list is narrowed to. */
function showSet() {
  const name = zoneSet?.name;
  const clear = () => {
    zoneSet = null;
    showSet();
    records.load();
  };
  const label = t("No longer only {name}", { name });
  const button = { type: "button", class: "icon-button tight", "aria-label": label, onclick: clear };
  setChildren(
    byId("zone-set-filter"),
    zoneSet && h("span", { class: "chip" }, name, h("button", button, icon("x", "small"))),
  );
}

const importButton = byId("zone-import");
importButton.hidden = !records.page.canCurate;
mountImportButton(importButton, byId("zone-import-file", HTMLInputElement));

const sets = mountSetsPanel({
  askFile: () => importButton.click(),
  canCurate: records.page.canCurate,
  showZones(set) {
    zoneSet = set;
    showSet();
    turnTo("zones");
    records.load();
  },
});

/** @type {[string, string][]} */
const TABS = [
  ["zones", t("Zones")],
  ["sets", t("Sets and sources")],
];
/** @param {string} tab */
function turnTo(tab) {
  byId("zone-sets").hidden = tab !== "sets";
  if (tab === "sets") {
    for (const id of ["record-find", "record-show"]) byId(id).hidden = true;
    sets.load();
  } else records.go("find");
  find(document, `input[name=zone-tab][value=${tab}]`, HTMLInputElement).checked = true;
}
byId("zone-tabs").append(...segments("zone-tab", TABS, "zones", turnTo));
records.start();
