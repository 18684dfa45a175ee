/** Tiles are the same for everybody and name nameless things in English: here they get the reader's language. The API does it itself. */

import { language, t } from "../text.js";

/** @import { ThingProperties } from "./types.d.ts" */

/** @type {Record<string, string>} */
const KINDS = {
  Tower: t("Tower"),
  Line: t("Line"),
  Railway: t("Railway"),
  Bridge: t("Bridge"),
  Cable: t("Cable"),
  Pole: t("Pole"),
  Portal: t("Portal"),
  Tramway: t("Tramway"),
  Subway: t("Subway"),
};
/** @type {Record<string, string>} */
const DETAILS = {
  "voltage not stated": t("voltage not stated"),
  "carries a road and a railway": t("carries a road and a railway"),
  "carries a railway": t("carries a railway"),
  "carries a road": t("carries a road"),
  "carries a path": t("carries a path"),
  "carries water": t("carries water"),
  "carries a pipeline": t("carries a pipeline"),
};
const MADE_NAME = new RegExp(`^(${Object.keys(KINDS).join("|")}) (?:(\\d+) of (\\d+)|([nwr]?\\d+))$`);

/**
 * "Tower 18 of 41" → "Mast 18 von 41"; a name that somebody gave stays.
 *
 * @param {Pick<ThingProperties, "label" | "ref" | "name" | "operator">} properties
 */
export function nameOf({ label, ref, name, operator }) {
  if (!label || label === ref || label === name) return label;
  if (operator && label === `${operator} railway`) return t("{operator} railway", { operator });
  const made = MADE_NAME.exec(label);
  if (!made) return label;
  const [, kind, place, places, id] = made;
  return place ? t("{kind} {place} of {places}", { kind: KINDS[kind], place, places }) : `${KINDS[kind]} ${id}`;
}

/** @param {string} detail */
function detailOf(detail) {
  const [, start, last] = /^(.*, )?(.*)$/.exec(detail) ?? ["", "", detail];
  return `${start ?? ""}${DETAILS[last] ?? last}`;
}

/**
 * The properties of a thing of a tile, with label and detail for people.
 *
 * @param {ThingProperties} properties
 * @returns {ThingProperties}
 */
export function inWords(properties) {
  if (language === "en" || !properties.kind) return properties;
  return {
    ...properties,
    label: nameOf(properties),
    ...(properties.detail ? { detail: detailOf(properties.detail) } : {}),
  };
}
