/** The map of a page about the ground: made, furnished, and told what the pointer means. */

import { byId } from "../dom.js";
import { piecesOf, routeClicks } from "../map/click_router.js";
import { mountControls } from "../map/controls.js";
import { createTip } from "../map/furniture.js";
import * as selectionLayer from "../map/layers/selection.js";
import { createMap } from "../map/map_view.js";
import { tipOf } from "../map/tips.js";
import { rememberedUnder } from "../map/look/under.js";
import { t } from "../text.js";

const SETTLED_MS = 350;
const NEAR_ZOOM = 14;

/**
 * on: { click(thing, position, point), hover(thing, point, position), box([W, S, E, N]), tool() , kinds() }, each optional. A page that
 * draws returns true from `isBusy()` while the pointer belongs to the drawing: then nothing is picked and no tip comes up.
 * Returns { map, view, bindings, ready, fit(box), show(position or box), setGround(ground), box(), ring(geometries), onRecolour(act) }.
 */
export function mountGroundMap(page, on = {}) {
  const container = byId("map");
  const frame = container.parentElement;
  let ground = null;
  const view = createMap(container, {
    baseMap: page.baseMap,
    satellite: page.satellite,
    under: rememberedUnder(page),
    describe: t("Map"),
    bounds: page.extent,
    extent: page.extent,
  });
  const { map } = view;
  const repainted = new Set();
  const tip = createTip(frame);
  const isBusy = () => on.isBusy?.() ?? false;
  let pointed = null;
  const controls = mountControls(view, page, {
    isBusy,
    fit: () => fit(extent()),
    recoloured: (palette) => repainted.forEach((act) => act(palette)),
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
      tip(met ? `${met.kind} ${met.id}` : null, point, (refresh) => tipOf({ ...met, place: position }, refresh));
      on.hover?.(met, point, position);
      if (met?.id === pointed?.id && met?.kind === pointed?.kind) return;
      pointed = met;
      if (on.ringsItself) return;
      selectionLayer.showZone(map, pointed?.kind === "zone" ? pointed.id : null);
      ring(pointed && pointed.kind !== "zone" ? piecesOf(map, pointed) : []);
    },
    box: (box) => on.box?.(box),
  });

  const extent = () => ground?.extent ?? page.extent;
  const calm = () => matchMedia("(prefers-reduced-motion: reduce)").matches;
  function fit(box, options) {
    map.resize(); // the dock may just have come: fit into what is left
    view.fit(box, options);
  }
  function ring(geometries) {
    if (map.getSource("selection")) selectionLayer.showHovered(map, geometries);
  }

  return {
    map,
    view,
    bindings: controls.bindings,
    ready: view.ready,
    opensAtPlace: view.opensAtPlace,
    fit,
    fitAll: (options) => fit(extent(), options),
    zoom: (steps) => map.zoomTo(map.getZoom() + steps),
    box: () => map.getBounds().toArray().flat(),
    centre: () => map.getCenter().toArray(),
    /** Rings geometries: what a list row is at. */
    ring,
    /** Brings a position [lon, lat] or a box [W, S, E, N] into view, near enough to see what stands there. */
    show(place) {
      if (place.length === 4) fit(place);
      else map.easeTo({ center: place, zoom: Math.max(map.getZoom(), NEAR_ZOOM), duration: calm() ? 0 : SETTLED_MS });
    },
    /** `act(palette)` paints a page's own layers again after a change of theme. */
    onRecolour: (act) => repainted.add(act),
    /** New tiles, after the ground has changed. */
    refreshTiles() {
      const source = map.getSource("ground-tiles");
      if (source) source.setTiles([`${location.origin}/api/v1/tiles/{z}/{x}/{y}?of=${Date.now()}`]);
    },
    setGround(next) {
      ground = next;
      controls.setGround(next);
    },
  };
}
