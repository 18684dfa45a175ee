/** The tokens that the 3D view draws with, as they stand now: those of the map, and water for the sky. */

import { readPalette } from "../domain/palette.js";

const MORE = {
  water: "--map-water",
  road: "--map-road",
  pressed: "--pressed",
  panel: "--panel",
  hairline: "--hairline",
  accent: "--accent",
};

export function readScenePalette(
  read = (token) => getComputedStyle(document.documentElement).getPropertyValue(token).trim(),
) {
  return {
    ...readPalette(read),
    ...Object.fromEntries(Object.entries(MORE).map(([name, token]) => [name, read(token)])),
  };
}
