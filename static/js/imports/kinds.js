/** Kind of data of a file, guessed from its name and its first bytes; a curator can change it. */

import { t } from "../text.js";

/** @import { ImportKind } from "./types.d.ts" */

/** @type {[RegExp, ImportKind][]} */
const BY_NAME = [
  [/\.(osm|pbf|osm\.(gz|bz2)|osm\.json)$/i, "osm"],
  [/\.(tiff?|hgt|hgt\.(gz|zip))$/i, "terrain"],
  [/^[ns]\d{2}[ew]\d{3}\S*\.zip$/i, "terrain"],
  [/\.(kml|kmz|gpkg|csv|tsv|shp|gml|fgb|dxf|gdb\.zip)$/i, "assets"],
  [/\.(txt|air|openair)$/i, "zones"],
];

const ZONE_WORDS =
  /"(UASZone|uasZoneList|uSpaceClass|zoneAuthority|restriction|lowerLimit|upperLimit|verticalReference)"/i;
const ASSET_WORDS = /"(power|voltage|voltages_v|railway|bridge|cables)"\s*:|"(LineString|MultiLineString|Point)"/;

const HEAD_BYTES = 4096;

/** First bytes of formats that no reader takes: inspection/importers/foreign_formats.py. @type {[string, string][]} */
const FOREIGN = [
  ["\x89PNG\r\n\x1a\n", "PNG"],
  ["\xff\xd8\xff", "JPEG"],
  ["GIF8", "GIF"],
  ["RIFF", "WebP, WAV, AVI"],
  ["%PDF-", "PDF"],
  ["MZ", "EXE"],
  ["\x7fELF", "ELF"],
  ["AC10", "DWG"],
  ["7z\xbc\xaf\x27\x1c", "7z"],
  ["Rar\x21\x1a", "RAR"],
];
const EMPTY_COLLECTION = /^\s*\{[^[\]]*"features"\s*:\s*\[\s*\]/;

/**
 * One sentence on why a file is not sent at all; null for one that may hold data.
 *
 * @param {string} name
 * @param {number} size
 * @param {Uint8Array} head the first bytes
 */
export function whyNotSent(name, size, head) {
  if (size === 0) return t("“{name}” is empty: it has no bytes.", { name });
  const text = String.fromCharCode(...head.subarray(0, HEAD_BYTES));
  const format = FOREIGN.find(([beginning]) => text.startsWith(beginning))?.[1];
  if (format)
    return t("“{name}” is a {format} file, which holds none of the data that Spanwise reads.", { name, format });
  if (EMPTY_COLLECTION.test(text)) return t("“{name}” is an empty collection: it has no features.", { name });
  return null;
}

/** @param {string} name @param {Uint8Array} [head] the first bytes @returns {ImportKind} */
export function guessKind(name, head = new Uint8Array()) {
  const text = new TextDecoder("latin1").decode(head.subarray(0, HEAD_BYTES));
  if (text.slice(0, 32).includes("OSMHeader") || /<osm\b/.test(text)) return "osm";
  if (text.startsWith("II*\0") || text.startsWith("MM\0*") || text.startsWith("II+\0") || text.startsWith("MM\0+"))
    return "terrain";
  if (text.startsWith("SQLite format 3") || /<kml\b/.test(text)) return "assets";
  const named = BY_NAME.find(([pattern]) => pattern.test(name));
  if (named) return named[1];
  if (/"elements"\s*:/.test(text) && /"(osm3s|version)"/.test(text)) return "osm";
  if (ZONE_WORDS.test(text)) return "zones";
  if (ASSET_WORDS.test(text)) return "assets";
  return /\.zip$/i.test(name) ? "assets" : "zones";
}

/** The default name of a set: the file's name without its extension. @param {string} fileName */
export function setNameOf(fileName) {
  return (
    fileName
      .replace(/\.(osm\.(pbf|gz|bz2)|[a-z0-9]{1,8})$/i, "")
      .replaceAll("_", " ")
      .trim() || fileName
  );
}

/** The begin of a file, by which its kind is known. @param {File} file */
export const headOf = async (file) => new Uint8Array(await file.slice(0, HEAD_BYTES).arrayBuffer());
