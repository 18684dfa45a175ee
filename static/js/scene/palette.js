/** The tokens that the 3D view draws with, as they stand now: those of the map, and water for the sky. */

import { readPalette } from "../domain/palette.js";

/** @import { ScenePalette } from "./types.d.ts" */

const MORE = {
  water: "--map-water",
  road: "--map-road",
  pressed: "--pressed",
  panel: "--panel",
  hairline: "--hairline",
  accent: "--accent",
};

/** @param {(token: string) => string} [read] @returns {ScenePalette} */
export function readScenePalette(
  read = (token) => getComputedStyle(document.documentElement).getPropertyValue(token).trim(),
) {
  const more = Object.fromEntries(Object.entries(MORE).map(([name, token]) => [name, read(token)]));
  return { ...readPalette(read), .../** @type {{ [Name in keyof typeof MORE]: string }} */ (more) };
}
