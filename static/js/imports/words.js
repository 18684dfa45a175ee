/** Texts of the page "Imports": kinds, states, differences and facts. */

import { locale, t, tn } from "../text.js";
import { heightText } from "../units.js";

/** @import { Geometry } from "../map/types.d.ts" */
/** @import { Action, Change, ImportKind, Proposal, Summary } from "./types.d.ts" */

const SPACE = "\u00a0";

/** @type {Record<ImportKind, { words: string, icon: string }>} */
export const KINDS = {
  osm: { words: "OpenStreetMap", icon: "line" },
  zones: { words: t("No-fly zones"), icon: "zone" },
  assets: { words: t("Asset file"), icon: "tower" },
  terrain: { words: t("Terrain"), icon: "mountain" },
};

/** @type {Record<Proposal["state"], { words: string, icon: string, chip: string }>} */
export const STATES = {
  reading: { words: t("Reading"), icon: "loader-circle", chip: "active" },
  refused: { words: t("Refused"), icon: "octagon-alert", chip: "failed" },
  ready: { words: t("Ready for review"), icon: "eye", chip: "approved" },
  applying: { words: t("Applying"), icon: "loader-circle", chip: "active" },
  applied: { words: t("Applied"), icon: "circle-check", chip: "" },
  discarded: { words: t("Discarded"), icon: "circle-x", chip: "draft" },
};

/**
 * In the order of display; the sign is shown in the list and on the map.
 * @type {Record<Action, { words: string, short: string, sign: string }>}
 */
export const ACTIONS = {
  new: { words: t("new"), short: t("New"), sign: "+" },
  changed: { words: t("changed"), short: t("Changed"), sign: "≠" },
  vanished: { words: t("removed from source"), short: t("Removed from source"), sign: "−" },
  kept: { words: t("kept as edited by hand"), short: t("Kept"), sign: "=" },
  not_read: { words: t("not read"), short: t("Not read"), sign: "?" },
};

/** @type {Record<Proposal["origin"], string>} */
export const ORIGINS = {
  upload: "",
  overpass: t("from Overpass"),
  subscription: t("from a subscription"),
  roll_back: t("roll-back"),
};

/** Vertical datums, for files that do not state one. */
export const VERTICAL_DATUMS = ["EGM96", "EGM2008", "EGM84", "EVRF2007", "DHHN2016", "NAVD88"];

/** @param {Pick<Proposal, "state">} proposal */
export const isOpen = (proposal) => proposal.state === "reading" || proposal.state === "applying";

/** @param {number} value */
const number = (value) => value.toLocaleString(locale);

/** "412 new, 3 changed, 1 vanished, 2 kept as edited by hand." @param {Record<string, number>} difference */
export function differenceSentence(difference) {
  const parts = Object.entries(ACTIONS)
    .filter(([action]) => difference[action] > 0)
    .map(([action, { words }]) => `${number(difference[action])}${SPACE}${words}`);
  return parts.length ? `${parts.join(", ")}.` : t("Nothing would change.");
}

/**
 * "Heights from 431 m to 2,599 m above EGM96, in place of the earlier model of this name."
 *
 * @param {Summary} summary
 * @param {Record<string, number>} difference
 */
export function terrainSentence({ lowest_m, highest_m, vertical_datum }, difference) {
  const values = { low: heightText(lowest_m ?? 0), high: heightText(highest_m ?? 0), datum: vertical_datum };
  if (difference.changed > 0)
    return t("Heights from {low} to {high} above {datum}, in place of the earlier model of this name.", values);
  return t("Heights from {low} to {high} above {datum}.", values);
}

/**
 * How many stored rows an application changes.
 *
 * @param {Record<string, number>} difference
 * @param {{ overwrites?: boolean }} [how]
 */
export function touched(difference, { overwrites = false } = {}) {
  const counted = Object.keys(difference).filter((action) => isTouched(action, overwrites));
  return counted.reduce((sum, action) => sum + (difference[action] ?? 0), 0);
}

/** Whether changes of this action are written. @param {string} action @param {boolean} overwrites */
export const isTouched = (action, overwrites) =>
  ["new", "changed", "vanished", ...(overwrites ? ["kept"] : [])].includes(action);

/** @param {number | null | undefined} bytes */
export function sizeText(bytes) {
  if (bytes === null || bytes === undefined) return "";
  if (bytes < 1024 * 1024) return `${number(Math.max(1, Math.round(bytes / 1024)))}${SPACE}kB`;
  return `${(bytes / 1024 / 1024).toLocaleString(locale, { maximumFractionDigits: 1 })}${SPACE}MiB`;
}

/** @type {Record<string, string>} */
const UNITS = {
  m: "m",
  km: "km",
  v: "V",
  kv: "kV",
  hz: "Hz",
  deg: "°",
  km2: "km²",
  m2: "m²",
  bytes: t("bytes"),
  s: "s",
};

/** "height_m" → { words: "height", unit: "m" } @param {string} name */
export function factName(name) {
  if (name === "geometry") return { words: t("geometry"), unit: "" };
  const parts = name.split("_");
  const unit = parts.length > 1 ? (UNITS[parts[parts.length - 1]] ?? "") : "";
  if (unit) parts.pop();
  if (parts[0] === "is" && parts.length > 1) parts.shift();
  return { words: parts.join(" "), unit };
}

/** A value as text; geometries are on the map. @param {string} name @param {unknown} value @returns {string} */
export function factText(name, value) {
  if (value === null || value === undefined || value === "") return t("nothing");
  if (value === true) return t("yes");
  if (value === false) return t("no");
  if (typeof value === "number") return number(value).replace("-", "−");
  if (typeof value === "string") return value.length > 120 ? `${value.slice(0, 119)}…` : value;
  if (isGeometry(value)) return t("changed");
  if (Array.isArray(value))
    return value.length && value.every((entry) => typeof entry !== "object")
      ? value.join(", ")
      : tn(value.length, "{count} entry", "{count} entries");
  if (typeof value !== "object") return String(value);
  if ("value_m" in value)
    return `${number(/** @type {number} */ (value.value_m))}${SPACE}m ${"reference" in value ? (value.reference ?? "") : ""}`.trim();
  const entries = Object.entries(value);
  return entries.length
    ? factText(name, entries.map(([key, inner]) => `${key}: ${factText(key, inner)}`).join(", "))
    : t("nothing");
}

/** @param {unknown} value @returns {value is Geometry} */
export const isGeometry = (value) =>
  typeof value === "object" &&
  value !== null &&
  "type" in value &&
  typeof value.type === "string" &&
  ("coordinates" in value || "geometries" in value);

/**
 * The facts of a change, one line each: { words, before, after }; null where that side does not exist.
 *
 * @param {Pick<Change["properties"], "before" | "after">} change
 * @returns {{ words: string, before: string | null, after: string | null }[]}
 */
export function factLines({ before, after }) {
  const names = [...new Set([...Object.keys(before ?? {}), ...Object.keys(after ?? {})])];
  /** @param {string} name */
  const isStated = (name) => !isEmpty(before?.[name]) || !isEmpty(after?.[name]);
  return names.filter(isStated).map((name) => {
    const { words, unit } = factName(name);
    /** @param {Record<string, unknown> | null} facts */
    const side = (facts) => {
      if (!facts) return null;
      const text = factText(name, facts[name]);
      return unit && typeof facts[name] === "number" ? `${text}${SPACE}${unit}` : text;
    };
    if (isGeometry(before?.[name]) && isGeometry(after?.[name]))
      return { words, before: t("dashed on the map"), after: t("drawn on the map") };
    return { words, before: side(before), after: side(after) };
  });
}

/** @param {unknown} value */
const isEmpty = (value) =>
  value === null ||
  value === undefined ||
  value === "" ||
  (typeof value === "object" && Object.keys(value).length === 0);

const NOT_STATED = new Set(["words", "needs_mapping", "datum_is_stated", "external_ids", "can_leave_out"]); // shown elsewhere

/** Figures of a file for display: only numbers and short texts. @param {Summary} summary */
export function summaryLines(summary) {
  return Object.entries(summary)
    .filter(
      ([name, value]) =>
        !NOT_STATED.has(name) &&
        (typeof value === "number" || typeof value === "string" || typeof value === "boolean") &&
        value !== "",
    )
    .map(([name, value]) => {
      const { words, unit } = factName(name);
      return { words, value: `${factText(name, value)}${unit ? `${SPACE}${unit}` : ""}` };
    });
}

/** Notes of a file reader for display. @param {Summary} summary @returns {string[]} */
export const notesOf = (summary) =>
  Array.isArray(summary.notes) ? summary.notes.filter((note) => typeof note === "string") : [];
