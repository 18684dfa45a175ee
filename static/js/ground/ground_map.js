/** The map of a page on map data: created, with controls and pointer events. */

import { byId } from "../dom.js";
import { piecesOf, routeClicks } from "../map/click_router.js";
import { mapBindings, mountControls } from "../map/controls.js";
import { createTip } from "../map/furniture.js";
import * as selectionLayer from "../map/layers/selection.js";
import { optionsOf } from "../map/look/under.js";
import { createMap } from "../map/map_view.js";
import { tilesAddress } from "../map/tiles_address.js";
import { tipOf } from "../map/tips.js";
import { t } from "../text.js";

/** @import { VectorTileSource } from "/static/lib/maplibre-gl/maplibre-gl.mjs" */
/** @import { Ground } from "../api_types.d.ts" */
/** @import { Palette } from "../domain/palette.js" */
/** @import { Box, Geometry, MapLibreMap, MapThing } from "../map/types.d.ts" */
/** @import { GroundHandlers, GroundPage } from "./types.d.ts" */

const SETTLED_MS = 350;
const NEAR_ZOOM = 14;

/**
 * @param {GroundPage} page
 * @param {GroundHandlers} [on]
 */
export function mountGroundMap(page, on = {}) {
  const container = byId("map");
  const frame = /** @type {HTMLElement} */ (container.parentElement);
  /** @type {Ground | null} */
  let ground = null;
  const view = createMap(container, {
    ...optionsOf(page),
    describe: t("Map"),
  });
  const { map } = view;
  /** @type {Set<(palette: Palette) => void>} */
  const repainted = new Set();
  const tip = createTip(frame);
  const isBusy = () => on.isBusy?.() ?? false;
  /** @type {MapThing | null} */
  let pointed = null;
  const controls = mountControls(view, page, {
    isBusy,
    fit: () => fit(extent()),
    recoloured(palette) {
      for (const act of repainted) act(palette);
    },
  });

  routeClicks(map, {
    tool: () => on.tool?.() ?? "point",
    kinds: () => on.kinds?.() ?? null,
    click(thing, position, point) {
      tip(null);
      if (controls.click(position)) return;
      if (!isBusy()) on.click?.(thing, position, point);
    },
    hover(thing, point, position) {
      controls.hover(position);
      const met = isBusy() || controls.isMeasuring() ? null : thing;
      if (met) tip(`${met.kind} ${met.id}`, point, (fill) => tipOf({ ...met, place: position }, fill));
      else tip(null);
      on.hover?.(met, point, position);
      if (met?.id === pointed?.id && met?.kind === pointed?.kind) return;
      pointed = met;
      if (on.ringsItself) return;
      selectionLayer.showZone(map, pointed?.kind === "zone" ? pointed.id : null);
      ring(pointed && pointed.kind !== "zone" ? piecesOf(map, pointed) : []);
    },
    box: (box) => on.box?.(box),
  });

  const extent = () => view.home() ?? /** @type {Box | null} */ (ground?.extent ?? null);
  /** @param {Box | null} box @param {{ animate?: boolean }} [options] */
  function fit(box, options) {
    map.resize(); // the dock may just have appeared: fit into the remaining space
    view.fit(box, options);
  }
  /** Rings geometries: what a list row is at. @param {Geometry[]} geometries */
  function ring(geometries) {
    if (map.getSource("selection")) selectionLayer.showHovered(map, geometries);
  }

  return {
    map,
    view,
    bindings: mapBindings(() => controls),
    ready: view.ready,
    opensAtPlace: view.opensAtPlace,
    fit,
    /** @param {{ animate?: boolean }} [options] */
    fitAll: (options) => fit(extent(), options),
    /** @param {number} steps */
    zoom: (steps) => map.zoomTo(map.getZoom() + steps),
    box: () => map.getBounds().toArray().flat(),
    centre: () => map.getCenter().toArray(),
    ring,
    /** Bring a position [lon, lat] or a box [W, S, E, N] into view, near enough to see the assets. @param {number[]} place */
    show(place) {
      if (place.length === 4) fit(/** @type {Box} */ (place));
      else easeTo(map, place);
    },
    /** `act(palette)` paints a page's own layers again after a change of theme. */
    onRecolour: (/** @type {(palette: Palette) => void} */ act) => repainted.add(act),
    /** Reload tiles after a change of the map data. */
    refreshTiles() {
      refreshTiles(map);
    },
    /** @param {Ground} next */
    setGround(next) {
      ground = next;
      controls.setGround(next);
    },
  };
}

/** Move to a position, near enough to see the assets. @param {MapLibreMap} map @param {number[]} position */
function easeTo(map, [longitude, latitude]) {
  const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
  const zoom = Math.max(map.getZoom(), NEAR_ZOOM);
  map.easeTo({ center: [longitude, latitude], zoom, duration: calm ? 0 : SETTLED_MS });
}

/** @param {MapLibreMap} map */
function refreshTiles(map) {
  /** @type {VectorTileSource | undefined} */
  const source = map.getSource("ground-tiles");
  source?.setTiles([tilesAddress(Date.now())]);
}
