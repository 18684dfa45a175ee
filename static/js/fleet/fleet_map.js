/** Positions of UAVs and bases, and the pin that sets the place of the edited one. */

import { byId, h, icon } from "../dom.js";
import { boxAround } from "../domain/geodesy.js";
import { sourcesInView } from "../domain/regions.js";
import { setAttribution } from "../map/furniture.js";
import { storeLastView } from "../map/last_view.js";
import { optionsOf, rememberedUnder } from "../map/look/under.js";
import { createMap } from "../map/map_view.js";
import { loadMapLibrary, maplibre } from "../map/maplibre.js";
import { mountRegionSwitcher } from "../map/region_switcher.js";
import { onTheme } from "../page/theme.js";
import { t } from "../text.js";

/** @import { LngLat, Marker } from "/static/lib/maplibre-gl/maplibre-gl.mjs" */
/** @import { Box, MapLibreMap } from "../map/types.d.ts" */
/** @import { Chosen, FleetBase, FleetMap, FleetPage, Ground, Places, Position, Tab, Uav } from "./types.d.ts" */

const ROUND_DEG = 0.02; // margin round a single place

export { loadMapLibrary };

const NEAR_ZOOM = 13;
const ROW_PX = 22;
const SQUARE_PX = 26;
const EDGE_PX = 56;

/** @param {Box | null} box @returns {Box | null} */
const around = (box) => box && [box[0] - ROUND_DEG, box[1] - ROUND_DEG, box[2] + ROUND_DEG, box[3] + ROUND_DEG];
/** @param {LngLat} place @returns {Position} */
const rounded = ({ lng, lat }) => [Number(lng.toFixed(6)), Number(lat.toFixed(6))];

/** @param {Places} places */
const boxOf = ({ uavs, bases }) => around(boxAround([...(uavs ?? []), ...(bases ?? [])].map((row) => row.position)));

/**
 * @param {object} options
 * @param {FleetPage} options.page
 * @param {Places} options.rows
 * @param {Ground | null} options.ground
 * @param {(tab: Tab, id: number) => unknown} options.onChoose when one is clicked
 * @returns {FleetMap}
 */
export function createFleetMap({ page, rows, ground, onChoose }) {
  const container = /** @type {HTMLElement & { project?: MapLibreMap["project"] }} */ (byId("fleet-map"));
  const under = rememberedUnder(page);
  const view = createMap(container, {
    ...optionsOf(page),
    under,
    describe: t("Map of the fleet"),
    bounds: page.view ? null : boxOf(rows),
    extent: page.extent ?? boxOf(rows),
  });
  const { map } = view;
  const pin = createPin(map, container);
  /** @type {Marker[]} */
  let markers = [];

  const attribute = () =>
    setAttribution([
      ...sourcesInView(ground, page.regions ?? [], /** @type {Box} */ (map.getBounds().toArray().flat())).attribution,
      under === "base-map" && page.baseMap.attribution,
      under === "satellite" && page.satellite.attribution,
    ]);
  map.on("moveend", attribute);
  attribute();
  storeLastView(map);
  mountRegionSwitcher(map, page, (box) => view.fit(box));
  onTheme(() => requestAnimationFrame(view.recolour));
  new ResizeObserver(() => map.resize()).observe(container);
  container.project = (position) => map.project(position); // screen place of a position, for tests
  map.on("idle", () => {
    container.dataset.idle = "true";
  });

  return {
    centre() {
      const { lng, lat } = map.getCenter();
      return [Number(lng.toFixed(6)), Number(lat.toFixed(6))];
    },
    show(places, chosen) {
      for (const known of markers) known.remove();
      markers = markersOf(places, chosen, { hidesChosen: pin.isShown(), onChoose });
      for (const marker of markers) marker.addTo(map);
    },
    lookAtAll(places) {
      const box = boxOf(places);
      map.resize();
      if (box) map.fitBounds(box, { padding: EDGE_PX, duration: 0 });
    },
    look(position) {
      map.jumpTo({ center: position, zoom: Math.max(map.getZoom(), NEAR_ZOOM) });
    },
    place: pin.show,
    endPlacing: pin.remove,
    movePin(position) {
      pin.move(position);
      if (pin.isShown() && !map.getBounds().contains(position)) map.jumpTo({ center: position });
    },
  };
}

/**
 * UAVs at one place are drawn below each other.
 *
 * @param {Places} places
 * @param {Chosen | null} chosen
 * @param {{ hidesChosen: boolean, onChoose: (tab: Tab, id: number) => unknown }} how
 */
function markersOf({ uavs, bases }, chosen, { hidesChosen, onChoose }) {
  /** @type {Map<string, { hasBase: boolean, rows: number }>} */
  const standing = new Map();
  /** @param {Tab} tab @param {{ id: number }} row */
  const isChosen = (tab, row) => chosen?.tab === tab && chosen.id === row.id;
  /** @type {Marker[]} */
  const markers = [];
  for (const base of bases ?? []) {
    if (hidesChosen && isChosen("bases", base)) continue;
    standing.set(base.position.join(), { hasBase: true, rows: 0 });
    const element = baseMarker(base, isChosen("bases", base), () => onChoose("bases", base.id));
    markers.push(new maplibre.Marker({ element }).setLngLat(base.position));
  }
  for (const uav of uavs ?? []) {
    if (hidesChosen && isChosen("uavs", uav)) continue;
    const { hasBase, rows } = standing.get(uav.position.join()) ?? { hasBase: false, rows: 0 };
    standing.set(uav.position.join(), { hasBase, rows: rows + 1 });
    const element = uavMarker(uav, isChosen("uavs", uav), () => onChoose("uavs", uav.id));
    /** @type {[number, number]} */
    const offset = [hasBase ? SQUARE_PX / 2 : -14, rows * ROW_PX];
    markers.push(new maplibre.Marker({ element, anchor: "left", offset }).setLngLat(uav.position));
  }
  return markers;
}

/** @param {FleetBase} base @param {boolean} isChosen @param {() => unknown} choose */
const baseMarker = ({ name }, isChosen, choose) =>
  markerButton(name, t("Base {name}", { name }), `fleet-square${isChosen ? " chosen" : ""}`, choose, [
    h("span", {}, icon("warehouse")),
  ]);

/** @param {Uav} uav @param {boolean} isChosen @param {() => unknown} choose */
const uavMarker = ({ name, state }, isChosen, choose) =>
  markerButton(name, t("UAV {name}", { name }), `fleet-dart ${state}${isChosen ? " chosen" : ""}`, choose, [
    icon("uav"),
    h("span", { class: "dart-name", "aria-hidden": "true" }, name),
  ]);

/**
 * @param {string} title
 * @param {string} label
 * @param {string} kind
 * @param {() => unknown} choose
 * @param {Element[]} content
 */
function markerButton(title, label, kind, choose, content) {
  const button = h("button", { type: "button", tabindex: "-1", title, "aria-label": label, class: kind }, content);
  button.addEventListener("click", (event) => {
    event.stopPropagation();
    choose();
  });
  return button;
}

/**
 * The pin: dragged, or put by a click into the map.
 *
 * @param {MapLibreMap} map
 * @param {HTMLElement} container
 */
function createPin(map, container) {
  const frame = /** @type {HTMLElement} */ (container.parentElement);
  /** @type {{ marker: Marker, notify: (position: Position) => void } | null} */
  let pin = null;

  map.on("click", ({ lngLat }) => {
    if (!pin) return;
    const position = rounded(lngLat);
    pin.marker.setLngLat(position);
    pin.notify(position);
  });

  function remove() {
    pin?.marker.remove();
    pin = null;
    delete frame.dataset.placing;
  }

  return {
    isShown: () => pin !== null,
    remove,
    /** @param {Position} position */
    move: (position) => void pin?.marker.setLngLat(position),
    /** @param {Position} position @param {(position: Position) => void} notify */
    show(position, notify) {
      remove();
      frame.dataset.placing = "true";
      const element = h(
        "button",
        {
          type: "button",
          class: "fleet-pin",
          tabindex: "-1",
          "aria-label": t("Place, drag it"),
          title: t("Drag it, or click into the map"),
        },
        icon("map-pin"),
      );
      const marker = new maplibre.Marker({ element, anchor: "bottom", draggable: true }).setLngLat(position);
      marker.addTo(map).on("dragend", () => notify(rounded(marker.getLngLat())));
      pin = { marker, notify };
    },
  };
}
