/** Parser of coordinates: decimal degrees, degrees and minutes, degrees, minutes and seconds. Values in, values out. */

/** @typedef {{ letter: string, degrees: number }} Angle */

/** @type {Record<string, number>} */
const SIGN = { N: 1, S: -1, E: 1, O: 1, W: -1 }; // O: Ost
/** @param {string} letter */
const isNorthSouth = (letter) => letter === "N" || letter === "S";

/** One angle: degrees, minutes, seconds, with a letter before or behind. */
const FIGURES = String.raw`([+-]?\d{1,3}(?:\.\d+)?)(?:\s*°)?(?:\s*(\d{1,2}(?:\.\d+)?)\s*')?(?:\s*(\d{1,2}(?:\.\d+)?)\s*")?`;
const ANGLES = [
  new RegExp(String.raw`([NSEWO])\s*${FIGURES}`, "y"),
  new RegExp(String.raw`()${FIGURES}(?:\s*([NSEWO]))?`, "y"),
];

/**
 * Replace the signs of all keyboards by plain ones; a decimal comma becomes a point, where another sign separates the two figures.
 *
 * @param {string} text
 */
function plain(text) {
  const signs = text
    .trim()
    .toUpperCase()
    .replace(/^GEO:/, "")
    .replace(/[−–—]/g, "-")
    .replace(/[′’‘´`]/g, "'")
    .replace(/[″”“„]|''/g, '"')
    .replace(/[º˚]/g, "°")
    .replace(/\u00a0/g, " ");
  return /^[^,]*\d,\d+\D*[\s;]+[^,]*\d,\d+\D*$/.test(signs) ? signs.replace(/(\d),(\d)/g, "$1.$2") : signs;
}

/**
 * "39 57 36" is degrees, minutes, seconds too: with letters, blanks may replace signs.
 *
 * @param {string} text
 */
function withSigns(text) {
  if (!/[NSEWO]/.test(text) || /[°'"]/.test(text)) return text;
  return text.replace(
    /(\d+)\s+(\d+(?:\.\d+)?)(?:\s+(\d+(?:\.\d+)?))?/g,
    (_whole, degrees, minutes, seconds) => `${degrees}°${minutes}'${seconds ? `${seconds}"` : ""}`,
  );
}

/** @param {string} words @param {number} at */
function angleAt(words, at) {
  for (const pattern of ANGLES) {
    pattern.lastIndex = at;
    const found = pattern.exec(words);
    if (found) return { angle: angleOf(found), end: pattern.lastIndex };
  }
  return { angle: null, end: at };
}

/** @param {RegExpExecArray} found @returns {Angle | null} */
function angleOf([, before, degrees, minutes, seconds, after]) {
  if (Number(minutes ?? 0) >= 60 || Number(seconds ?? 0) >= 60) return null;
  if ((minutes || seconds) && degrees.includes(".")) return null;
  const letter = before || after || "";
  if (letter && /^[+-]/.test(degrees)) return null;
  const size = Math.abs(Number(degrees)) + Number(minutes ?? 0) / 60 + Number(seconds ?? 0) / 3600;
  return { letter, degrees: size * (degrees.startsWith("-") ? -1 : 1) * (SIGN[letter] ?? 1) };
}

/**
 * { position: [lon, lat], order }, or null where the text is no pair of coordinates. Without letters the latitude comes first; `order`
 * states the order assumed: "letters", "latitude first", or "longitude first" where the first figure can be no latitude.
 *
 * @param {string} text
 */
export function positionIn(text) {
  const words = withSigns(plain(text));
  /** @type {Angle[]} */
  const angles = [];
  for (let at = 0; at < words.length; ) {
    const { angle, end } = angleAt(words, at);
    if (!angle || angles.length === 2) return null;
    angles.push(angle);
    at = end;
    const gap = /^(?:\s*[,;/]\s*|\s+)/.exec(words.slice(at));
    if (at < words.length && !gap && !(angles.length === 1 && angle.letter)) return null;
    at += gap?.[0].length ?? 0;
  }
  if (angles.length !== 2 || (angles[0].letter === "") !== (angles[1].letter === "")) return null;
  const [first, second] = angles;
  if (first.letter) {
    if (isNorthSouth(first.letter) === isNorthSouth(second.letter)) return null;
    return placed(isNorthSouth(first.letter) ? [second, first] : [first, second], "letters");
  }
  return Math.abs(first.degrees) > 90
    ? placed([first, second], "longitude first")
    : placed([second, first], "latitude first");
}

/** @param {[Angle, Angle]} pair longitude, latitude @param {"letters" | "latitude first" | "longitude first"} order */
function placed([longitude, latitude], order) {
  if (Math.abs(latitude.degrees) > 90 || Math.abs(longitude.degrees) > 180) return null;
  return { position: [longitude, latitude].map(({ degrees }) => Number(degrees.toFixed(7))), order };
}
