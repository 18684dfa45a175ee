/** The map of what flies: routes as planned and as flown, targets with their state, UAVs where they are or are estimated to be. */

import { byId, h, svg } from "../dom.js";
import { mountControls } from "../map/controls.js";
import { createTip, setAttribution } from "../map/furniture.js";
import * as routesLayer from "../map/layers/routes.js";
import { boxAround, createMap } from "../map/map_view.js";
import { maplibre } from "../map/maplibre.js";
import { mergePills } from "../map/pills.js";
import { routeNumber } from "../map/palette.js";
import { TILES } from "../map/style.js";
import { rememberedUnder } from "../map/under.js";
import { get } from "../api.js";
import { t } from "../text.js";
import { ringOf } from "./ellipse.js";
import { ESTIMATED, factWords, LOST, MEASURED } from "./uav_view.js";

const GLIDE_MS = 300;
const LEAST_RING_PX = 14;
const NEAR_ZOOM = 14;
const NOTHING = { type: "FeatureCollection", features: [] };
const SOURCES = ["flown", "rings", "since-report", "last-reports", "offered"];
const feature = (geometry, properties = {}) => ({ type: "Feature", properties, geometry });
const collection = (features) => ({ type: "FeatureCollection", features });
const calm = matchMedia("(prefers-reduced-motion: reduce)");

const DART = "M12 2.5L19.5 21L12 16.8L4.5 21Z";

function markOf({ kind, heading_deg }) {
  const turned = heading_deg === null ? {} : { style: `rotate: ${heading_deg}deg` };
  const shape = heading_deg === null ? svg("circle", { cx: 12, cy: 12, r: 7 }) : svg("path", { d: DART });
  return svg("svg", { class: `live-mark ${kind}`, viewBox: "0 0 24 24", "aria-hidden": "true" }, kind === LOST && svg("circle", { class: "lost-ring", cx: 12, cy: 12, r: 11 }), svg("g", { class: "turned", ...turned }, shape));
}

/** onChoose(uav id) when one is clicked; onMoved() when somebody moves the map by hand. */
export function createLiveMap(page, { onChoose, onMoved }) {
  const container = byId("map");
  const view = createMap(container, { baseMap: page.baseMap, satellite: page.satellite, under: rememberedUnder(page), describe: t("Map of what flies"), bounds: page.bounds ?? page.extent, extent: page.bounds ?? page.extent });
  const { map } = view;
  const tip = createTip(container.parentElement);
  const markers = new Map(); // uav → { marker, element, shown, position }
  let pills = [];
  let pillMarkers = [];
  let isReady = false;
  let hasFitted = view.opensAtPlace;
  let ground = null;

  const layersOf = (palette) => {
    const colour = ["match", ["get", "route"], ...palette.routes.flatMap((value, index) => [index + 1, value]), palette.inkSecond];
    return [
      { id: "live-flown", type: "line", source: "flown", layout: { "line-cap": "round", "line-join": "round" }, paint: { "line-color": colour, "line-width": 3.6 } },
      { id: "live-offered", type: "line", source: "offered", paint: { "line-color": colour, "line-width": 2.5, "line-dasharray": [2, 1.5] } },
      { id: "live-rings", type: "fill", source: "rings", paint: { "fill-color": colour, "fill-opacity": 0.15 } },
      { id: "live-rings-edge", type: "line", source: "rings", paint: { "line-color": colour, "line-width": 1.5, "line-dasharray": [3, 2] } },
      { id: "live-since-report", type: "line", source: "since-report", paint: { "line-color": colour, "line-width": 1.5, "line-dasharray": [2, 2] } },
      { id: "live-last-reports", type: "circle", source: "last-reports", paint: { "circle-radius": 3.5, "circle-color": palette.raised, "circle-stroke-color": colour, "circle-stroke-width": 2 } },
      { id: "live-last-reports-at", type: "symbol", source: "last-reports", layout: { "text-font": palette.fonts, "text-size": 11, "text-field": ["get", "at"], "text-anchor": "bottom", "text-offset": [0, -0.7], "text-optional": true }, paint: { "text-color": palette.ink, "text-halo-color": palette.halo, "text-halo-width": 2 } },
    ];
  };

  /** Planned routes are thin here: what was flown stands out. */
  const thinRoutes = () => map.setPaintProperty("routes", "line-width", 1.6);

  function recolour() {
    for (const { id, paint } of layersOf(view.palette())) for (const [name, value] of Object.entries(paint)) map.setPaintProperty(id, name, value);
    thinRoutes();
  }

  const controls = mountControls(view, page, { fit: () => fit(), isBusy: () => false, measures: () => {}, recoloured: recolour, layers: () => [] });
  map.on("click", ({ lngLat }) => controls.click(lngLat.toArray()));
  map.on("mousemove", ({ lngLat }) => controls.hover(lngLat.toArray()));
  map.on("dragstart", onMoved);
  map.on("zoomend", () => (drawPills(), drawRings()));
  map.on("idle", () => (container.dataset.idle = "true"));
  container.project = (position) => map.project(position); // screen place of a position, for tests

  const ready = view.ready.then(async () => {
    for (const name of SOURCES) map.addSource(name, { type: "geojson", data: NOTHING });
    for (const layer of layersOf(view.palette())) map.addLayer(layer);
    thinRoutes();
    isReady = true;
    ground = await get("/ground").then(({ data }) => data, () => null);
    setAttribution([...(ground?.attribution ?? []), page.baseMap?.attribution]);
  });

  // UAVs

  let rings = [];
  function drawRings() {
    if (!isReady) return;
    map.getSource("rings").setData(
      collection(
        rings.map(({ position, ring, route }) => {
          const across_px = Math.max(map.project(ringOf(position, ring)[12]).dist(map.project(position)), 0.1);
          const along_px = Math.max(map.project(ringOf(position, ring)[0]).dist(map.project(position)), 0.1);
          const scale = Math.max(1, LEAST_RING_PX / Math.max(along_px, across_px));
          return feature({ type: "Polygon", coordinates: [ringOf(position, ring, scale)] }, { route });
        }),
      ),
    );
  }

  function element(uav) {
    const button = h("button", { type: "button", class: "live-uav", onclick: (event) => (event.stopPropagation(), onChoose(uav.id)) });
    return button;
  }

  function say(own, uav, letter, shown, isChosen) {
    const fact = factWords(shown);
    const place = uav.place === null ? "" : `route-${routeNumber(uav.place)}`;
    own.element.className = `live-uav ${shown.kind} ${place}${isChosen ? " chosen" : ""}`.trim();
    own.element.setAttribute("aria-label", [uav.name, fact].filter(Boolean).join(", "));
    own.element.setAttribute("aria-pressed", String(isChosen));
    const label = h("span", { class: "live-label", "aria-hidden": "true" }, letter && h("span", { class: "letter" }, letter), h("strong", {}, uav.name), fact && h("span", {}, fact));
    own.element.replaceChildren(markOf(shown), label);
  }

  function glide(own, position) {
    cancelAnimationFrame(own.frame);
    const [from, began] = [own.position ?? position, performance.now()];
    own.position = position;
    const isFar = map.project(from).dist(map.project(position)) > 400;
    if (calm.matches || isFar || document.hidden) return void own.marker.setLngLat(position);
    const step = (now) => {
      const share = Math.min(1, (now - began) / GLIDE_MS);
      own.marker.setLngLat([from[0] + (position[0] - from[0]) * share, from[1] + (position[1] - from[1]) * share]);
      if (share < 1) own.frame = requestAnimationFrame(step);
    };
    own.frame = requestAnimationFrame(step);
    return undefined;
  }

  // targets

  function drawPills() {
    pillMarkers.forEach((marker) => marker.remove());
    const placed = pills.map((pill) => ({ ...pill, sequence: pill.place, ...map.project(pill.position) }));
    pillMarkers = mergePills(placed).map(({ members, label }) => {
      const states = new Set(members.map(({ state }) => state));
      const state = states.size === 1 ? members[0].state : "mixed";
      const words = members.map(({ name, stateWords }) => `${name}: ${stateWords}`).join("; ");
      const pill = h("span", { class: `map-pill still route-${routeNumber(members[0].place)} ${state}`, role: "img", "aria-label": `${label}, ${words}`, title: words }, h("span", { class: "pill" }, label));
      return new maplibre.Marker({ element: pill, subpixelPositioning: true }).setLngLat(members[0].position).addTo(map);
    });
  }

  let pillsKey = "";
  function fit() {
    const known = [...markers.values()].map(({ position }) => position).filter(Boolean);
    const box = boxAround([...known, ...routePoints, ...pills.map(({ position }) => position)]) ?? page.bounds ?? page.extent;
    view.fit(box);
  }

  let routePoints = [];
  let routesKey = "";

  return {
    ready,
    fit,
    tip,
    map,
    tiles: TILES,
    zoom: (step) => map.zoomTo(map.getZoom() + step),
    resize: () => map.resize(),

    /** uavs: [{ uav, letter, view, lines, isChosen }]; timeText(iso) → words. */
    showUavs(uavs, timeText) {
      const seen = new Set();
      for (const { uav, letter, view: shown, isChosen } of uavs) {
        if (!shown.position) continue;
        seen.add(uav.id);
        let own = markers.get(uav.id);
        if (!own) {
          own = { element: element(uav), position: null, frame: 0 };
          own.marker = new maplibre.Marker({ element: own.element, anchor: "left", offset: [-13, 0], subpixelPositioning: true }).setLngLat(shown.position).addTo(map);
          markers.set(uav.id, own);
        }
        say(own, uav, letter, shown, isChosen);
        if (own.position?.join() !== shown.position.join()) glide(own, shown.position);
      }
      for (const [id, own] of markers) {
        if (seen.has(id)) continue;
        own.marker.remove();
        markers.delete(id);
      }
      if (!isReady) return;
      const routeOf = ({ uav }) => (uav.place === null ? 0 : routeNumber(uav.place));
      const guessed = uavs.filter(({ view: shown }) => (shown.kind === ESTIMATED || shown.kind === LOST) && shown.ring && shown.position);
      rings = guessed.map((one) => ({ position: one.view.position, ring: one.view.ring, route: routeOf(one) }));
      drawRings();
      map.getSource("flown").setData(collection(uavs.flatMap((one) => one.lines.map((line) => feature({ type: "LineString", coordinates: one.view.kind === MEASURED ? [...line, one.view.position] : line }, { route: routeOf(one) })))));
      const reported = guessed.filter(({ view: shown }) => shown.reportPosition);
      map.getSource("since-report").setData(collection(reported.map((one) => feature({ type: "LineString", coordinates: [one.view.reportPosition, one.view.position] }, { route: routeOf(one) }))));
      map.getSource("last-reports").setData(collection(reported.map((one) => feature({ type: "Point", coordinates: one.view.reportPosition }, { route: routeOf(one), at: timeText(one.view.reportAt) }))));
    },

    /** routes: [{ sequence, geometry }] as planned; offered: the same of what is offered instead. */
    showRoutes(routes, offered = []) {
      if (!isReady) return;
      const key = JSON.stringify([routes.map(({ sequence, id }) => [sequence, id]), offered.map(({ id }) => id)]);
      if (key === routesKey) return;
      routesKey = key;
      routesLayer.update(map, routes);
      routePoints = routes.flatMap(({ geometry }) => geometry?.coordinates ?? []);
      map.getSource("offered").setData(collection(offered.map(({ sequence, geometry }) => feature(geometry, { route: routeNumber(sequence) }))));
      if (!hasFitted && routePoints.length) {
        hasFitted = true;
        fit();
      }
    },

    /** pills: [{ key, place, letter, number, position, state, stateWords, name }] */
    showTargets(next) {
      const key = JSON.stringify(next);
      if (key === pillsKey) return;
      pillsKey = key;
      pills = next;
      drawPills();
    },

    look(position) {
      map.jumpTo({ center: position, zoom: Math.max(map.getZoom(), NEAR_ZOOM) });
    },
    follow(position) {
      map.easeTo({ center: position, duration: calm.matches ? 0 : GLIDE_MS });
    },
  };
}
