/** The map itself: made once, coloured again when the theme changes, with its camera. */

import { readPalette } from "../domain/palette.js";
import { regionAt } from "../domain/regions.js";
import { COPY_HEADER, copiedAt } from "../offline_copy.js";
import { hashOf, showsAnything, viewOf } from "./address.js";
import * as graticule from "./layers/graticule.js";
import * as regionsLayer from "./layers/regions.js";
import { provideImages } from "./look/images.js";
import { createOutline } from "./look/outline.js";
import { mapStyle, repaint } from "./look/style.js";
import { maplibre } from "./maplibre.js";
import { tilesAddress } from "./tiles_address.js";

/** @import { Box, MapFault, MapLibreMap, MapOptions, MapView, Position } from "./types.d.ts" */

/** @type {Box} */
const WORLD = [-12, 25, 40, 62]; // where there are no map data

/** What a map shows until it is moved, where the address and the account name no place. @param {{ bounds?: Box | null, extent?: Box | null }} opening */
export const openingBox = ({ bounds, extent }) => bounds ?? extent ?? WORLD;

const NEAREST_FIT = 15;
const CONTROLS_PX = 68; // they are at the right edge
const FOOT_GAP_PX = 24;

/**
 * Create the map. It opens at the view in the page's address if that shows some of the data, else at `bounds`, else where the user worked
 * last, else at `extent`.
 *
 * @param {HTMLElement} container
 * @param {MapOptions} opening
 * @returns {MapView}
 */
export function createMap(container, opening) {
  const { baseMap, satellite, under, describe, bounds, extent, regions = [], view: lastView } = opening;
  const options = { tilesAddress: tilesAddress(), baseMap, satellite, under };
  let palette = readPalette();
  const boxes = regions.length ? [...regions.map((region) => region.extent), ...(bounds ? [bounds] : [])] : [extent];
  /** @param {{ zoom: number, centre: Position } | null} view */
  const worthwhile = (view) => {
    const size = /** @type {[number, number]} */ ([container.clientWidth, container.clientHeight]);
    const least_px = regions.length && !bounds ? 0 : undefined; // from afar a region is a dot with its name
    return view && boxes.some((box) => showsAnything(view, size, box, least_px)) ? view : null;
  };
  const addressed = () => worthwhile(viewOf(location.hash));
  const inAddress = addressed();
  const opened =
    inAddress ??
    (bounds || !lastView ? null : worthwhile({ zoom: lastView.zoom, centre: [lastView.longitude, lastView.latitude] }));
  const map = new maplibre.Map({
    container,
    style: mapStyle(palette, options),
    ...(opened
      ? { center: opened.centre, zoom: opened.zoom }
      : {
          bounds: openingBox({ bounds, extent }),
          fitBoundsOptions: { padding: paddingIn(container), maxZoom: NEAREST_FIT },
        }),
    ...(copiedAt === null ? {} : { transformRequest: (url) => ({ url, headers: { [COPY_HEADER]: copiedAt } }) }),
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
  map.on("load", () => {
    graticule.addTo(map);
    regionsLayer.addTo(map, regions, (box) => fitTo(box, 0));
    outline.start();
  });
  let keepsAddress = opened !== null;
  map.on("moveend", () => {
    if (keepsAddress)
      history.replaceState(history.state, "", hashOf({ zoom: map.getZoom(), centre: map.getCenter().toArray() }));
  });
  addEventListener("hashchange", () => {
    const view = addressed();
    if (view) map.jumpTo({ center: view.centre, zoom: view.zoom });
  });
  showFaults(map);

  const fitTo = keepFitted(map, container);
  const outline = createOutline(map, !under);

  return {
    map,
    palette: () => palette,
    opensAtPlace: opened !== null,
    opensAtLastView: opened !== null && inAddress === null,
    home: () => regionAt(regions, /** @type {Position} */ (map.getCenter().toArray()))?.extent ?? extent ?? null,
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
      outline.turn(!name);
    },
    show(layers, visible) {
      for (const id of layers) map.setLayoutProperty(id, "visibility", visible ? "visible" : "none");
    },
    /** Fit [west, south, east, north] into the visible part of the map. */
    fit(box, { animate = true } = {}) {
      keepsAddress = true; // from here on the user may return to the view
      if (!box) return;
      const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
      fitTo(box, animate && !calm ? 350 : 0, !animate);
    },
  };
}

/**
 * Fit boxes into the visible part of the map. They stay in view when legend and dock grow, until the map is moved. A legend that shrinks
 * is ignored: its rows depend on the zoom, and following it both ways could oscillate.
 *
 * @param {MapLibreMap} map
 * @param {HTMLElement} container
 * @returns {(box: Box, duration_ms: number, isOfPage?: boolean) => void} isOfPage: no act of the user, as its event tells
 */
function keepFitted(map, container) {
  /** @type {Box | null} */
  let fitted = null; // the box that the map was fitted to, until the user moves the map
  let isFitting = false;
  let footOfFit = 0;
  let size = sizeOf(container);
  map.on("movestart", () => {
    const isResized = size !== sizeOf(container);
    if (!isFitting && !isResized) fitted = null;
  });

  /** @param {Box} box @param {number} duration_ms @param {boolean} [isOfPage] */
  function fitTo(box, duration_ms, isOfPage = false) {
    const [west, south, east, north] = box;
    fitted = box;
    isFitting = true;
    footOfFit = footOf(container);
    const how = { padding: paddingIn(container), maxZoom: NEAREST_FIT, duration: duration_ms };
    map.fitBounds([west, south, east, north], how, { isOfPage });
    isFitting = false;
  }

  function fitAgain() {
    if (map.isMoving()) return void map.once("moveend", fitAgain);
    if (container.querySelector(".maplibregl-marker:hover"))
      return container.addEventListener("pointerout", fitAgain, { once: true }); // a marker stays under the pointer, which may drag it
    if (fitted && (size !== sizeOf(container) || footOf(container) > footOfFit)) {
      const box = fitted; // a resize counts as a move
      map.resize();
      fitTo(box, 0, true);
    }
    size = sizeOf(container);
  }

  const watcher = new ResizeObserver(() => {
    if (fitted) fitAgain();
    else size = sizeOf(container);
  });
  for (const element of [container, container.parentElement?.querySelector(".map-edge")]) {
    if (element) watcher.observe(element);
  }
  return fitTo;
}

/**
 * Show faults of a map in the console, once and in our words: every map needs this, or MapLibre logs them as they are. An unreachable
 * base map is not logged, because the map is complete without it. Nor are tiles whose request ended with the network or the page: the
 * page reports that itself.
 *
 * @param {MapLibreMap} map
 */
export function showFaults(map) {
  map.on("error", (event) => {
    const { error, sourceId } = /** @type {MapFault} */ (event);
    if (sourceId === "base-map" || sourceId === "satellite") return;
    const isCutOff = error?.status === 0;
    if (error?.name !== "AbortError" && !isCutOff) console.warn(`map: ${error?.message ?? error}`);
  });
}

/** @param {HTMLElement} element */
const sizeOf = ({ clientWidth, clientHeight }) => `${clientWidth} x ${clientHeight}`;

/** Height of the legend and attribution [px]. @param {HTMLElement} container */
function footOf(container) {
  /** @type {HTMLElement | null | undefined} */
  const edge = container.parentElement?.querySelector(".map-edge");
  return edge?.offsetHeight ?? 0;
}

/** Room for pills at the edges, for the controls on the right and for legend and attribution below. @param {HTMLElement} container */
function paddingIn(container) {
  const { clientWidth: width, clientHeight: height } = container;
  const edge = Math.min(64, Math.min(width, height) / 6);
  const bottom = Math.min(Math.max(edge, footOf(container) + FOOT_GAP_PX), height / 3);
  return { top: edge, bottom, left: edge, right: Math.min(Math.max(edge, CONTROLS_PX), width / 4) };
}
