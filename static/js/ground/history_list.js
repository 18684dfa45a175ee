/** The history of an asset or a zone: who, when, from what to what, and the way back. */

import { h, icon } from "../dom.js";
import { t, tn } from "../text.js";
import { clockText, coordinateText, exactHeightText, exactText, lengthText, voltageText, whenText } from "../units.js";

/** @import { GroundHistoryEntry } from "../api_types.d.ts" */
/** @import { Geometry } from "../map/types.d.ts" */
/** @import { Facts } from "./types.d.ts" */

/** @type {Record<string, string>} */
const ACTS = {
  created: t("Drawn"),
  changed: t("Changed"),
  deleted: t("Deleted"),
  vanished: t("No longer in its source"),
  reverted: t("Brought back to an earlier state"),
  restored: t("Restored"),
  "followed source": t("Follows its source again"),
  imported: t("Imported"),
};
/** @type {Record<string, string>} */
const NAMES = {
  ref: t("Ref"),
  name: t("Name"),
  operator: t("Operator"),
  voltages_v: t("Voltages"),
  circuits: t("Circuits"),
  height_m: t("Height"),
  is_flyable: t("Part of the network"),
  subtype: t("Type"),
  geometry: t("Shape"),
  tags: t("Tags"),
  vanished: t("Deleted"),
  restriction: t("Restriction"),
  reason: t("Reason"),
  schedule: t("Schedule"),
  circle: t("Circle"),
  lower_limit_m: t("Lower limit"),
  lower_reference: t("Lower limit counted"),
  upper_limit_m: t("Upper limit"),
  upper_reference: t("Upper limit counted"),
  kind: t("Kind"),
  identifier: t("Identifier"),
};
const QUIET = new Set(["is_edited", "layer", "osm_type", "osm_id", "source_key", "max_voltage_v"]);

/** @param {string} name */
export const factName = (name) => NAMES[name] ?? name;

/** A fact as text. @param {string} name @param {any} value as the history keeps it @returns {string} */
export function factText(name, value) {
  if (value === null || value === undefined || value === "" || (Array.isArray(value) && !value.length))
    return t("not stated");
  if (name === "voltages_v") return value.map((/** @type {number} */ volts) => voltageText(volts / 1000)).join(", ");
  if (name === "geometry") return tn(countPoints(value.coordinates), "{count} point", "{count} points");
  if (name.endsWith("_m")) return exactHeightText(value);
  if (name === "circle")
    return t("{radius} round {place}", { radius: lengthText(value.radius_m), place: coordinateText(value.centre) });
  if (typeof value === "boolean") return value ? t("yes") : t("no");
  if (typeof value === "object")
    return Array.isArray(value)
      ? tn(value.length, "{count} period", "{count} periods")
      : tn(Object.keys(value).length, "{count} tag", "{count} tags");
  return String(value);
}

/** @param {unknown[]} coordinates @returns {number} */
const countPoints = (coordinates) =>
  typeof coordinates[0] === "number"
    ? 1
    : /** @type {unknown[][]} */ (coordinates).reduce((sum, part) => sum + countPoints(part), 0);

/** Lines "Ref: 18 → 18a" of the differences. @param {Facts | null} before @param {Facts | null} after */
export function differences(before, after) {
  if (!before || !after) return [];
  return Object.keys(before)
    .filter((name) => !QUIET.has(name) && JSON.stringify(before[name]) !== JSON.stringify(after[name]))
    .map((name) => [
      factName(name),
      name === "geometry" ? t("moved") : `${factText(name, before[name])} → ${factText(name, after[name])}`,
    ]);
}

/** The day and the time of day, in the reader's own zone. @param {string} iso */
function momentText(iso) {
  const words = whenText(iso);
  return words === t("now") || words.includes(",") ? words : `${words}, ${clockText(iso)}`;
}

/**
 * entries as the API gives them; `revert(entry)` where the user may, `ring(geometries)` shows on the map where it was.
 *
 * @param {GroundHistoryEntry[]} entries
 * @param {{ revert?: ((entry: GroundHistoryEntry) => void) | null, ring?: (geometries?: Geometry[]) => void }} [options]
 */
export function historyList(entries, { revert = null, ring = () => {} } = {}) {
  return h(
    "ol",
    { class: "history-list" },
    entries.map((entry) =>
      h(
        "li",
        ringing(entry, ring),
        h(
          "div",
          { class: "history-head" },
          h("strong", {}, ACTS[entry.action] ?? entry.action),
          h(
            "span",
            { class: "caption", title: exactText(entry.recorded_at) },
            [
              entry.actor ?? (entry.file_name ? t("from {name}", { name: entry.file_name }) : t("by a command")),
              momentText(entry.recorded_at),
            ].join(" · "),
          ),
        ),
        h(
          "dl",
          {},
          differences(entry.before, entry.after).map(([name, words]) =>
            h("div", {}, h("dt", {}, name), h("dd", {}, words)),
          ),
        ),
        revert &&
          entry.id &&
          entry.before &&
          h(
            "button",
            { type: "button", class: "text-button", onclick: () => revert(entry) },
            icon("undo-2", "small"),
            t("Bring back what was before"),
          ),
      ),
    ),
  );
}

/** Rings where it was, while the pointer is at an entry. @param {GroundHistoryEntry} entry @param {(geometries?: Geometry[]) => void} ring */
function ringing({ before }, ring) {
  const geometry = /** @type {Geometry | undefined} */ (before?.geometry);
  return geometry ? { onpointerenter: () => ring([geometry]), onpointerleave: () => ring() } : {};
}
