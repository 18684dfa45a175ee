/** The map itself: made once, coloured again when the theme changes, with its camera. */

import { provideImages } from "./images.js";
import * as graticule from "./layers/graticule.js";
import { maplibre } from "./maplibre.js";
import { readPalette } from "./palette.js";
import { mapStyle, repaint } from "./style.js";

const WORLD = [-12, 25, 40, 62];

export function createMap(container, { baseMap, satellite, under, describe }) {
  const options = { tilesAddress: `${location.origin}/api/v1/tiles/{z}/{x}/{y}`, baseMap, satellite, under };
  let palette = readPalette();
  const map = new maplibre.Map({
    container,
    style: mapStyle(palette, options),
    bounds: WORLD,
    hash: "map", // the view is part of the address: #map=zoom/lat/lon
    attributionControl: false,
    dragRotate: false,
    pitchWithRotate: false,
    touchPitch: false,
    maxZoom: 19,
    minZoom: 1,
    fadeDuration: 0,
    locale: { "Map.Title": describe },
  });
  map.touchZoomRotate.disableRotation();
  map.keyboard.disableRotation();
  const redrawImages = provideImages(map, () => palette);
  map.on("load", () => graticule.addTo(map));
  map.on("error", ({ error, sourceId }) => {
    // A base map that cannot be reached is no fault of ours: the map is complete without it.
    if (sourceId === "base-map" || sourceId === "satellite") return;
    if (error?.name !== "AbortError") console.warn(`map: ${error?.message ?? error}`);
  });

  return {
    map,
    palette: () => palette,
    ready: new Promise((resolve) => map.once("load", resolve)),
    recolour() {
      palette = readPalette();
      repaint(map, palette, options);
      redrawImages();
    },
    /** Puts a raster layer under the map: "base-map", "satellite" or "". */
    putUnder(name) {
      for (const id of ["base-map", "satellite"]) {
        if (map.getLayer(id)) map.setLayoutProperty(id, "visibility", id === name ? "visible" : "none");
      }
    },
    show(layers, visible) {
      for (const id of layers) map.setLayoutProperty(id, "visibility", visible ? "visible" : "none");
    },
    /** Fits [west, south, east, north] into what is visible of the map. */
    fit(box, { animate = true } = {}) {
      if (!box) return;
      const room = Math.min(container.clientWidth, container.clientHeight);
      const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
      const padding = Math.min(64, room / 6);
      const controls_px = 68; // they stand at the right edge
      map.fitBounds([[box[0], box[1]], [box[2], box[3]]], {
        padding: { top: padding, bottom: padding, left: padding, right: Math.max(padding, controls_px) },
        maxZoom: 15,
        duration: animate && !calm ? 350 : 0,
      });
    },
  };
}

/** The box round positions, or null where there are none. */
export function boxAround(positions) {
  if (!positions.length) return null;
  const box = [Infinity, Infinity, -Infinity, -Infinity];
  for (const [longitude, latitude] of positions) {
    box[0] = Math.min(box[0], longitude);
    box[1] = Math.min(box[1], latitude);
    box[2] = Math.max(box[2], longitude);
    box[3] = Math.max(box[3], latitude);
  }
  return box;
}
