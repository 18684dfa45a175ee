/** The history of an asset or a zone: who, when, from what to what, and the way back. */

import { h, icon } from "../dom.js";
import { t } from "../text.js";
import { clockText, whenText } from "../units.js";

const ACTS = {
  created: "Drawn", changed: "Changed", deleted: "Taken off the ground", vanished: "No longer in its source", reverted: "Brought back to an earlier state",
  restored: "Restored", "followed source": t("Follows its source again"), imported: "Imported",
};
const NAMES = {
  ref: t("Ref"), name: "Name", operator: t("Operator"), voltages_v: t("Voltages"), circuits: t("Circuits"), height_m: t("Height"), is_flyable: t("Part of the network"), subtype: "Type",
  geometry: t("Shape"), tags: t("Tags"), vanished: "Off the ground", restriction: t("Restriction"), reason: t("Reason"), schedule: t("Schedule"), circle: t("Circle"),
  lower_limit_m: t("Lower limit"), lower_reference: t("Lower limit counted"), upper_limit_m: t("Upper limit"), upper_reference: t("Upper limit counted"), kind: "Kind", identifier: t("Identifier"),
};
const QUIET = new Set(["is_edited", "layer", "osm_type", "osm_id", "source_key", "max_voltage_v"]);

export const factName = (name) => NAMES[name] ?? name;

/** A fact as people say it. */
export function factText(name, value) {
  if (value === null || value === undefined || value === "" || (Array.isArray(value) && !value.length)) return t("not stated");
  if (name === "voltages_v") return value.map((volts) => `${volts / 1000}\u00a0kV`).join(", ");
  if (name === "geometry") return `${countPoints(value.coordinates)} points`;
  if (name.endsWith("_m")) return `${Math.round(value * 10) / 10}\u00a0m`;
  if (name === "circle") return `${Math.round(value.radius_m)}\u00a0m round ${value.centre.map((degrees) => degrees.toFixed(4)).reverse().join(", ")}`;
  if (typeof value === "boolean") return value ? "yes" : "no";
  if (typeof value === "object") return Array.isArray(value) ? `${value.length} periods` : `${Object.keys(value).length} tags`;
  return String(value);
}

const countPoints = (coordinates) => (typeof coordinates[0] === "number" ? 1 : coordinates.reduce((sum, part) => sum + countPoints(part), 0));

/** Lines "Ref: 18 → 18a" of what differs. */
export function differences(before, after) {
  if (!before || !after) return [];
  return Object.keys(before)
    .filter((name) => !QUIET.has(name) && JSON.stringify(before[name]) !== JSON.stringify(after[name]))
    .map((name) => [factName(name), name === "geometry" ? "moved" : `${factText(name, before[name])} → ${factText(name, after[name])}`]);
}

/** The day and the time of day, in the reader's own zone. */
function momentText(iso) {
  const words = whenText(iso);
  return words === "now" || words.includes(",") ? words : `${words}, ${clockText(iso)}`;
}

/** entries as the API gives them; `revert(entry)` where somebody may, `ring(geometries)` shows on the map where it was. */
export function historyList(entries, { revert = null, ring = () => {} } = {}) {
  return h(
    "ol",
    { class: "history-list" },
    entries.map((entry) =>
      h(
        "li",
        entry.before?.geometry ? { onpointerenter: () => ring([entry.before.geometry]), onpointerleave: () => ring() } : {},
        h("div", { class: "history-head" }, h("strong", {}, ACTS[entry.action] ?? entry.action), h("span", { class: "caption", title: new Date(entry.recorded_at).toString() }, [entry.actor ?? (entry.file_name ? `from ${entry.file_name}` : t("by a command")), momentText(entry.recorded_at)].join(" · "))),
        h("dl", {}, differences(entry.before, entry.after).map(([name, words]) => h("div", {}, h("dt", {}, name), h("dd", {}, words)))),
        revert && entry.id && entry.before && h("button", { type: "button", class: "text-button", onclick: () => revert(entry) }, icon("undo-2", "small"), t("Bring back what was before")),
      ),
    ),
  );
}
