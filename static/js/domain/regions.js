/** Regions of the map data: which is where, and whose sources are in view. Values in, values out. */

/** @import { Box, Ground, Position, Region } from "../map/types.d.ts" */

const WORLD_PX = 512; // the whole world at zoom 0
const SMALL_PX = 120; // a region narrower than this on the screen is a dot with its name

/** @param {Box} one @param {Box} other */
export const meet = (one, other) =>
  one[0] <= other[2] && other[0] <= one[2] && one[1] <= other[3] && other[1] <= one[3];

/** Whether the middle of a box is in another one. @param {Box} outer @param {Box} inner */
export function isAround(outer, [west, south, east, north]) {
  const middle = [(west + east) / 2, (south + north) / 2];
  return meet(outer, /** @type {Box} */ ([...middle, ...middle]));
}

/** @param {Box} box */
const areaOf = ([west, south, east, north]) => (east - west) * (north - south);

/** The smallest region at a place, or null. @param {readonly Region[]} regions @param {Position} place @returns {Region | null} */
export function regionAt(regions, [longitude, latitude]) {
  const here = regions.filter(({ extent }) => meet(extent, [longitude, latitude, longitude, latitude]));
  return here.sort((one, other) => areaOf(one.extent) - areaOf(other.extent))[0] ?? null;
}

/** Zoom from which a region is larger than a dot. @param {Box} extent */
export const zoomOfRegion = ([west, , east]) => Math.log2((SMALL_PX * 360) / (WORLD_PX * Math.max(east - west, 1e-4)));

/**
 * The sources to credit in a view, and whether demo data are in it. Sources of demo data are left out where these are not in view; all
 * others are credited everywhere, as zones and terrain reach beyond their region.
 *
 * @param {Pick<Ground, "attribution" | "is_synthetic"> | null} ground
 * @param {readonly Region[]} regions
 * @param {Box} view
 */
export function sourcesInView(ground, regions, view) {
  if (!ground) return { attribution: [], isDemo: false };
  const away = regions.filter((region) => region.is_synthetic && !meet(region.extent, view));
  const kept = regions.filter((region) => !away.includes(region)).flatMap((region) => region.attribution);
  const hidden = away.flatMap((region) => region.attribution).filter((source) => !kept.includes(source));
  const demo = regions.filter((region) => region.is_synthetic);
  return {
    attribution: ground.attribution.filter((source) => !hidden.includes(source)),
    isDemo: demo.length ? away.length < demo.length : ground.is_synthetic,
  };
}
