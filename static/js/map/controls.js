/** Controls of every map: zoom, fit, layers, measuring, coordinates, and a notice when tiles cannot be read. */

import { byId, h, icon } from "../dom.js";
import { sourcesInView } from "../domain/regions.js";
import { copiedAt } from "../offline_copy.js";
import { closeMenu, menuOf, toggleMenu } from "../page/chrome.js";
import { copyText } from "../page/clipboard.js";
import { onTheme } from "../page/theme.js";
import { toast } from "../page/toast.js";
import { t } from "../text.js";
import { coordinateText } from "../units.js";
import { mountCoordinates, mountScale, setAttribution } from "./furniture.js";
import { storeLastView } from "./last_view.js";
import { createFindingsLayer } from "./layers/findings.js";
import { createInspectionsLayer } from "./layers/inspections.js";
import { layersMenu } from "./look/layers_menu.js";
import { mountLegend } from "./look/legend.js";
import { createShown } from "./look/shown.js";
import { rememberedUnder, rememberUnder, rememberUnreachable, underChoices } from "./look/under.js";
import { TILES } from "./look/voltages.js";
import { createMeasure } from "./measure_tool.js";
import { mountRegionSwitcher } from "./region_switcher.js";

/** @import { MenuItem } from "../page/chrome.js" */
/** @import { Palette } from "../domain/palette.js" */
/** @import { Box, Ground, MapControls, MapFault, MapLibreMap, MapPage, MapView, Position, SwitchedLayer } from "./types.d.ts" */

const COPIED_DIGITS = 6; // some 0.1 m
const ASK_AGAIN_MS = 8_000;

/**
 * Callbacks of a page for its map's controls.
 *
 * @typedef {object} ControlActs
 * @property {() => unknown} fit
 * @property {(palette: Palette) => void} [recoloured]
 * @property {() => boolean} [isBusy] whether another tool uses the pointer
 * @property {(isOn: boolean) => void} [measures]
 * @property {() => SwitchedLayer[]} [layers] more of them for the menu
 * @property {(place: Position) => MenuItem[]} [placeActs] first in the menu of a place
 */

/**
 * @param {MapView} view
 * @param {MapPage} page
 * @param {ControlActs} act
 * @returns {MapControls}
 */
export function mountControls(view, page, act) {
  const { map } = view;
  const container = byId("map");
  const frame = /** @type {HTMLElement} */ (container.parentElement);
  /** @type {Ground | null} */
  let ground = null;
  /** @type {Position | null} */
  let pointer = null;

  watchPointerAndIdle(map, container);
  mountScale(map);
  mountLegend(map);
  const showCoordinates = mountCoordinates();
  byId("zoom-in").addEventListener("click", () => map.zoomIn());
  byId("zoom-out").addEventListener("click", () => map.zoomOut());
  byId("fit").addEventListener("click", () => act.fit());
  onTheme(() =>
    requestAnimationFrame(() => {
      view.recolour();
      for (const layer of kept) layer.recolour();
      act.recoloured?.(view.palette());
    }),
  );

  const regions = page.regions ?? [];
  function attribute() {
    const box = /** @type {Box} */ (map.getBounds().toArray().flat());
    const seen = sourcesInView(ground, regions, box);
    byId("demo-badge").hidden = !seen.isDemo;
    setAttribution([
      ...seen.attribution,
      under.chosen() === "base-map" && page.baseMap.attribution,
      under.chosen() === "satellite" && page.satellite.attribution,
    ]);
  }
  map.on("moveend", attribute);
  storeLastView(map);
  mountRegionSwitcher(map, page, (box) => view.fit(box));
  const under = chooseUnder(view, page, () => attribute());
  const kept = [createInspectionsLayer(map, view.ready), createFindingsLayer(map, view.ready, view.palette)];
  mountLayersButton(map, under, () => [...(copiedAt === null ? kept : []), ...(act.layers?.() ?? [])]);
  const measure = createMeasure(map, frame, byId("measure"), { onSwitch: act.measures, isBusy: act.isBusy });
  mountPlaceMenu(map, frame, measure, act);
  if (copiedAt === null) watchTiles(map, frame); // a copy has the tiles round its mission, and no others

  return {
    attribute,
    isMeasuring: measure.isOn,
    hover(place) {
      pointer = place;
      showCoordinates(place);
      measure.at(place);
    },
    click(place) {
      if (!measure.isOn()) return false;
      measure.add(place);
      return true;
    },
    setGround(next) {
      ground = next;
      attribute();
      byId("map-empty").hidden = !ground || ground.extent !== null;
    },
    closeTop: measure.end,
    switchMeasure: () => (measure.isOn() ? measure.end() : measure.start()),
    copyPlace: () => copyPlace(pointer ?? map.getCenter().toArray()),
  };
}

/** Keys of a map, which may come later than the page. @param {() => Pick<MapControls, "switchMeasure" | "copyPlace"> | undefined} controls */
export const mapBindings = (controls) => [
  { keys: ["m"], words: t("Measure"), act: () => controls()?.switchMeasure() },
  {
    keys: ["c"],
    words: t("Copy the coordinates at the pointer, or of the middle"),
    act: () => void controls()?.copyPlace(),
  },
];

/**
 * Limit the focus ring to the keyboard: a click into the map focuses it too, and a later key would show the ring. Tests read the screen
 * position of a place, and whether the map is idle.
 *
 * @param {MapLibreMap} map
 * @param {HTMLElement} container
 */
function watchPointerAndIdle(map, container) {
  container.addEventListener("pointerdown", () => {
    container.dataset.pointed = "true";
  });
  container.addEventListener("focusout", () => delete container.dataset.pointed);
  Object.assign(container, { project: (/** @type {Position} */ position) => map.project(position) });
  map.on("idle", () => {
    container.dataset.idle = "true";
  });
  map.on("movestart", () => delete container.dataset.idle);
}

/**
 * The choice of the base map.
 *
 * @param {MapView} view
 * @param {MapPage} page
 * @param {() => void} onChange
 */
function chooseUnder(view, page, onChange) {
  let under = rememberedUnder(page);
  /** @param {string} name */
  function put(name) {
    under = name;
    view.putUnder(name);
    onChange();
  }
  /** @param {string} name */
  function choose(name) {
    put(name);
    rememberUnder(name);
  }
  watchUnder(view.map, (name) => {
    if (under !== name) return; // said already
    put("");
    if (copiedAt !== null) return; // the page says that nothing can be reached
    rememberUnreachable(name);
    toast(t("The base map cannot be reached. The map works without it."), {
      label: t("Try again"),
      act: () => choose(name),
    });
  });
  return { choices: underChoices(page), chosen: () => under, choose };
}

/**
 * Report a base map of which no tile has come and one could not be requested. While the device itself has no network none is reported.
 *
 * @param {MapLibreMap} map
 * @param {(name: string) => void} onUnreachable
 */
function watchUnder(map, onUnreachable) {
  /** @type {Set<string>} */
  const reached = new Set();
  map.on("data", (event) => {
    const { sourceId, tile } = /** @type {{ sourceId?: string, tile?: { state: string } }} */ (event);
    if (sourceId && tile?.state === "loaded") reached.add(sourceId);
  });
  map.on("error", (event) => {
    const { sourceId, error } = /** @type {MapFault} */ (event);
    if ((sourceId !== "base-map" && sourceId !== "satellite") || reached.has(sourceId)) return;
    const hasAnswered = Boolean(error?.status);
    if (!hasAnswered && error?.name !== "AbortError" && navigator.onLine) onUnreachable(sourceId);
  });
}

/** @param {MapLibreMap} map @param {ReturnType<typeof chooseUnder>} under @param {() => SwitchedLayer[]} more */
function mountLayersButton(map, under, more) {
  const button = byId("open-layers");
  const shown = createShown(map, () => {
    const words = shown.isWhole() ? t("Layers") : t("Layers: some are hidden");
    button.toggleAttribute("data-some-hidden", !shown.isWhole());
    button.setAttribute("aria-label", words);
    button.title = words;
  });
  button.addEventListener("click", () => toggleMenu(button, () => layersMenu({ under, shown, more: more() })));
}

/** @param {readonly number[]} place */
async function copyPlace(place) {
  const text = [place[1], place[0]].map((degrees) => degrees.toFixed(COPIED_DIGITS)).join(", ");
  toast((await copyText(text)) ? t("Copied: {coordinates}", { coordinates: text }) : text);
}

/**
 * The menu of a place: right click, or a long touch.
 *
 * @param {MapLibreMap} map
 * @param {HTMLElement} frame
 * @param {ReturnType<typeof createMeasure>} measure
 * @param {ControlActs} act
 */
function mountPlaceMenu(map, frame, measure, act) {
  const anchor = h("span", { class: "map-anchor" });
  frame.append(anchor);
  map.on("contextmenu", ({ point, lngLat, originalEvent }) => {
    if (act.isBusy?.()) return;
    originalEvent.preventDefault();
    /** @type {Position} */
    const place = [lngLat.lng, lngLat.lat];
    const measureFromHere = () => {
      measure.end();
      measure.start(place);
    };
    anchor.style.transform = `translate(${point.x}px, ${point.y}px)`;
    closeMenu();
    byId("map-tip").hidden = true;
    toggleMenu(anchor, () => {
      const menu = menuOf(t("This place"), [
        ...(act.placeActs?.(place) ?? []),
        { icon: "copy", label: t("Copy the coordinates"), act: () => copyPlace(place) },
        { icon: "ruler", label: t("Measure from here"), act: measureFromHere },
      ]);
      menu.prepend(h("p", { class: "caption" }, coordinateText(place)));
      return menu;
    });
  });
  map.on("movestart", ({ originalEvent }) => originalEvent && closeMenu()); // not when it is fitted to a new plan
}

/**
 * Show a notice when map data cannot be read, retry automatically, and remove the notice on success.
 *
 * @param {MapLibreMap} map
 * @param {HTMLElement} frame
 */
function watchTiles(map, frame) {
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;
  /** @type {{ x: number, y: number, z: number }[]} */
  let failed = []; // tiles since the last request
  const again = () => {
    clearTimeout(timer);
    timer = undefined;
    const wanted = failed;
    failed = [];
    // by name: MapLibre 6.17 skips failed tiles when all are requested
    map.refreshTiles(TILES, wanted);
  };
  const words = h(
    "span",
    {},
    h("strong", {}, t("The map cannot be read.")),
    " ",
    t("What you see may be incomplete. It is tried again every few seconds."),
  );
  const notice = h(
    "div",
    { class: "map-fault notice warning float", role: "status", hidden: true },
    icon("cloud-off"),
    words,
    h("button", { type: "button", class: "text-button", onclick: again }, t("Try now")),
  );
  frame.append(notice);
  map.on("error", (event) => {
    const { sourceId, error, tile } = /** @type {MapFault} */ (event);
    if (sourceId !== TILES || error?.name === "AbortError") return;
    if (tile) failed.push(tile.tileID.canonical);
    notice.hidden = false;
    timer ||= setTimeout(again, ASK_AGAIN_MS);
  });
  map.on("idle", () => {
    if (!failed.length) notice.hidden = true;
  });
  addEventListener("online", () => {
    if (!notice.hidden) again();
  });
}
