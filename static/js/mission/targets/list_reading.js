/** A pasted list, or the text of a file: its parsing, and the server's matches for each reference. */

import { post } from "../../api.js";
import { placeTarget } from "../selection.js";
import { readGeoJson, readKml, readTable } from "./file_reading.js";

/** @import { Answer } from "../../api.js" */
/** @import { LookupOutput, LookupResult } from "../../api_types.d.ts" */
/** @import { Entry, Read } from "./file_reading.js" */

/** @typedef {{ refs: string[], externalIds: Map<string, string>, places: Entry[], left: number, format: string }} List `places` have a position;
 *   `format` of a file */

const PER_REQUEST = 2000;
export const MAX_REFS = 10_000;

/**
 * Each reference once, in the order of the list: one a line, or parted by tabs, commas or semicolons; quotes are
 * dropped.
 *
 * @param {string} text
 */
export function refsIn(text) {
  const refs = text.split(/[\n\r\t,;]+/).map((ref) =>
    ref
      .trim()
      .replace(/^(["'])(.*)\1$/, "$2")
      .trim(),
  );
  return [...new Set(refs.filter(Boolean))];
}

/**
 * The references of a list, by reference the external id for its target, and the places of a GeoJSON or KML file. A list whose first line
 * names a column `external_id`, or columns of coordinates, is a table: references are in its column `ref`, or in the first of the others.
 *
 * @param {string} text
 * @returns {List}
 */
export function listIn(text) {
  const content = text.replace(/^\uFEFF/, "").trim();
  if (content.startsWith("{")) return listOf(readGeoJson(content), "GeoJSON");
  if (content.startsWith("<")) return listOf(kmlIn(content), "KML");
  const [head, ...lines] = content.split(/[\n\r]+/);
  const sign = ["\t", ";", ","].find((known) => head.includes(known)) ?? ",";
  const names = cellsOf(head, sign).map((name) => name.toLowerCase());
  const cells = lines.map((line) => cellsOf(line, sign));
  const table = readTable(names, cells, sign !== ",");
  return table ? listOf(table) : listOfReferences(text, names, cells);
}

/** @param {string} text */
function kmlIn(text) {
  const content = new DOMParser().parseFromString(text, "application/xml");
  return content.querySelector("parsererror") ? null : readKml(content);
}

/** @param {Read | null} found null: it is not of this format @param {string} [format] @returns {List} */
function listOf(found, format = "") {
  const { entries, left } = found ?? { entries: [], left: 0 };
  const named = entries.filter(({ ref }) => ref);
  return {
    refs: [...new Set(named.map(({ ref }) => ref))],
    externalIds: new Map(named.flatMap(({ ref, external_id }) => (external_id ? [[ref, external_id]] : []))),
    places: entries.filter(({ position }) => position),
    left,
    format,
  };
}

/**
 * @param {string} text
 * @param {string[]} names of the columns
 * @param {string[][]} lines
 * @returns {List}
 */
function listOfReferences(text, names, lines) {
  const none = { places: [], left: 0, format: "" };
  const ids = names.indexOf("external_id");
  if (ids < 0 || names.length < 2) return { refs: refsIn(text), externalIds: new Map(), ...none };
  const named = names.indexOf("ref");
  const refs = named < 0 ? Number(ids === 0) : named;
  const rows = lines.filter((cells) => cells[refs]);
  return {
    refs: [...new Set(rows.map((cells) => cells[refs]))],
    externalIds: new Map(rows.filter((cells) => cells[ids]).map((cells) => [cells[refs], cells[ids]])),
    ...none,
  };
}

/** Cells of a line of a table; a sign between quotes does not separate. @param {string} line @param {string} sign */
function cellsOf(line, sign) {
  const cells = line.match(new RegExp(`(?:"(?:[^"]|"")*"|[^${sign}])+|(?<=^|${sign})(?=${sign}|$)`, "g")) ?? [];
  return cells.map((cell) =>
    cell
      .trim()
      .replace(/^"(.*)"$/s, "$1")
      .replaceAll('""', '"')
      .trim(),
  );
}

/**
 * The server's matches of each: [{ ref, match, count, assets }].
 *
 * @param {string[]} refs
 * @param {string[]} kinds
 * @param {AbortSignal} [signal]
 */
export async function lookUp(refs, kinds, signal) {
  /** @type {LookupResult[]} */
  const results = [];
  for (let first = 0; first < refs.length; first += PER_REQUEST) {
    const { data } = /** @type {Answer<LookupOutput>} */ (
      await post("/assets/lookup", { refs: refs.slice(first, first + PER_REQUEST), kinds }, { signal })
    );
    results.push(...data.results);
  }
  return results;
}

/**
 * The rows to add: every reference with one match, and the choice for the others: ref → "all", an id, or nothing.
 * Each with the external id that the list has for its reference.
 *
 * @param {LookupResult[]} results
 * @param {Map<string, string>} choices
 * @param {Map<string, string>} [externalIds]
 */
export function rowsToAdd(results, choices, externalIds = new Map()) {
  return results.flatMap(({ ref, match, assets }) => {
    const choice = match === "found" ? "all" : (choices.get(ref) ?? "");
    const external_id = externalIds.get(ref) ?? "";
    return assets
      .filter((asset) => choice === "all" || String(asset.id) === choice)
      .map((asset) => ({ ...asset, external_id }));
  });
}

/**
 * The places that no reference stands for: without one, or with one that is not in the data.
 *
 * @param {Entry[]} places
 * @param {LookupResult[]} results
 */
export function placesToAdd(places, results) {
  const unknown = new Set(results.filter(({ match }) => match === "none").map(({ ref }) => ref));
  return places.filter(({ ref }) => !ref || unknown.has(ref));
}

/** A place as a target; what names it is its external id. @param {Entry} entry */
export function targetOfPlace({ ref, position, external_id }) {
  const id = external_id || ref;
  return { ...placeTarget(/** @type {number[]} */ (position)), ...(id ? { external_id: id } : {}) };
}
