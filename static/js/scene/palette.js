/** The present tokens of the 3D view: those of the map, and water for the sky. */

import { readPalette, routeNumber } from "../domain/palette.js";

/** @import { ScenePalette } from "./types.d.ts" */

const MORE = {
  water: "--map-water",
  road: "--map-road",
  pressed: "--pressed",
  panel: "--panel",
  hairline: "--hairline",
  accent: "--accent",
};

/**
 * colours: those of the mission, which set the order of the routes' colours.
 *
 * @param {readonly number[]} [colours]
 * @param {(token: string) => string} [read]
 * @returns {ScenePalette}
 */
export function readScenePalette(
  colours = [],
  read = (token) => getComputedStyle(document.documentElement).getPropertyValue(token).trim(),
) {
  const more = Object.fromEntries(Object.entries(MORE).map(([name, token]) => [name, read(token)]));
  const palette = readPalette(read);
  const routes = palette.routes.map((_, place) => palette.routes[routeNumber(place, colours) - 1]);
  return { ...palette, routes, .../** @type {{ [Name in keyof typeof MORE]: string }} */ (more) };
}
