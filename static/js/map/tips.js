/** Tooltip of the map for an asset or a zone. A zone's times and source are requested when it is shown. */

import { h, icon } from "../dom.js";
import { scheduleText } from "../domain/schedule_words.js";
import { bandDrawing, heightsText } from "../domain/zone_heights.js";
import { isInForce } from "../domain/zones_in_force.js";
import { t } from "../text.js";
import { lengthText, whenText } from "../units.js";
import { zoneDetails, zoneDetailsKept } from "./zone_details.js";

/** @import { Limit, ZoneDetailProperties } from "../api_types.d.ts" */
/** @import { MapThing, Position, ThingProperties } from "./types.d.ts" */

/** @returns {Record<string, string>} */
const KIND_WORDS = () => ({
  tower: t("Power tower"),
  line: t("Power line"),
  railway: t("Railway"),
  bridge: t("Bridge"),
  pole: t("Pole"),
  portal: t("Portal"),
  minor_line: t("Minor power line"),
  cable: t("Cable"),
  tram: t("Tramway"),
  subway: t("Subway"),
});

/** What the codes of ED-269 and ED-318 mean. @returns {Record<string, string>} */
const CODES = () => ({
  USPACE: t("U-space"),
  PROHIBITED: t("prohibited"),
  REQ_AUTHORISATION: t("authorisation required"),
  REQ_AUTHORIZATION: t("authorisation required"),
  CONDITIONAL: t("conditional"),
  NO_RESTRICTION: t("no restriction"),
  AIR_TRAFFIC: t("air traffic"),
  SENSITIVE: t("sensitive site"),
  PRIVACY: t("privacy"),
  POPULATION: t("population"),
  NATURE: t("nature"),
  NOISE: t("noise"),
  FOREIGN_TERRITORY: t("foreign territory"),
  EMERGENCY: t("emergency"),
  DAR: t("dynamic airspace reconfiguration"),
  OTHER: t("other"),
});

/**
 * The words of a zone file's code: "AIR_TRAFFIC, NATURE" becomes "Air traffic, nature". Other texts stay as they are.
 *
 * @param {string} text
 */
export function plainWords(text) {
  if (!/^[A-Z][A-Z_]+(, ?[A-Z][A-Z_]+)*$/.test(text)) return text;
  const words = text
    .split(/, ?/)
    .map((code) => CODES()[code] ?? code.toLowerCase().replaceAll("_", " "))
    .join(", ");
  return words[0].toUpperCase() + words.slice(1);
}

/** @typedef {MapThing & { place?: Position | null }} PlacedThing with the place that was pointed at */
/** @typedef {(content: (Node | string)[]) => void} Refresh */

/** @param {string | false | null | undefined} words */
const quiet = (words) => words && h("div", { class: "quiet-text" }, words);

/**
 * `refresh(content)` is called with more, once it is known.
 *
 * @param {PlacedThing} thing
 * @param {Refresh} refresh
 * @returns {Node[]}
 */
export function tipOf(thing, refresh) {
  if (thing.kind === "zone") return zoneTip(thing, refresh);
  const { properties } = thing;
  const length = properties.length_m ? lengthText(properties.length_m) : "";
  const isStated =
    !properties.voltages || `${properties.label} ${properties.detail ?? ""}`.includes(properties.voltages);
  return [
    h("strong", {}, properties.label),
    h(
      "div",
      {},
      [KIND_WORDS()[properties.subtype ?? ""] ?? KIND_WORDS()[thing.kind], length].filter(Boolean).join(", "),
    ),
    quiet(properties.detail),
    quiet(isStated ? "" : properties.voltages),
    properties.flyable === false && quiet(t("Not used for routing")),
  ].filter((part) => part instanceof Node);
}

/** @param {PlacedThing} thing @param {Refresh} refresh */
function zoneTip(thing, refresh) {
  const kept = zoneDetailsKept(thing.id);
  zoneDetails(thing.id).then(
    (details) => kept !== details && refresh(zoneContent(thing, details)),
    () => refresh(zoneContent(thing, null, t("Times and source cannot be read now."))),
  );
  return zoneContent(thing, kept);
}

/** @param {number | null | undefined} value_m @param {string | undefined} reference @returns {Limit | null} */
const limitOf = (value_m, reference) =>
  value_m === undefined || value_m === null
    ? null
    : { value_m, reference: /** @type {Limit["reference"]} */ (reference ?? "") };

/**
 * Whether the zone applies now, as text; by the schedule in the tile.
 *
 * @param {ThingProperties} properties
 * @param {Position} place
 */
function nowWords({ schedule }, place) {
  if (!schedule) return "";
  const holds = isInForce(JSON.parse(schedule), Date.now(), place);
  if (holds === null) return t("Whether it is in force now is not known");
  return holds ? t("In force now") : t("Not in force now");
}

/** @param {PlacedThing} thing @param {ZoneDetailProperties | null} details @param {string} [problem] */
function zoneContent({ properties, place }, details, problem = "") {
  const limits = {
    lower_limit: limitOf(properties.lower_limit_m, properties.lower_reference),
    upper_limit: limitOf(properties.upper_limit_m, properties.upper_reference),
  };
  const why = [properties.restriction, properties.reason].flatMap((text) => (text ? plainWords(text) : [])).join(" · ");
  return [
    h("strong", {}, properties.name),
    h("span", { class: "zone-chip" }, icon("circle-alert", "small"), t("No-fly zone")),
    h(
      "div",
      { class: "tip-band" },
      bandDrawing(limits),
      h(
        "div",
        {},
        h("div", {}, heightsText(limits)),
        h(
          "div",
          {},
          details
            ? scheduleText(details.schedule, { otherwise: details.schedule_words })
            : properties.schedule
              ? t("At times")
              : "",
        ),
        quiet(place ? nowWords(properties, place) : ""),
      ),
    ),
    why && h("div", {}, why),
    quiet(problem || (details ? sourceWords(details) : t("Reading times and source…"))),
    quiet(properties.schedule ? t("A plan with a departure counts it at its times, any other plan at all times.") : ""),
  ].filter((part) => part instanceof Node);
}

/** The source of the zone, and the age of its data. @param {ZoneDetailProperties} details */
function sourceWords({ zone_set, source, is_edited, updated_at }) {
  if (!source) return t("Drawn in Spanwise, changed {when}", { when: whenText(updated_at) });
  const name = zone_set ?? source.file_name;
  const words = source.fetched_at
    ? t("From {name}, fetched {when}", { name, when: whenText(source.fetched_at) })
    : t("From {name}, read in {when}", { name, when: whenText(source.imported_at) });
  return is_edited ? `${words} · ${t("edited by hand")}` : words;
}
