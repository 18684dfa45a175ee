/** Tokens of the map's colours, read from the present style sheet. */

export const ROUTE_COUNT = 8;

const NAMES = {
  ground: "--ground",
  raised: "--raised",
  ink: "--ink",
  inkSecond: "--ink-2",
  graticule: "--map-graticule",
  outline: "--map-outline",
  label: "--map-label",
  halo: "--map-halo",
  casing: "--map-casing",
  volt400: "--volt-400",
  volt220: "--volt-220",
  volt132: "--volt-132",
  volt66: "--volt-66",
  volt20: "--volt-20",
  voltUnknown: "--volt-unknown",
  tower: "--tower",
  railway: "--railway",
  bridge: "--bridge",
  zone: "--zone",
  zoneFill: "--zone-fill",
  select: "--select",
  critical: "--critical",
  font: "--font",
};

/** @typedef {{ [Name in keyof typeof NAMES]: string } & { routes: string[], fonts: string[], isDark: boolean }} Palette */

/**
 * Place in the sequence of route colours, 1 to 8; the ninth UAV starts again at 1.
 *
 * @param {number} sequence place of the UAV in its mission
 * @param {readonly number[]} [colours] those of the mission, assigned by the service once it is sent to UAVs
 */
export function routeNumber(sequence, colours = []) {
  const place = sequence % ROUTE_COUNT;
  return colours[place] ?? place + 1;
}

/** Class of an element that is drawn in a UAV's colour; none for a UAV of no mission. @param {number | null} colour number of it */
export const colourClass = (colour) => (colour === null ? "" : `route-${colour}`);

/** @param {number} sequence */
export function routeLetter(sequence) {
  return sequence < 26
    ? String.fromCharCode(65 + sequence)
    : `${String.fromCharCode(64 + Math.floor(sequence / 26))}${String.fromCharCode(65 + (sequence % 26))}`;
}

/** Name of a rally point: "R2", as on the map. @param {number} index */
export const rallyName = (index) => `R${index + 1}`;

/** @param {(token: string) => string} [read] @returns {Palette} */
export function readPalette(
  read = (token) => getComputedStyle(document.documentElement).getPropertyValue(token).trim(),
) {
  const names = Object.fromEntries(Object.entries(NAMES).map(([name, token]) => [name, read(token)]));
  const palette = /** @type {Palette} */ (/** @type {unknown} */ (names));
  palette.routes = Array.from({ length: ROUTE_COUNT }, (_, index) => read(`--route-${index + 1}`));
  palette.fonts = palette.font
    .split(",")
    .map((family) => family.trim().replaceAll('"', ""))
    .filter((family) => family && !family.startsWith("-"));
  palette.isDark = luminance(palette.ground) < 0.2;
  return palette;
}

/** Relative luminance of #rrggbb, WCAG 2.x. @param {string} hex */
export function luminance(hex) {
  const [red, green, blue] = [1, 3, 5].map((start) => {
    const share = parseInt(hex.slice(start, start + 2), 16) / 255;
    return share <= 0.04045 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4;
  });
  return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
}

/** Contrast of two colours, WCAG 2.x, 1 to 21. @param {string} a @param {string} b */
export function contrast(a, b) {
  const [dark, light] = [luminance(a), luminance(b)].sort((first, second) => first - second);
  return (light + 0.05) / (dark + 0.05);
}
