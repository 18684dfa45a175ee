/** What a GeoJSON or KML file names, or a table with columns of coordinates: references, positions, or both. Values in, values out. */

/** @typedef {{ ref: string, position: number[] | null, external_id: string }} Entry */
/** @typedef {{ entries: Entry[], left: number }} Read `left`: what has neither a name nor a position */

const NAMES = ["ref", "name", "label", "id"];
const LATITUDES = ["lat", "latitude", "y"];
const LONGITUDES = ["lon", "lng", "long", "longitude", "x"];
const DIGITS = 6;

/** @param {unknown} longitude @param {unknown} latitude */
function positionOf(longitude, latitude) {
  const [x, y] = [longitude, latitude].map(Number);
  const isThere = [longitude, latitude].every((value) => value !== null && value !== "" && value !== undefined);
  return isThere && Math.abs(x) <= 180 && Math.abs(y) <= 90
    ? [x, y].map((degrees) => Number(degrees.toFixed(DIGITS)))
    : null;
}

/** @param {Entry[]} found @returns {Read} */
function read(found) {
  const entries = found.filter(({ ref, position }) => ref || position);
  return { entries, left: found.length - entries.length };
}

/** The value of the first of these columns, whatever their case. @param {Record<string, unknown>} values @param {string[]} names */
function firstOf(values, names) {
  const known = new Map(Object.entries(values).map(([name, value]) => [name.trim().toLowerCase(), value]));
  const found = names
    .map((name) => known.get(name))
    .find((value) => typeof value === "string" || Number.isFinite(value));
  return found === undefined ? "" : String(found).trim();
}

/**
 * @param {string} text
 * @returns {Read | null} null where it is no GeoJSON
 */
export function readGeoJson(text) {
  /** @type {any} */
  let content;
  try {
    content = JSON.parse(text);
  } catch {
    return null;
  }
  const features = content?.features ?? (content?.type === "Feature" ? [content] : null);
  if (!Array.isArray(features)) return null;
  return read(
    features.map(({ id, properties, geometry }) => ({
      ref: firstOf({ id, ...properties }, NAMES),
      position: geometry?.type === "Point" ? positionOf(geometry.coordinates?.[0], geometry.coordinates?.[1]) : null,
      external_id: firstOf(properties ?? {}, ["external_id"]),
    })),
  );
}

/** @param {Document} content @returns {Read} */
export function readKml(content) {
  /** @param {Element} place @param {string} name */
  const textIn = (place, name) => place.getElementsByTagNameNS("*", name)[0]?.textContent?.trim() ?? "";
  return read(
    [...content.getElementsByTagNameNS("*", "Placemark")].map((place) => {
      const point = place.getElementsByTagNameNS("*", "Point")[0];
      const [longitude, latitude] = point ? textIn(point, "coordinates").split(",") : [];
      return { ref: textIn(place, "name"), position: positionOf(longitude, latitude), external_id: "" };
    }),
  );
}

/**
 * @param {string[]} head names of the columns
 * @param {string[][]} rows
 * @param {boolean} hasDecimalCommas
 * @returns {Read | null} null where no column has coordinates
 */
export function readTable(head, rows, hasDecimalCommas) {
  const names = head.map((name) => name.trim().toLowerCase());
  const [latitude, longitude] = [LATITUDES, LONGITUDES].map((known) => names.findIndex((name) => known.includes(name)));
  if (latitude < 0 || longitude < 0) return null;
  const ref = NAMES.map((name) => names.indexOf(name)).find((column) => column >= 0) ?? -1;
  const ids = names.indexOf("external_id");
  /** @param {string | undefined} cell */
  const number = (cell) => (hasDecimalCommas ? cell?.replace(",", ".") : cell);
  return read(
    rows
      .filter((cells) => cells.some((cell) => cell))
      .map((cells) => ({
        ref: cells[ref] ?? "",
        position: positionOf(number(cells[longitude]), number(cells[latitude])),
        external_id: cells[ids] ?? "",
      })),
  );
}
