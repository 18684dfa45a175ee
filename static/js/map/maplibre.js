/** The map library, in one place. It is the largest part of a page with a map, and is loaded after the page's own script. */

import { staticAddress } from "../static_address.js";

/** @typedef {typeof import("/static/lib/maplibre-gl/maplibre-gl.mjs")} MapLibrary */

/** @type {MapLibrary} */
export let maplibre; // once loadMapLibrary() has ended

/** @type {Promise<void> | null} */
let loading = null;

/** Load the library, once. A map may be created when this has ended. */
export function loadMapLibrary() {
  loading ??= import("/static/lib/maplibre-gl/maplibre-gl.mjs").then((library) => {
    maplibre = library;
    maplibre.setWorkerUrl(staticAddress("lib/maplibre-gl/maplibre-gl-worker.mjs"));
  });
  return loading;
}

const MAX_WAIT_MS = 1_000;

/**
 * Load the library after the page's data, but wait for these not for long: reading it and creating a map take the processor from drawing
 * them. The browser has fetched it meanwhile, as the page names it (`modulepreload`).
 *
 * @param {Promise<unknown>} data
 */
export async function mapLibraryAfter(data) {
  await Promise.race([data, new Promise((resolve) => setTimeout(resolve, MAX_WAIT_MS))]);
  await loadMapLibrary();
}
