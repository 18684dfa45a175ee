/** The map's style as data: sources and layers from bottom to top, made from the palette. */

import { countLayers, outlineLayers, regionLayers } from "./far_layers.js";
import { infrastructureLayers, labelLayers } from "./ground_layers.js";
import { measureLayers, routeLayers, selectionLayers } from "./page_layers.js";
import { TILES } from "./voltages.js";

/** @import { LayerSpecification, SourceSpecification, StyleSpecification } from "/static/lib/maplibre-gl/maplibre-gl.mjs" */
/** @import { Palette } from "../../domain/palette.js" */
/** @import { FeatureCollection, GeoJSONSource, MapLibreMap, RasterMap, StyleOptions } from "../types.d.ts" */

/** @type {SourceSpecification} */
const EMPTY = { type: "geojson", data: { type: "FeatureCollection", features: [] } };

/** @param {RasterMap} layer @returns {SourceSpecification} */
function rasterSource(layer) {
  return { type: "raster", tiles: [layer.tiles], tileSize: 256, maxzoom: 19 };
}

/** @param {string} id @param {Palette} palette @param {boolean} visible @returns {LayerSpecification} */
function rasterLayer(id, palette, visible) {
  return {
    id,
    type: "raster",
    source: id,
    layout: { visibility: visible ? "visible" : "none" },
    paint: {
      "raster-opacity": id === "satellite" ? 0.85 : 0.6,
      "raster-saturation": id === "satellite" ? -0.2 : -0.6,
      "raster-brightness-max": palette.isDark ? 0.45 : 1,
      "raster-fade-duration": 120,
    },
  };
}

/** @param {Palette} palette @param {StyleOptions} options @returns {StyleSpecification} */
export function mapStyle(palette, options) {
  const { baseMap, satellite } = options;
  /** @type {[string, RasterMap][]} */
  const raster = [];
  if (baseMap?.tiles) raster.push(["base-map", baseMap]);
  if (satellite?.tiles) raster.push(["satellite", satellite]);
  return {
    version: 8,
    sources: {
      ...Object.fromEntries(raster.map(([id, layer]) => [id, rasterSource(layer)])),
      outline: EMPTY,
      graticule: EMPTY,
      [TILES]: { type: "vector", tiles: [options.tilesAddress], minzoom: 0, maxzoom: 15 },
      "picked-shapes": EMPTY,
      routes: EMPTY,
      "route-stops": EMPTY,
      "routes-so-far": EMPTY,
      "strip-point": EMPTY,
      "many-targets": EMPTY,
      selection: EMPTY,
      measure: EMPTY,
      regions: EMPTY,
    },
    layers: [
      { id: "ground", type: "background", paint: { "background-color": palette.ground } },
      ...raster.map(([id]) => rasterLayer(id, palette, options.under === id)),
      ...outlineLayers(palette, !options.under),
      {
        id: "graticule",
        type: "line",
        source: "graticule",
        paint: { "line-color": palette.graticule, "line-width": 1 },
      },
      ...infrastructureLayers(palette),
      ...routeLayers(palette),
      ...labelLayers(palette),
      ...countLayers(palette),
      ...regionLayers(palette),
      ...selectionLayers(palette),
      ...measureLayers(palette),
    ],
  };
}

/**
 * Set the colours of another palette on each layer of a map.
 *
 * @param {MapLibreMap} map
 * @param {Palette} palette
 * @param {StyleOptions} options
 */
export function repaint(map, palette, options) {
  for (const layer of mapStyle(palette, options).layers) {
    if (!map.getLayer(layer.id)) continue;
    setPaint(map, layer);
  }
}

/** Sets the paint properties of a layer that the map has. @param {MapLibreMap} map @param {{ id: string, paint?: object }} layer */
export function setPaint(map, { id, paint = {} }) {
  for (const [name, value] of Object.entries(paint)) {
    map.setPaintProperty(id, /** @type {Parameters<MapLibreMap["setPaintProperty"]>[1]} */ (name), value);
  }
}

/** The source of this name, whose data a page sets. @param {MapLibreMap} map @param {string} name @returns {GeoJSONSource | undefined} */
export function sourceOf(map, name) {
  return map.getSource(name);
}

/** Store GeoJSON features in a source of this name. @param {MapLibreMap} map @param {string} name @param {object[]} features */
export function setFeatures(map, name, features) {
  sourceOf(map, name)?.setData(/** @type {FeatureCollection} */ ({ type: "FeatureCollection", features }));
}

/** Adds empty GeoJSON sources. @param {MapLibreMap} map @param {string[]} names */
export function addSources(map, names) {
  for (const name of names) map.addSource(name, EMPTY);
}

/** The value of a token of the style sheet, such as "--ink". @param {string} token */
export const readToken = (token) => getComputedStyle(document.documentElement).getPropertyValue(token).trim();
