/** The page "No-fly zones": search, view, draw, correct; sets and their sources. */

import { byId, find, h, segments, term } from "../dom.js";
import { scheduleText } from "../domain/schedule_words.js";
import { bandDrawing, heightsText, limitText } from "../domain/zone_heights.js";
import { mountRecordPage } from "../ground/record_page.js";
import { loadMapLibrary } from "../map/maplibre.js";
import { plainWords } from "../map/tips.js";
import { readPage } from "../page/chrome.js";
import { editMarked } from "../register/bulk_edit.js";
import { t, tn } from "../text.js";
import {
  clockText,
  coordinateText,
  dayText,
  lengthText,
  minutesAheadOfUtc,
  numberText,
  whenText,
  zoneText,
} from "../units.js";
import { zoneEdit } from "./bulk_edit.js";
import { mountZoneFilters } from "./filters.js";
import { restrictionHint, zoneForm } from "./form.js";
import { mountImportButton } from "./import_button.js";
import { weekDrawing } from "./schedule_editor.js";
import { mountSetsPanel, validityText } from "./sets_panel.js";

/** @import { Limit, ZoneCounts, ZoneDetailFeature, ZoneFeature } from "../api_types.d.ts" */
/** @import { Facts, RecordFeature, RecordKind } from "../ground/types.d.ts" */
/** @import { Register } from "../register/types.d.ts" */

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

const filters = mountZoneFilters(() => records.load());

/** "now, until 24 Nov, 18:00", "from 24 Nov, 08:00". @param {ZoneFeature} zone */
function activityText({ properties: { schedule, is_active: isActive, changes_at: changes } }) {
  if (!schedule) return t("always");
  const time = changes && `${dayText(changes)}, ${clockText(changes)}`;
  if (isActive) return time ? t("now, until {time}", { time }) : t("now");
  return time ? t("from {time}", { time }) : t("not in the next 8 days");
}

/** @param {string} words as the source writes them */
const statedWords = (words) => (words ? plainWords(words) : t("not stated"));

/** @param {Limit | null} limit @param {"lower" | "upper"} side */
const heightCell = (limit, side) => (limit ? limitText(limit, side) : t("not stated"));

/** @type {Register<ZoneFeature>} */
const REGISTER = {
  key: "zones",
  words: t("No-fly zones"),
  order: "name",
  exports: "/zones/export",
  summary: "/zones/summary",
  canEdit: readPage().canCurate,
  name: ({ properties }) => properties.name,
  icon: () => "zone",
  columns: [
    { name: "name", words: t("Name"), sort: "name", cell: ({ properties }) => properties.name },
    { name: "kind", words: t("Kind"), cell: ({ properties }) => (properties.circle ? t("Circle") : t("Area")) },
    {
      name: "restriction",
      words: t("Restriction"),
      sort: "restriction",
      cell: ({ properties }) => statedWords(properties.restriction),
    },
    { name: "reason", words: t("Reason"), sort: "reason", cell: ({ properties }) => statedWords(properties.reason) },
    {
      name: "lower",
      words: t("Lower limit"),
      sort: "lower",
      cell: ({ properties }) => heightCell(properties.lower_limit, "lower"),
    },
    {
      name: "upper",
      words: t("Upper limit"),
      sort: "upper",
      cell: ({ properties }) => heightCell(properties.upper_limit, "upper"),
    },
    { name: "applies", words: t("Applies"), cell: activityText },
    {
      name: "set",
      words: t("Zone set"),
      sort: "set",
      cell: ({ properties }) => properties.zone_set ?? t("Drawn in Spanwise"),
    },
    { name: "identifier", words: t("Identifier"), isOptional: true, cell: ({ properties }) => properties.identifier },
    { name: "schedule", words: t("Schedule"), isOptional: true, cell: ({ properties }) => properties.schedule_words },
    {
      name: "changed",
      words: t("Changed"),
      sort: "changed",
      isOptional: true,
      cell: ({ properties }) => whenText(properties.updated_at),
    },
  ],
  /** @param {ZoneCounts} counts */
  counted: (counts) => filters.counted(counts),
  editWords: (count) => tn(count, "Edit {count} zone", "Edit {count} zones", { count: numberText(count) }),
  edit: (marked) =>
    editMarked(
      marked,
      zoneEdit(() => records.reload()),
    ),
};

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
  narrowed: () => filters.narrowed(),
  register: REGISTER,
  noneFound: t("Other words, or a larger part of the map may have it."),
  noneYet: {
    words: t("No zones yet."),
    begin: t("Draw one, or bring in an ED-269, ED-318, OpenAir or GeoJSON file."),
  },
};
await loadMapLibrary();
const records = mountRecordPage(ZONES);

const importButton = byId("zone-import");
importButton.hidden = !records.page.canCurate;
mountImportButton(importButton, byId("zone-import-file", HTMLInputElement));

const sets = mountSetsPanel({
  askFile: () => importButton.click(),
  canCurate: records.page.canCurate,
  showZones(set) {
    filters.chooseSet(set);
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
