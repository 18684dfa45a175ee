/** Kind of data of a file, guessed from its name and its first bytes; a curator can change it. */

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

export const HEAD_BYTES = 4096;

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
